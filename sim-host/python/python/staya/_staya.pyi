"""The compiled module. The modules beside it check all arguments."""

from os import PathLike
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float64]

__all__ = ["Avoiders", "GridBodies", "Negotiators", "Run", "ScenarioError", "__version__", "boids_steer", "goal_wish", "lattice_acceleration", "route"]

__version__: str

class ScenarioError(ValueError):
    """An unreadable or invalid scenario, with file, line, field and remedy."""

@final
class Run:
    """A scenario in progress."""

    def __new__(
        cls,
        text: str,
        path: str | PathLike[str],
        seed: int | None,
        ticks: int | None,
        law: str | None,
        safety: str | None,
        settings: list[str],
        record: int | None,
    ) -> Run: ...
    def state(self) -> bytes: ...
    @staticmethod
    def restored(bytes: bytes) -> Run: ...
    @property
    def tick(self) -> int: ...
    @property
    def ticks(self) -> int: ...
    @property
    def tick_s(self) -> float: ...
    @property
    def name(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def records(self) -> bool: ...
    @property
    def is_over(self) -> bool: ...
    @property
    def trace_hash(self) -> str: ...
    @property
    def has_wishes(self) -> bool: ...
    def step(self, ticks: int) -> None: ...
    def run(self, until: int | None) -> None: ...
    def begin_trace(self, every: int) -> None: ...
    def end_trace(self) -> dict[str, dict[str, NDArray[Any]]]: ...
    def ids(self) -> NDArray[np.uint32]: ...
    def bodies(self) -> _Floats | None: ...
    def positions(self) -> _Floats: ...
    def velocities(self) -> _Floats: ...
    def goals(self) -> _Floats: ...
    def modes(self) -> NDArray[np.uint8]: ...
    def is_up(self) -> NDArray[np.bool_]: ...
    def neighbors(self) -> NDArray[np.uint32]: ...
    def wish(self, velocities_mps: _Floats, mask: NDArray[np.bool_]) -> None: ...
    def intervene(self, table: str) -> None: ...
    def summary(self) -> str: ...
    def scenario_text(self) -> str: ...
    def page(self) -> str | None: ...

@final
class Avoiders:
    """Collision avoidance of many robots."""

    def __new__(
        cls,
        count: int,
        in_space: bool,
        seed: int,
        given: str,
    ) -> Avoiders: ...
    def velocities(
        self,
        positions_m: _Floats,
        velocities_mps: _Floats,
        wishes_mps: _Floats,
        goals_m: _Floats | None,
        radii_m: _Floats,
        max_speeds_mps: _Floats,
        walls_m: _Floats,
        discs_m: _Floats,
        step_s: float,
    ) -> _Floats: ...

@final
class Negotiators:
    """Robots on a grid that plan together."""

    def __new__(cls, ids: list[int], starts: NDArray[np.int16], diagonals: bool) -> Negotiators: ...
    def step(
        self,
        at: NDArray[np.int16],
        goals: NDArray[np.int16],
        sights: NDArray[np.uint8],
        beacons: NDArray[np.bool_],
        reports: NDArray[np.bool_],
        sensing: int,
    ) -> NDArray[np.int16]: ...

@final
class GridBodies:
    """Bodies of a scenario that move from cell to cell, without controllers."""

    def __new__(cls, path: str | PathLike[str]) -> GridBodies: ...
    def step(self, wishes: NDArray[np.int16]) -> NDArray[np.int16]: ...

def lattice_acceleration(
    positions_m: _Floats,
    velocities_mps: _Floats,
    reference: tuple[list[float], list[float]] | None,
    walls_m: _Floats,
    discs_m: _Floats,
    given: str,
) -> _Floats: ...
def goal_wish(
    positions_m: _Floats,
    goals_m: _Floats,
    step_s: float,
    given: str,
) -> _Floats: ...
def boids_steer(
    positions_m: _Floats,
    headings: _Floats,
    torus_m: list[float] | None,
    given: str,
) -> _Floats: ...
def route(
    land: NDArray[np.uint8],
    starts: NDArray[np.int16],
    goals: NDArray[np.int16],
    chebyshev: bool,
    corner_cutting: bool,
    seed: int,
    given: str,
) -> tuple[list[NDArray[np.int16]], _Floats, NDArray[np.bool_]]: ...
