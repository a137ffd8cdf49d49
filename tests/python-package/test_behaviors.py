"""Single behaviours: ORCA, routes, flocks, and their argument errors."""

import numpy as np
import pytest

import staya
from staya import flock

ROBOT = {"radii": 0.2, "max_speeds": 1.0, "step_s": 0.1}


def circle(count, radius=5.0):
    angles = np.arange(count) * 2 * np.pi / count
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def least_distance(places):
    apart = np.linalg.norm(places[:, None] - places[None, :], axis=2)
    return apart[~np.eye(len(places), dtype=bool)].min()


@pytest.mark.parametrize(("axes", "count"), [(2, 24), (3, 16)])
def test_robots_swap_places_across_a_circle_and_do_not_touch(axes, count):
    places = circle(count)
    places = np.pad(places, ((0, 0), (0, axes - 2)))
    goals, velocities = -places, np.zeros_like(places)
    avoid = staya.Orca(count, in_space=axes == 3)
    least = np.inf
    for _ in range(600):
        way = goals - places
        wishes = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1.0)
        velocities = avoid(places, velocities, wishes, goals=goals, **ROBOT)
        places = places + velocities * 0.1
        least = min(least, least_distance(places))
    assert velocities.shape == (count, axes)
    assert np.linalg.norm(goals - places, axis=1).max() < 0.1 and least > 0.4 - 1e-3


def test_a_single_robot_has_its_preferred_velocity_within_its_limit():
    best = staya.orca([[0, 0], [50, 0]], np.zeros((2, 2)), [[0.5, 0.25], [3, 4]], **ROBOT)
    assert best == pytest.approx(np.array([[0.5, 0.25], [0.6, 0.8]]), abs=1e-6)


def test_robots_stop_at_walls_and_discs():
    towards = {"velocities": [[0, 0]], "preferred": [[1, 0]]}
    wall = staya.orca([[0, 0]], **towards, walls=[[0.5, -9, 0.5, 9]], **ROBOT)
    assert 0 <= wall[0, 0] <= 0.3 + 1e-6
    disc = staya.orca([[0, 0]], **towards, discs=[[1.0, 0.0, 0.5]], lean_rad=0, **ROBOT)
    assert 0 <= disc[0, 0] <= 0.3 + 1e-6


def test_arrays_of_any_type_and_memory_order_are_accepted():
    places, wishes = circle(8).astype(np.float32), -circle(8)
    still = np.zeros((8, 2), dtype=np.int64)
    best = staya.orca(places, still, wishes, **ROBOT)
    assert (staya.orca(np.asfortranarray(places), still[::-1], wishes.tolist(), **ROBOT) == best).all()


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"positions": np.zeros(4)}, r"positions has the shape \(4,\); give an array of shape \(n, 2\)"),
        ({"velocities": np.zeros((3, 2))}, r"velocities has the shape \(3, 2\); give an array of shape \(4, 2\)"),
        ({"preferred": [[0, 0], [0, np.inf], [0, 0], [0, 0]]}, r"preferred\[1, 1\] is inf; give finite numbers"),
        ({"radii": [1, 2, -3, 4]}, r"radii\[2\] is -3.0; give 0 or more"),
        ({"radii": [1, 2]}, r"radii has the shape \(2,\); give a number, or an array of shape \(4,\)"),
        ({"max_speeds": np.nan}, r"max_speeds\[0\] is nan"),
        ({"step_s": 0}, "step_s is 0.0; give more than 0"),
        ({"walls": [[0, 0, 1]]}, r"walls has the shape \(1, 3\); give an array of shape \(m, 4\): x, y to x, y"),
        ({"discs": "round"}, "discs is not an array of numbers"),
        ({"goals": np.full((4, 2), np.nan)}, r"goals\[0, 0\] is nan"),
    ],
)
def test_invalid_arguments_of_orca_are_named(changed, message):
    sound = {"positions": circle(4), "velocities": np.zeros((4, 2)), "preferred": np.ones((4, 2)), **ROBOT}
    with pytest.raises(ValueError, match=message):
        staya.orca(**{**sound, **changed})


def test_routes_avoid_walls_and_report_arrivals():
    land = np.ones((12, 20), dtype=np.uint8)
    land[2:, 10] = 0
    land[5, 15:18] = 4
    routes = staya.route(land, [[2, 9], [0, 0], [12, 5]], [[18, 9], [0, 0], [19, 5]])
    assert routes.arrived.tolist() == [True, True, True]
    first = routes.paths[0]
    assert first[0].tolist() == [2, 9] and first[-1].tolist() == [18, 9]
    assert (np.abs(np.diff(first, axis=0)).max(axis=1) == 1).all() and land[first[:, 1], first[:, 0]].all()
    assert first[:, 1].min() <= 1 and routes.ticks[0] >= 22
    assert routes.paths[1].tolist() == [[0, 0]] and routes.ticks[1] == 0
    # Seven cells to the east, around the three slow ones.
    assert 7 <= routes.ticks[2] < 11
    land[:, 10] = 0
    assert not staya.route(land, [[2, 9]], [[18, 9]]).arrived[0]


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"land": np.ones(5)}, r"land has the shape \(5,\) and the type float64; give whole numbers"),
        ({"land": [[1, 300]]}, r"land\[0, 1\] is 300; give 0 \(a wall\) to 255"),
        ({"starts": [[9, 0]]}, r"starts\[0\] is \(9, 0\), off the map; give x below 3 and y below 2"),
        ({"goals": [[2, 1]]}, r"goals\[0\] is \(2, 1\), in a wall"),
        ({"goals": [[0, 0], [1, 1]]}, r"goals has the shape \(2, 2\) and .* of shape \(1, 2\)"),
        ({"radius": 17}, "radius: 17 is out of range; give 1 to 16 cells"),
        ({"norm": "round"}, "norm is 'round'; give 'euclidean' or 'chebyshev'"),
    ],
)
def test_invalid_arguments_of_routes_are_named(changed, message):
    sound = {"land": [[1, 1, 1], [1, 1, 0]], "starts": [[0, 0]], "goals": [[2, 0]]}
    with pytest.raises(ValueError, match=message):
        staya.route(**{**sound, **changed})


