"""The controller's behaviours by themselves, over all robots at once: ORCA and routes. The flocks are in
`staya.flock`."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _check
from ._staya import Avoiders
from ._staya import route as _route

Floats = NDArray[np.float64]


class Orca:
    """Optimal reciprocal collision avoidance (J. van den Berg and others 2011) of `count` robots, with what each
    remembers from step to step.

    The memory is what ends symmetry and jams; `orca` is one step without. In the plane, or with `in_space` in space.

    - `horizon_s`, `wall_horizon_s`: time ahead for which no collision with robots, with obstacles may happen.
      Longer gives way earlier and slows crowds; shorter than a body needs to stop is not safe.
    - `share`: own share of a correction, 0.5 when all do the same; less is not safe.
    - `margin`: kept on top of radii, metres.
    - `lean_rad`: how far to the right of the wish to lean while somebody is in the way; 0.4 to 0.6, 0 never.
    - `patience_radii`: for how long a gap is left to those whose turn it is; 4 to 16.
    - `downwash`: in space, how many times as far as beside each other robots keep apart above each other.
    - `seed`: of the draws that end ties.
    """

    def __init__(
        self,
        count: int,
        *,
        in_space: bool = False,
        horizon_s: float = 2.0,
        wall_horizon_s: float = 1.0,
        share: float = 0.5,
        margin: float = 0.004,
        lean_rad: float = 0.46,
        patience_radii: float = 5.0,
        downwash: float = 1.0,
        seed: int = 0,
    ) -> None:
        self._count = _check.whole("count", count, 0, 2**31 - 2)
        self._axes = (3,) if in_space else (2,)
        self._avoiders = Avoiders(
            self._count,
            bool(in_space),
            _check.number("horizon_s", horizon_s, 0.0, above=True),
            _check.number("wall_horizon_s", wall_horizon_s, 0.0, above=True),
            _check.number("share", share, 0.0, 1.0),
            _check.number("margin", margin, 0.0),
            _check.number("lean_rad", lean_rad, 0.0, np.pi),
            _check.number("patience_radii", patience_radii, 0.0),
            _check.number("downwash", downwash, 1.0),
            _check.whole("seed", seed, 0, 2**64 - 1),
        )

    def __len__(self) -> int:
        """How many robots there are."""
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
        """The velocities to take for the next `step_s`: the nearest to `preferred` that others and obstacles permit.

        `positions`, `velocities`, `preferred`, `goals` and the answer have the shape (n, 2), in space (n, 3);
        `radii` and `max_speeds` are numbers or have the shape (n,). Near its goal nobody swerves. `walls` has rows
        of from x, y to x, y, `discs` of x, y, radius. Each robot reckons with the 16 nearest that it could meet
        within the horizon. O(16 n + n m) on all cores; the interpreter is free meanwhile.
        """
        count, axes = self._count, self._axes
        best = self._avoiders.velocities(
            _check.vectors("positions", positions, count, axes),
            _check.vectors("velocities", velocities, count, axes),
            _check.vectors("preferred", preferred, count, axes),
            None if goals is None else _check.vectors("goals", goals, count, axes),
            _check.scalars("radii", radii, count),
            _check.scalars("max_speeds", max_speeds, count),
            _check.rows("walls", walls, 4, "from x, y to x, y"),
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
    horizon_s: float = 2.0,
    wall_horizon_s: float = 1.0,
    share: float = 0.5,
    margin: float = 0.004,
    lean_rad: float = 0.46,
    downwash: float = 1.0,
) -> Floats:
    """One step of `Orca` that remembers nothing; see there for parameters, and its call for arrays."""
    avoid = Orca(
        len(_check.vectors("positions", positions, axes=(3,) if in_space else (2,))),
        in_space=in_space,
        horizon_s=horizon_s,
        wall_horizon_s=wall_horizon_s,
        share=share,
        margin=margin,
        lean_rad=lean_rad,
        downwash=downwash,
    )
    return avoid(
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


class Routes(NamedTuple):
    """Ways of robots, in the order of their starts."""

    paths: list[NDArray[np.int16]]
    """The cells of each way, start included: shape (k, 2), x and y."""
    ticks: Floats
    """Travel times: length times impassability of the cell entered, over all moves."""
    arrived: NDArray[np.bool_]
    """Who reached its goal."""


def route(
    land: ArrayLike,
    starts: ArrayLike,
    goals: ArrayLike,
    *,
    radius: int = 5,
    a0: float = 1.0,
    a1: float = 2.0,
    a2: float = 3.0,
    a3: float = 3.0,
    exit: Literal["best", "ray"] = "best",
    norm: Literal["euclidean", "chebyshev"] = "euclidean",
    corner_cutting: bool = False,
) -> Routes:
    """Walks each robot from its start to its goal by what it sees of the land (A. V. Kuznetsov 2017), as if it were
    alone.

    `land[y, x]` is how many ticks it takes to cross a cell, 0 a wall, row 0 in the south; `starts` and `goals` are
    cells (x, y), shape (n, 2). A robot sees `radius` cells around it (1 to 16), remembers where it was, and learns
    from dead ends. `a0` to `a3` weigh travel time, other robots, earlier visits and the distance from where a way
    leaves the window to the goal, 0 to 4095. Bounded: at most 200 moves per cell of width + height. On all cores;
    the interpreter is free meanwhile.
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
            raise ValueError(f"{name}[{blocked[0]}] is ({x}, {y}), in a wall; give a cell whose land is not 0")
    for name, value, known in [("exit", exit, ("best", "ray")), ("norm", norm, ("euclidean", "chebyshev"))]:
        if value not in known:
            raise ValueError(f"{name} is {value!r}; give {known[0]!r} or {known[1]!r}")
    gains = [_check.number(name, gain, 0.0, 4095.0) for name, gain in [("a0", a0), ("a1", a1), ("a2", a2), ("a3", a3)]]
    return Routes(
        *_route(
            np.ascontiguousarray(array, dtype=np.uint8),
            from_cells,
            to_cells,
            _check.whole("radius", radius, 1, 16),
            gains,
            exit == "ray",
            norm == "chebyshev",
            bool(corner_cutting),
        )
    )
