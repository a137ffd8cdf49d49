"""26 layouts in which robots meet, for `cargo xtask bench rvo2`.

`scenes(seed)` draws them. Each seed shifts the starts differently and draws other random places.
"""

import math
import random
from dataclasses import dataclass

RADIUS_M, SPEED_MPS, TOLERANCE_M = 0.25, 1.0, 0.025
TICK_S, TICKS = 0.05, 4800
# Largest shift of a start, along each axis. It breaks symmetries that no real start has.
JITTER_M = 0.02
# Places drawn at random: least distance of two starts or goals, and of two parked robots.
SPACING_M, PARKING_M = 0.6, 1.5


@dataclass
class Robot:
    """Parked if it has no goal."""

    start: tuple[float, float]
    goal: tuple[float, float] | None = None
    speed_mps: float = SPEED_MPS


@dataclass
class Wall:
    """A segment, or a closed polygon with its corners counterclockwise."""

    points: list[tuple[float, float]]

    def is_closed(self):
        return len(self.points) > 2


@dataclass
class Scene:
    name: str
    seed: int
    robots: list[Robot]
    walls: list[Wall]
    range_m: float

    def goal_count(self):
        """Number of robots that have a goal."""
        return sum(robot.goal is not None for robot in self.robots)

    def to_toml(self):
        """The scenario for `staya run`."""
        lines = [f'name = "{self.name}"', f"seed = {self.seed}", f"ticks = {TICKS}", f"tick_s = {TICK_S}"]
        lines += ["[radio]", f"range_m = {self.range_m}"]
        lines += ["[plane]", f"radius_m = {RADIUS_M}", f"max_speed_mps = {SPEED_MPS}", f"tolerance_m = {TOLERANCE_M}"]
        for wall in self.walls:
            closed = ["closed = true"] if wall.is_closed() else []
            lines += ["[[plane.wall]]", f"points_m = {[list(point) for point in wall.points]}", *closed]
        for robot in self.robots:
            lines += ["[[plane.robots.list]]", f"start_m = {list(robot.start)}"]
            lines += [f"goal_m = {list(robot.goal)}"] if robot.goal else []
            lines += [f"max_speed_mps = {robot.speed_mps}"] if robot.speed_mps != SPEED_MPS else []
        return "\n".join(lines) + "\n"


def east(x, y):
    return x, y


def west(x, y):
    return -x, y


def north(x, y):
    return y, x


def south(x, y):
    return y, -x


def lanes(count, pitch_m):
    """Sideways places of lanes, centred."""
    return [pitch_m * (lane - (count - 1) / 2) for lane in range(count)]


def block(turn, count, sides, pitch_m, start_m, end_m):
    """Ranks of robots that cross the middle: the first rank starts `start_m` before it, and the last
    rank stops `end_m` behind it."""
    last = (count - 1) // len(sides)
    for index in range(count):
        rank, side = index // len(sides), sides[index % len(sides)]
        yield Robot(turn(-start_m - pitch_m * rank, side), turn(end_m + pitch_m * (last - rank), side))


def streams(count, start_m):
    """Two opposing streams whose lanes are offset by half a lane."""
    sides = lanes(10, 1.0)
    eastward = block(east, count, sides, 1.0, start_m, start_m)
    return [*eastward, *block(west, count, [side + 0.5 for side in sides], 1.0, start_m, start_m)], []


def crossing(turns, count, lane_count):
    """Blocks that cross at right angles."""
    return [robot for turn in turns for robot in block(turn, count, lanes(lane_count, 1.0), 1.0, 3.0, 3.0)], []


def corridor(bodies, count, lane_count):
    """A corridor of 10 m; its width is given in diameters of a robot. Groups enter at both ends."""
    width = 2 * RADIUS_M * bodies
    sides = lanes(lane_count, width / (lane_count + 1))
    robots = [robot for turn in (east, west) for robot in block(turn, count, sides, 0.9, 6.0, 6.0)]
    return robots, [Wall([(-5.0, side), (5.0, side)]) for side in (width / 2, -width / 2)]


def overtaking():
    """Seven fast robots behind five slow ones, in a corridor that is 4 bodies wide."""
    robots = []
    for index in range(12):
        is_slow = index < 5
        side, behind = lanes(3, 0.4)[index % 3], 0.9 * index
        goal, speed = ((10.0 - behind, side), 0.5) if is_slow else ((24.0 - behind, side), SPEED_MPS)
        robots.append(Robot((-12.0 - behind, side), goal, speed))
    return robots, [Wall([(-30.0, side), (30.0, side)]) for side in (1.0, -1.0)]


def door(bodies, count, turns):
    """A wall with a door; its width is given in diameters of a robot."""
    robots = [robot for turn in turns for robot in block(turn, count, lanes(4, 0.8), 0.8, 1.5, 2.0)]
    jamb = RADIUS_M * bodies
    return robots, [Wall([(0.0, -15.0), (0.0, -jamb)]), Wall([(0.0, jamb), (0.0, 15.0)])]


