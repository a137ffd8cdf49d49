"""Flocking laws, one step of all robots at once. Each robot sees the 16 nearest robots in range."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _check
from ._staya import boids_steer, goal_wish, lattice_acceleration

Floats = NDArray[np.float64]
Gain = float | tuple[float, float]


def lattice(
    positions: ArrayLike,
    velocities: ArrayLike,
    *,
    spacing: float,
    reference: ArrayLike | None = None,
    reference_velocity: ArrayLike | None = None,
    walls: ArrayLike | None = None,
    discs: ArrayLike | None = None,
    algorithm: Literal[1, 2, 3] = 3,
    range_ratio: float = 1.2,
    obstacle_ratio: float = 0.6,
    attraction: float = 5.0,
    repulsion: float = 5.0,
    alpha: Gain = 10.0,
    beta: Gain = 200.0,
    gamma: Gain = 2.0,
) -> Floats:
    """Accelerations of a flock that settles at equal distances, m/s^2 (R. Olfati-Saber 2006,
    algorithms 1 to 3).

    `positions` and `velocities` have the shape (n, 2) or (n, 3), the result that of `positions`.
    `spacing` is the distance of neighbours, 0.01 to 100 m. Robots interact up to `range_ratio`
    times that, obstacles up to `obstacle_ratio` times. `reference` is a point that attracts the
    flock, with its velocity. The gains `alpha` (neighbours), `beta` (obstacles) and `gamma`
    (reference) are one number for positions, 1/s^2, with critical damping, or a pair with one for
    velocities, 1/s. `walls` has rows of x, y to x, y, `discs` rows of x, y, radius. The law ignores
    the limits and sizes of bodies: use it with a safety layer.
    """
    places = _check.vectors("positions", positions)
    if algorithm not in (1, 2, 3):
        raise ValueError(f"algorithm is {algorithm!r}; give 1, 2 or 3")
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
        algorithm,
        float(spacing),
        [float(range_ratio), float(obstacle_ratio)],
        [float(attraction), float(repulsion)],
        [_gain("alpha", alpha), _gain("beta", beta), _gain("gamma", gamma)],
    )
    return answer[:, : np.shape(positions)[1]]


def goal(
    positions: ArrayLike,
    goals: ArrayLike,
    *,
    min_distance: float,
    speed: float,
    step_s: float,
    neighborhood: float | None = None,
    goal_gain: float = 1.0,
    center_gain: float = 0.5,
    repulsion_gain: float = 1.0,
) -> Floats:
    """Preferred velocities of robots that move to goals as a flock, m/s (V. E. and V. V.
    Pavlovsky).

    `positions` and `goals` have the shape (n, 2) or (n, 3), the result that of `positions`; one
    goal of shape (1, 2) or (1, 3) applies to all. `min_distance` is the smallest distance of two
    centres, `neighborhood` the sensing range (default 4 times that, at least 2 times), metres. Only
    the ratios of the gains matter: attraction of the goal, attraction of the neighbours' centre,
    repulsion of close robots.
    """
    places = _check.vectors("positions", positions)
    shape = np.shape(goals)
    if len(shape) == 2 and shape[0] == 1:
        goals = np.repeat(np.asarray(goals), len(places), axis=0)
    answer = goal_wish(
        places,
        _check.vectors("goals", goals, len(places)),
        [float(goal_gain), float(center_gain), float(repulsion_gain)],
        4.0 * min_distance if neighborhood is None else float(neighborhood),
        float(min_distance),
        float(speed),
        _check.number("step_s", step_s, 0.0, above=True),
    )
    return answer[:, : np.shape(positions)[1]]


def boids(
    positions: ArrayLike,
    headings: ArrayLike,
    *,
    crowded: float = 30.0,
    closest: float = 150.0,
    max_turn: float = 0.05,
    max_turn_away: float = 0.02,
    torus: tuple[float, float] | None = None,
) -> Floats:
    """Headings of boids one step later, unit vectors of shape (n, 2) (V. A. Starovoitova 2018).

    `positions` and `headings` have the shape (n, 2). A boid turns away from neighbours nearer than
    `crowded` and considers neighbours up to `closest`, metres. `max_turn` and `max_turn_away` are
    the largest turns in a step, radians. `torus` gives the circumferences of a torus.
    """
    places = _check.vectors("positions", positions, axes=(2,))
    sides = None if torus is None else _sides(torus)
    values = [("crowded", crowded), ("closest", closest), ("max_turn", max_turn), ("max_turn_away", max_turn_away)]
    return boids_steer(
        places,
        _check.vectors("headings", headings, len(places), axes=(2,)),
        sides,
        [_check.number(name, value, 0.0) for name, value in values],
        np.zeros(len(places)),
    )


def _gain(name: str, gain: Gain) -> list[float]:
    if isinstance(gain, tuple):
        if len(gain) != 2:
            raise ValueError(f"{name} has {len(gain)} numbers; give one on places, or a pair with one on velocities")
        return [_check.number(f"{name}[{index}]", value, 0.0) for index, value in enumerate(gain)]
    position = _check.number(name, gain, 0.0)
    return [position, 2.0 * position**0.5]


def _sides(torus: tuple[float, float]) -> list[float]:
    if np.shape(torus) != (2,):
        raise ValueError(f"torus has the shape {np.shape(torus)}; give two circumferences")
    return [_check.number(f"torus[{axis}]", side, 0.0, above=True) for axis, side in enumerate(torus)]