OPEN = np.zeros((2, 11, 11), dtype=bool)
# A corridor of one cell from (0, 0) to (9, 0), with a pocket at (4, 1).
CORRIDOR = {(x, 0) for x in range(10)} | {(4, 1)}


def sights(cells):
    closed = [[[(x + dx, y + dy) not in CORRIDOR for dx in range(-5, 6)] for dy in range(-5, 6)] for x, y in cells]
    return np.array(closed)


def test_two_robots_pass_each_other_in_a_corridor_with_a_pocket():
    cells, goals = np.array([[0, 0], [9, 0]]), np.array([[9, 0], [0, 0]])
    robots = staya.Negotiation(cells)
    for _ in range(60):
        cells = cells + robots(cells, goals, sights(cells))
        assert tuple(cells[0]) != tuple(cells[1])
        assert all(tuple(cell) in CORRIDOR for cell in cells.tolist())
    assert (cells == goals).all()


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"cells": [[0, 0]]}, "cells has the shape"),
        ({"goals": [[0.5, 0], [1, 0]]}, "goals has the shape"),
        ({"goals": [[0, 0], [40_000, 0]]}, "goals has cells beyond"),
        ({"sights": OPEN[:1]}, "sights has the shape"),
        ({"sensing": "all"}, "give 'nothing', 'cells', 'robots'"),
        ({"beacons": [[True]]}, "beacons has the shape"),
        ({"ids": [3, 3]}, "different numbers"),
        ({"ids": [1]}, "ids has the shape"),
    ],
)
def test_invalid_arguments_of_negotiation_are_named(changed, message):
    arguments = {"cells": [[0, 0], [1, 0]], "goals": [[1, 0], [0, 0]], "sights": OPEN} | changed
    with pytest.raises(ValueError, match=message):
        robots = staya.Negotiation([[0, 0], [1, 0]], ids=arguments.pop("ids", None))
        robots(**arguments)



def test_a_lattice_settles_at_its_spacing():
    places = circle(7, radius=0.6)
    velocities = np.zeros_like(places)
    for _ in range(1500):
        pull = flock.lattice(places, velocities, spacing_m=1.0, reference=[0, 0])
        velocities = velocities + 0.02 * pull
        places = places + 0.02 * velocities
    assert np.linalg.norm(velocities, axis=1).max() < 0.05
    assert least_distance(places) == pytest.approx(1.0, abs=0.12)
    assert np.linalg.norm(places.mean(axis=0)) < 0.1


def test_a_goal_flock_reaches_its_goal_and_keeps_its_distances():
    places = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0)), axis=-1).reshape(-1, 2)
    start = places
    for _ in range(200):
        places = places + 0.1 * flock.goal(places, [[20.0, 0.0]], min_distance_m=0.6, speed_mps=1.0, step_s=0.1)
    assert np.linalg.norm(places.mean(axis=0) - [20, 0]) < 2 < np.linalg.norm(start.mean(axis=0) - [20, 0])
    assert least_distance(places) > 0.3
    lone = flock.goal([[0.0, 0.0]], [[3.0, 4.0]], min_distance_m=1, speed_mps=2, step_s=0.1)
    assert lone == pytest.approx(np.array([[1.2, 1.6]]), abs=1e-6)


def test_boids_on_a_torus_align():
    random = np.random.default_rng(1)
    places, angles = random.uniform(0, 400, (200, 2)), random.uniform(-np.pi, np.pi, 200)
    headings = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    order = [np.linalg.norm(headings.mean(axis=0))]
    for _ in range(1200):
        headings = flock.boids(places, headings, crowded_m=5, closest_m=80, torus=(400, 400))
        places = (places + 2 * headings) % 400
    order.append(np.linalg.norm(headings.mean(axis=0)))
    assert np.linalg.norm(headings, axis=1) == pytest.approx(1, abs=1e-4)
    assert order[0] < 0.3 and order[1] > 0.8


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: flock.lattice(circle(4), circle(3), spacing_m=1), r"velocities has the shape \(3, 2\)"),
        (lambda: flock.lattice(circle(4), circle(4), spacing_m=1, reference=[0, np.nan]), r"reference\[0, 1\] is nan"),
        (
            lambda: flock.lattice(circle(4), circle(4), spacing_m=1, reference_velocity=[0, 0]),
            "reference_velocity is given without a reference",
        ),
        (lambda: flock.goal(circle(4), circle(2), min_distance_m=1, speed_mps=1, step_s=1), r"goals has the shape \(2, 2\)"),
        (lambda: flock.boids(np.zeros((4, 3)), circle(4), crowded_m=1, closest_m=5), r"positions has the shape \(4, 3\)"),
        (lambda: flock.boids(circle(4), circle(4), torus=(1, -1), crowded_m=1, closest_m=5), r"torus\[1\] is -1.0; give more than 0"),
    ],
)
def test_invalid_arguments_of_flocks_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_empty_arrays_are_accepted():
    none = np.empty((0, 2))
    assert staya.orca(none, none, none, **ROBOT).shape == (0, 2)
    assert flock.lattice(none, none, spacing_m=1).shape == (0, 2)