def on_circle(radius_m, index, count):
    angle = math.tau * index / count
    return radius_m * math.cos(angle), radius_m * math.sin(angle)


def circle(count, radius_m):
    """All robots swap places with the opposite robot."""
    places = [on_circle(radius_m, index, count) for index in range(count)]
    return [Robot(place, (-place[0], -place[1])) for place in places], []


def around_pillar():
    """A circle around an octagon."""
    robots, _ = circle(16, 6.0)
    return robots, [Wall([on_circle(1.5, corner, 8) for corner in range(8)])]


def scattered(draw, count, half_x, half_y, spacing_m):
    places = []
    while len(places) < count:
        place = draw.uniform(-half_x, half_x), draw.uniform(-half_y, half_y)
        if all(math.dist(place, other) >= spacing_m for other in places):
            places.append(place)
    return places


def crowd(draw, count, side_m):
    """Random starts and goals in a square without walls."""
    starts, goals = (scattered(draw, count, side_m / 2, side_m / 2, SPACING_M) for _ in range(2))
    return [Robot(start, goal) for start, goal in zip(starts, goals)], []


def lattice(draw):
    """A random permutation of places on a lattice."""
    places = [(x, y) for x in lanes(5, 0.9) for y in lanes(5, 0.9)]
    return [Robot(start, goal) for start, goal in zip(places, draw.sample(places, len(places)))], []


def pillars():
    """Eight robots each way among 16 square pillars, of which some stand in their way."""
    robots = []
    for index in range(8):
        side = -3.15 + 0.9 * index
        robots += [Robot((-6.0, side), (6.0, side)), Robot((6.0, side + 0.1), (-6.0, side + 0.1))]
    centers = [(x, y) for x in lanes(4, 2.0) for y in lanes(4, 2.0)]
    corners = [(0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)]
    return robots, [Wall([(x + dx, y + dy) for dx, dy in corners]) for x, y in centers]


def parked(draw):
    """Eight robots pass 14 parked robots."""
    robots = [Robot((-7.0, side), (7.0, side)) for side in lanes(8, 0.9)]
    return robots + [Robot(place) for place in scattered(draw, 14, 4.0, 3.0, PARKING_M)], []


def parked_row():
    """One robot goes around a row of parked robots without gaps for it."""
    return [Robot((-8.0, 0.0), (8.0, 0.0))] + [Robot((0.0, side)) for side in lanes(7, 0.62)], []


ALL = (east, west, north, south)
LAYOUTS = {
    "streams-2x20": lambda _: streams(20, 6.0),
    "streams-2x40": lambda _: streams(40, 8.0),
    "cross-2x12": lambda _: crossing((east, north), 12, 3),
    "cross-2x24": lambda _: crossing((east, north), 24, 3),
    "cross-4x4": lambda _: crossing(ALL, 4, 2),
    "cross-4x9": lambda _: crossing(ALL, 9, 3),
    "corr-2p2-4v4": lambda _: corridor(2.2, 4, 1),
    "corr-2p6-8v8": lambda _: corridor(2.6, 8, 1),
    "corr-3p5-10v10": lambda _: corridor(3.5, 10, 2),
    "corr-5-12v12": lambda _: corridor(5.0, 12, 3),
    "corr-8-16v16": lambda _: corridor(8.0, 16, 4),
    "circle-10": lambda _: circle(10, 4.0),
    "circle-20": lambda _: circle(20, 6.0),
    "circle-40": lambda _: circle(40, 10.0),
    "rand-20": lambda draw: crowd(draw, 20, 12.0),
    "rand-40": lambda draw: crowd(draw, 40, 12.0),
    "rand-60-dense": lambda draw: crowd(draw, 60, 11.0),
    "overtake-4": lambda _: overtaking(),
    "door-3-oneway-15": lambda _: door(3.0, 15, (east,)),
    "door-4-both-10": lambda _: door(4.0, 10, (east, west)),
    "door-6-both-15": lambda _: door(6.0, 15, (east, west)),
    "pillars-16": lambda _: pillars(),
    "parked-8": parked,
    "parked-row-7": lambda _: parked_row(),
    "round-16": lambda _: around_pillar(),
    "lattice-25": lattice,
}
# Robots on circles hear the opposite robot at the start.
FAR_M, NEAR_M = 25.0, 12.0


def scenes(seed):
    """All layouts, drawn with a seed."""
    for name, layout in LAYOUTS.items():
        draw = random.Random(f"{name} {seed}")
        robots, walls = layout(draw)
        for robot in robots:
            if robot.goal:
                robot.start = tuple(x + draw.uniform(-JITTER_M, JITTER_M) for x in robot.start)
        range_m = FAR_M if name.startswith(("circle", "round")) else NEAR_M
        yield Scene(name, draw.randrange(1_000_000), robots, walls, range_m)
