"""ORCA, routing and negotiation of all robots at once. The flocking laws are in `staya.flock`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _check
from ._staya import Avoiders, Negotiators
from ._staya import route as _route

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from . import settings

Floats = NDArray[np.float64]


class Orca:
    """Optimal reciprocal collision avoidance (J. van den Berg and others 2011) of `count` robots,
    with the memory of each robot between steps.

    The memory resolves symmetric situations and jams; `orca` is a single step without memory. In
    the plane, or in space with `in_space`. `staya.settings.Orca` describes the settings: a longer
    horizon gives way earlier and slows dense swarms; one shorter than the stopping time, or a small
    share, is unsafe. `seed` is that of the random numbers that break ties.
    """

    def __init__(
        self, count: int, *, in_space: bool = False, seed: int = 0, **settings: Unpack[settings.Orca]
    ) -> None:
        self._count = _check.whole("count", count, 0, 2**31 - 2)
        self._axes = (3,) if in_space else (2,)
        self._avoiders = Avoiders(
            self._count,
            bool(in_space),
            _check.whole("seed", seed, 0, 2**64 - 1),
            _check.settings(settings),
        )

    def __len__(self) -> int:
        """Number of robots."""
        return self._count

    def __call__(
        self,
        positions: ArrayLike,
        velocities: ArrayLike,
        preferred: ArrayLike,
        *,
        radii: ArrayLike,
        max_speeds: ArrayLike,
        step_s: float,
        goals: ArrayLike | None = None,
        walls: ArrayLike | None = None,
        discs: ArrayLike | None = None,
    ) -> Floats:
        """Returns the velocities for the next `step_s`: the permitted ones nearest to `preferred`.

        `positions`, `velocities`, `preferred`, `goals` and the result have the shape (n, 2), in
        space (n, 3). `radii` and `max_speeds` are numbers or have the shape (n,). Robots near their
        goals do not lean. `walls` has rows of x, y to x, y, `discs` rows of x, y, radius. Each
        robot considers the 16 nearest robots that it could meet within the horizon. O(16 n + n m)
        on all cores, without the interpreter lock.
        """
        count, axes = self._count, self._axes
        best = self._avoiders.velocities(
            _check.vectors("positions", positions, count, axes),
            _check.vectors("velocities", velocities, count, axes),
            _check.vectors("preferred", preferred, count, axes),
            None if goals is None else _check.vectors("goals", goals, count, axes),
            _check.scalars("radii", radii, count),
            _check.scalars("max_speeds", max_speeds, count),
            _check.rows("walls", walls, 4, "x, y to x, y"),
            _check.rows("discs", discs, 3, "x, y, radius"),
            _check.number("step_s", step_s, 0.0, above=True),
        )
        return best[:, : axes[0]]


def orca(
    positions: ArrayLike,
    velocities: ArrayLike,
    preferred: ArrayLike,
    *,
    radii: ArrayLike,
    max_speeds: ArrayLike,
    step_s: float,
    goals: ArrayLike | None = None,
    walls: ArrayLike | None = None,
    discs: ArrayLike | None = None,
    in_space: bool = False,
    **settings: Unpack[settings.Orca],
) -> Floats:
    """One step of `Orca` without memory. `Orca` describes the settings, its call the arrays."""
    count = len(_check.vectors("positions", positions, axes=(3,) if in_space else (2,)))
    return Orca(count, in_space=in_space, **settings)(
        positions,
        velocities,
        preferred,
        radii=radii,
        max_speeds=max_speeds,
        step_s=step_s,
        goals=goals,
        walls=walls,
        discs=discs,
    )


class Negotiation:
    """Robots on a grid without a map, each of which plans the moves of all robots near it by one
    rule and makes its own.

    `starts`: cells (x, y), shape (n, 2); y grows to the north. `ids`: a number for each robot, all
    different, which breaks ties; by default 1, 2, and so on. `diagonals`: with eight neighbours
    instead of four. A robot plans with at most 63 others within 8 cells, and remembers walls within
    31 cells.
    """

    def __init__(self, starts: ArrayLike, *, ids: ArrayLike | None = None, diagonals: bool = False) -> None:
        cells = _check.any_cells("starts", starts, None)
        numbers = np.arange(1, len(cells) + 1) if ids is None else np.asarray(ids)
        self._count = len(cells)
        if numbers.shape != (self._count,) or not np.issubdtype(numbers.dtype, np.integer):
            raise ValueError(f"ids has the shape {numbers.shape}; give whole numbers of shape ({self._count},)")
        if len(np.unique(numbers)) < self._count or (numbers < 1).any() or (numbers > 2**32 - 2).any():
            raise ValueError(f"ids: give different numbers from 1 to {2**32 - 2}")
        self._robots = Negotiators([int(number) for number in numbers], cells, bool(diagonals))

    def __call__(
        self,
        cells: ArrayLike,
        goals: ArrayLike,
        sights: ArrayLike,
        *,
        beacons: ArrayLike | None = None,
        reports: ArrayLike | None = None,
        sensing: Literal["nothing", "cells", "robots"] = "nothing",
    ) -> NDArray[np.int16]:
        """Returns the moves (x, y) of one step, each -1, 0 or 1, shape (n, 2).

        `cells` and `goals`: where robots are and want to go, as in `starts`. `sights[i, y, x]`: the
        11 x 11 cells around robot i, above 0 if closed, row 0 in the south. `beacons[i, j]`:
        whether robot i receives the beacon of j, which has 14 bytes besides the frame;
        `reports[i, j]`: the same for its report of 37 bytes, which is sent after the beacons. By
        default packets arrive up to 8 cells. `sensing`: what robots see of others within 5 cells
        without radio: nothing, occupied cells, or which robot is where.
        """
        at = _check.any_cells("cells", cells, self._count)
        kinds = ("nothing", "cells", "robots")
        if sensing not in kinds:
            raise ValueError(f"sensing is {sensing!r}; give {', '.join(map(repr, kinds))}")
        seen = np.asarray(sights)
        if seen.shape != (self._count, 11, 11):
            raise ValueError(f"sights has the shape {seen.shape}; give an array of shape ({self._count}, 11, 11)")
        far = np.abs(at[:, None].astype(int) - at[None].astype(int)).max(axis=2, initial=0)
        near = (far <= 8) & ~np.eye(self._count, dtype=bool)
        return self._robots.step(
            at,
            _check.any_cells("goals", goals, self._count),
            np.ascontiguousarray(seen > 0, dtype=np.uint8),
            _check.pairs("beacons", beacons, near),
            _check.pairs("reports", reports, near),
            kinds.index(sensing),
        )


class Routes(NamedTuple):
    """Paths of robots, in the order of their starts."""

    paths: list[NDArray[np.int16]]
    """Cells of each path with its start: shape (k, 2), x and y."""
    ticks: Floats
    """Travel times: length times impassability of the entered cell, summed over all moves."""
    arrived: NDArray[np.bool_]
    """Whether each robot reached its goal."""


def route(
    land: ArrayLike,
    starts: ArrayLike,
    goals: ArrayLike,
    *,
    norm: Literal["euclidean", "chebyshev"] = "euclidean",
    corner_cutting: bool = False,
    seed: int = 0,
    **settings: Unpack[settings.Route],
) -> Routes:
    """Moves each robot from its start to its goal with limited knowledge of the map (A. V.
    Kuznetsov 2017), without other robots.

    `land[y, x]` is the number of ticks to cross a cell, 0 for a wall, row 0 in the south. `starts`
    and `goals` are cells (x, y), shape (n, 2). A robot sees `radius` cells around it, remembers its
    path, and learns from dead ends; `staya.settings.Route` describes the settings, `seed` is that
    of the order of moves with `halved_per_ticks`. At most 200 moves per cell of width + height.
    Runs on all cores, without the interpreter lock.
    """
    array = np.asarray(land)
    if array.ndim != 2 or not np.issubdtype(array.dtype, np.integer):
        raise ValueError(
            f"land has the shape {array.shape} and the type {array.dtype}; give whole numbers of shape (height, width)"
        )
    bad = np.argwhere((array < 0) | (array > 255))
    if len(bad):
        y, x = bad[0]
        raise ValueError(f"land[{y}, {x}] is {array[y, x]}; give 0 (a wall) to 255")
    height, width = array.shape
    from_cells = _check.cells("starts", starts, None, width, height)
    to_cells = _check.cells("goals", goals, len(from_cells), width, height)
    for name, cells in [("starts", from_cells), ("goals", to_cells)]:
        blocked = np.flatnonzero(array[cells[:, 1], cells[:, 0]] == 0)
        if len(blocked):
            x, y = cells[blocked[0]]
            raise ValueError(f"{name}[{blocked[0]}] is ({x}, {y}), in a wall; give a cell that is not 0")
    if norm not in ("euclidean", "chebyshev"):
        raise ValueError(f"norm is {norm!r}; give 'euclidean' or 'chebyshev'")
    return Routes(
        *_route(
            np.ascontiguousarray(array, dtype=np.uint8),
            from_cells,
            to_cells,
            norm == "chebyshev",
            bool(corner_cutting),
            _check.whole("seed", seed, 0, 2**64 - 1),
            _check.settings(settings),
        )
    )
