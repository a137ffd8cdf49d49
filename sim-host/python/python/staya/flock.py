"""Flocking laws, one step of all robots at once. Each robot sees the 16 nearest robots in range."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _check
from ._staya import boids_steer, goal_wish, lattice_acceleration

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from . import settings

Floats = NDArray[np.float64]


def lattice(
    positions: ArrayLike,
    velocities: ArrayLike,
    *,
    reference: ArrayLike | None = None,
    reference_velocity: ArrayLike | None = None,
    walls: ArrayLike | None = None,
    discs: ArrayLike | None = None,
    **settings: Unpack[settings.Lattice],
) -> Floats:
    """Accelerations of a flock that settles at equal distances, m/s^2 (R. Olfati-Saber 2006,
    algorithms 1 to 3).

    `positions` and `velocities` have the shape (n, 2) or (n, 3), the result that of `positions`.
    `reference` is a point that attracts the flock, with its velocity. `walls` has rows of x, y to
    x, y, `discs` rows of x, y, radius. `staya.settings.Lattice` describes the settings. The law
    ignores the limits and sizes of bodies: use it with a safety layer.
    """
    places = _check.vectors("positions", positions)
    if reference is None and reference_velocity is not None:
        raise ValueError("reference_velocity is given without a reference; give both, or neither")
    leads = None
    if reference is not None:
        still = np.zeros(np.shape(reference)) if reference_velocity is None else reference_velocity
        leads = (_check.point("reference", reference), _check.point("reference_velocity", still))
    answer = lattice_acceleration(
        places,
        _check.vectors("velocities", velocities, len(places)),
        leads,
        _check.rows("walls", walls, 4, "x, y to x, y"),
        _check.rows("discs", discs, 3, "x, y, radius"),
        _check.settings(settings),
    )
    return answer[:, : np.shape(positions)[1]]


def goal(
    positions: ArrayLike,
    goals: ArrayLike,
    *,
    step_s: float,
    **settings: Unpack[settings.Goal],
) -> Floats:
    """Preferred velocities of robots that move to goals as a flock, m/s (V. E. and V. V.
    Pavlovsky).

    `positions` and `goals` have the shape (n, 2) or (n, 3), the result that of `positions`; one
    goal of shape (1, 2) or (1, 3) applies to all. `staya.settings.Goal` describes the settings; of
    the gains only the ratios matter.
    """
    places = _check.vectors("positions", positions)
    shape = np.shape(goals)
    if len(shape) == 2 and shape[0] == 1:
        goals = np.repeat(np.asarray(goals), len(places), axis=0)
    answer = goal_wish(
        places,
        _check.vectors("goals", goals, len(places)),
        _check.number("step_s", step_s, 0.0, above=True),
        _check.settings(settings),
    )
    return answer[:, : np.shape(positions)[1]]


def boids(
    positions: ArrayLike,
    headings: ArrayLike,
    *,
    torus: tuple[float, float] | None = None,
    **settings: Unpack[settings.Boids],
) -> Floats:
    """Headings of boids one step later, unit vectors of shape (n, 2) (V. A. Starovoitova 2018).

    `positions` and `headings` have the shape (n, 2). `torus` gives the circumferences of a torus.
    `staya.settings.Boids` describes the settings.
    """
    places = _check.vectors("positions", positions, axes=(2,))
    sides = None if torus is None else _sides(torus)
    return boids_steer(
        places,
        _check.vectors("headings", headings, len(places), axes=(2,)),
        sides,
        _check.settings(settings),
    )


def _sides(torus: tuple[float, float]) -> list[float]:
    if np.shape(torus) != (2,):
        raise ValueError(f"torus has the shape {np.shape(torus)}; give two circumferences")
    return [_check.number(f"torus[{axis}]", side, 0.0, above=True) for axis, side in enumerate(torus)]
