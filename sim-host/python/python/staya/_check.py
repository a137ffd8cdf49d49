"""Converts arguments to arrays for the compiled module. Errors name the argument, the wrong element
and the remedy."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def _array(name: str, value: ArrayLike, what: str) -> Floats:
    try:
        return np.asarray(value, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is not an array of numbers ({error}); give {what}") from None


def _finite(name: str, array: Floats) -> Floats:
    bad = np.argwhere(~np.isfinite(array))
    if len(bad):
        place = ", ".join(map(str, bad[0]))
        raise ValueError(f"{name}[{place}] is {array[tuple(bad[0])]}; give finite numbers")
    return array


def vectors(name: str, value: ArrayLike, count: int | None = None, axes: tuple[int, ...] = (2, 3)) -> Floats:
    """One row of x, y (and z) per robot, as rows of three; a missing z becomes 0."""
    sizes = " or ".join(map(str, axes))
    rows = "n" if count is None else str(count)
    what = f"an array of shape ({rows}, {sizes})"
    array = _array(name, value, what)
    if array.ndim != 2 or array.shape[1] not in axes or (count is not None and len(array) != count):
        raise ValueError(f"{name} has the shape {array.shape}; give {what}")
    _finite(name, array)
    if array.shape[1] == 3:
        return array
    return np.ascontiguousarray(np.pad(array, ((0, 0), (0, 3 - array.shape[1]))))


def point(name: str, value: ArrayLike) -> list[float]:
    """A position or a velocity, (x, y) or (x, y, z), as three numbers."""
    x, y, z = vectors(name, np.asarray(value)[None], 1)[0]
    return [float(x), float(y), float(z)]


def rows(name: str, value: ArrayLike | None, columns: int, what: str) -> Floats:
    """Rows of `columns` numbers; no rows for `None`."""
    if value is None:
        return np.empty((0, columns))
    array = _array(name, value, f"an array of shape (m, {columns}): {what}")
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name} has the shape {array.shape}; give an array of shape (m, {columns}): {what}")
    return _finite(name, array)


def scalars(name: str, value: ArrayLike, count: int, least: float = 0.0) -> Floats:
    """One number per robot, each at least `least`; a single number applies to all."""
    what = f"a number, or an array of shape ({count},)"
    array = _array(name, value, what)
    if array.ndim == 0:
        array = np.full(count, float(array))
    if array.shape != (count,):
        raise ValueError(f"{name} has the shape {array.shape}; give {what}")
    _finite(name, array)
    bad = np.flatnonzero(array < least)
    if len(bad):
        raise ValueError(f"{name}[{bad[0]}] is {array[bad[0]]}; give {least:g} or more")
    return array


def number(name: str, value: Any, least: float, most: float = np.inf, above: bool = False) -> float:
    """A number from `least` to `most`; with `above` it must be greater than `least`."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; give a number") from None
    if not (least < number if above else least <= number) or not number <= most or number == np.inf:
        bounds = f"more than {least:g}" if above else f"{least:g} or more"
        upper = "" if most == np.inf else f", up to {most:g}"
        raise ValueError(f"{name} is {number}; give {bounds}{upper}")
    return number


def mask(name: str, value: ArrayLike | None, count: int) -> NDArray[np.bool_]:
    """One boolean per robot; all true for `None`."""
    if value is None:
        return np.ones(count, dtype=np.bool_)
    array = np.asarray(value)
    if array.shape != (count,) or array.dtype != np.bool_:
        raise ValueError(f"{name} has the shape {array.shape} and the type {array.dtype}; give {count} booleans")
    return np.ascontiguousarray(array)


def whole(name: str, value: Any, least: int, most: int = 2**32 - 1) -> int:
    """A whole number from `least` to `most`."""
    try:
        number = value.__index__()
    except AttributeError:
        raise ValueError(f"{name} is {value!r}; give a whole number") from None
    if not least <= number <= most:
        raise ValueError(f"{name} is {number}; give {least} to {most}")
    return int(number)


def cells(name: str, value: ArrayLike, count: int | None, width: int, height: int) -> NDArray[np.int16]:
    """One cell (x, y) per robot on a map of `width` x `height` cells."""
    array = any_cells(name, value, count)
    is_off = ((array < 0) | (array >= np.array([width, height]))).any(axis=1)
    if is_off.any():
        index = int(np.flatnonzero(is_off)[0])
        x, y = array[index]
        raise ValueError(f"{name}[{index}] is ({x}, {y}), off the map; give x below {width} and y below {height}")
    return array


def any_cells(name: str, value: ArrayLike, count: int | None) -> NDArray[np.int16]:
    """One cell (x, y) per robot, anywhere."""
    array = np.asarray(value)
    rows = "n" if count is None else str(count)
    is_shaped = array.ndim == 2 and array.shape[1] == 2 and (count is None or len(array) == count)
    if not is_shaped or not np.issubdtype(array.dtype, np.integer):
        what = f"an array of whole numbers of shape ({rows}, 2)"
        raise ValueError(f"{name} has the shape {array.shape} and the type {array.dtype}; give {what}")
    if (np.abs(array.astype(np.int64)) > 30_000).any():
        raise ValueError(f"{name} has cells beyond 30000; give -30000 to 30000")
    return np.ascontiguousarray(array, dtype=np.int16)


def pairs(name: str, value: ArrayLike | None, default: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """For each robot and each other one, true or false."""
    array = default if value is None else np.asarray(value)
    if array.shape != default.shape or array.dtype != np.bool_:
        what = f"an array of true and false of shape {default.shape}"
        raise ValueError(f"{name} has the shape {array.shape} and the type {array.dtype}; give {what}")
    return np.ascontiguousarray(array & ~np.eye(len(default), dtype=bool))


def settings(given: Mapping[str, Any]) -> str:
    """Formats settings as TOML, a line each; the compiled module checks them."""
    return "".join(f"{toml(name, name)} = {toml(name, value)}\n" for name, value in given.items())


def toml(name: str, value: Any) -> str:
    """Formats a value as TOML."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, str):
        return '"' + "".join(_escaped(letter) for letter in value) + '"'
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(f'{name}.{key}', inside)}" for key, inside in value.items()) + " }"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(toml(f"{name}[{index}]", inside) for index, inside in enumerate(value)) + "]"
    raise ValueError(f"{name} is {value!r}; give a number, a boolean, a string, or lists or dictionaries of them")


def _escaped(letter: str) -> str:
    if letter in '"\\':
        return "\\" + letter
    return f"\\u{ord(letter):04x}" if ord(letter) < 0x20 or ord(letter) == 0x7F else letter
