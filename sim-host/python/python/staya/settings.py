"""Names of laws and safety layers, and the settings of behaviours alone. `cargo xtask bless` writes
this file from the tables of the controller, which also check the values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    from typing_extensions import Required

Law = Literal["waypoint", "lattice", "goal_flock", "boids", "route", "formation", "formation_paper", "formation_lookahead", "negotiation"]
Layer = Literal["none", "orca", "template_2k", "fly", "push_out"]


class Orca(TypedDict, total=False):
    """Settings of `staya.Orca` and `staya.orca`, with `downwash` only in space.

    - `horizon_s`: time ahead without a collision with a robot; 0.01 to 60 seconds; default 2.
    - `wall_horizon_s`: time ahead without a collision with an obstacle; 0.01 to 60 seconds; default
      1.
    - `share`: own share of a correction; 0 to 1; default 0.5.
    - `margin_m`: distance kept on top of the radii; 0 to 10 metres; default 0.004.
    - `lean_rad`: how far to turn right when a robot is in the way; 0 to 1.5 radians; default 0.46.
    - `patience_radii`: how long to wait for the robots whose turn it is; 0 to 100 radii; default 5.
    - `downwash`: in space: ratio of the vertical to the horizontal separation; 1 to 10; default 1.
    """

    horizon_s: float
    wall_horizon_s: float
    share: float
    margin_m: float
    lean_rad: float
    patience_radii: float
    downwash: float


class Lattice(TypedDict, total=False):
    """Settings of `staya.flock.lattice`.

    - `spacing_m`: distance of neighbours in the lattice (d); 0.01 to 100 metres.
    - `range_ratio`: range of interaction over spacing; 1.001 to 4; default 1.2.
    - `obstacle_ratio`: distance from obstacles over spacing; 0.001 to 4; default 0.6.
    - `attraction`: bound of the attraction (a); 0.001 to 1000; default 5.
    - `repulsion`: bound of the repulsion (b), not less than a; 0.001 to 1000; default 5.
    - `c1_alpha`: robots among each other, on places; 0 to 1000 1/s^2; default: by the delay of the
      radio.
    - `c2_alpha`: robots among each other, on velocities; 0 to 1000 1/s; default: 2
      sqrt(`c1_alpha`).
    - `c1_beta`: obstacles, on places; 0 to 10000 1/s^2; default 200.
    - `c2_beta`: obstacles, on velocities; 0 to 1000 1/s; default: 2 sqrt(`c1_beta`).
    - `c1_gamma`: the reference, on places; 0 to 1000 1/s^2; default: by the delay of the radio.
    - `c2_gamma`: the reference, on velocities; 0 to 1000 1/s; default: 2 sqrt(`c1_gamma`).
    - `algorithm`: 1: other robots only; 2: also the goal; 3: also obstacles; 1 to 3; default 3.
    - `takes_turns`: gaps one by one: robots nearer to the goal go first; default False.
    - `goal_moves`: whether the goal moves with its velocity; default True.
    - `goal_rest_m`: way behind a goal at rest in which its velocity fades; 0.01 to 1000000 metres;
      default: never.
    """

    spacing_m: Required[float]
    range_ratio: float
    obstacle_ratio: float
    attraction: float
    repulsion: float
    c1_alpha: float
    c2_alpha: float
    c1_beta: float
    c2_beta: float
    c1_gamma: float
    c2_gamma: float
    algorithm: float
    takes_turns: bool
    goal_moves: bool
    goal_rest_m: float


class Goal(TypedDict, total=False):
    """Settings of `staya.flock.goal`.

    - `speed_mps`: preferred speed; 0 to 32 m/s.
    - `min_distance_m`: least distance of two robots' centres; 0.001 to 1000 metres.
    - `neighborhood_m`: farthest neighbour that counts; 0.002 to 10000 metres; default: 4
      `min_distance_m`.
    - `k1`: pull of the goal (K1); -1000 to 1000; default 1.
    - `k2`: pull of the middle of the neighbours (K2); -1000 to 1000; default 0.5.
    - `k3`: push of neighbours that are too near (K3); -1000 to 1000; default 1.
    """

    speed_mps: Required[float]
    min_distance_m: Required[float]
    neighborhood_m: float
    k1: float
    k2: float
    k3: float


class Boids(TypedDict, total=False):
    """Settings of `staya.flock.boids`.

    - `crowded_m`: nearer than this a boid turns away; 0 to 1000 metres.
    - `closest_m`: farthest neighbour that counts; 0 to 10000 metres.
    - `max_turn`: largest turn towards the others in a step; 0 to 3.15 radians; default 0.05.
    - `max_turn_away`: largest turn away from a too near boid in a step; 0 to 3.15 radians; default
      0.02.
    """

    crowded_m: Required[float]
    closest_m: Required[float]
    max_turn: float
    max_turn_away: float


class Route(TypedDict, total=False):
    """Settings of `staya.route`.

    - `a0`: weight of travel time; 0 to 4095; default 1.
    - `a1`: extra cost of a cell with another robot; 0 to 4095 ticks; default 2.
    - `a2`: extra cost of a cell for each earlier visit; 0 to 4095 ticks; default 3.
    - `a3`: price of a cell between the window and the target; 0 to 4095 ticks; default 3.
    - `radius`: sight in each direction; 1 to 16 cells; default 5.
    - `exit`: border cells that end a route: eq. 10, or algorithm 3; default "best".
    - `replan`: when to plan; in formations in each cell; default "each_cell".
    - `halved_per_ticks`: a move dearer by this is tried first half as often; 0 to 4095 ticks;
      default 0.
    """

    a0: float
    a1: float
    a2: float
    a3: float
    radius: float
    exit: Literal["best", "ray"]
    replan: Literal["each_cell", "until_changed"]
    halved_per_ticks: float
