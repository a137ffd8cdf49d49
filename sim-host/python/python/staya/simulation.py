"""Interactive runs of scenarios."""

from __future__ import annotations

import enum
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _check
from ._staya import Run, ScenarioError
from .result import Page, Result, figures
from .settings import Law, Layer

Guidance = Callable[["Simulation"], ArrayLike | tuple[ArrayLike, ArrayLike]]


class Mode(enum.IntEnum):
    """The mode of a robot in `Simulation.modes`."""

    IDLE = 0
    FORMING = 1
    CRUISE = 2
    HOLD = 3
    ARRIVED = 4
    FAULT = 5
    PASSIVE = 6


class Simulation:
    """A scenario before its first tick: `Simulation("scenarios/six-robots.toml", seed=3,
    radio__loss=0.3)`.

    `law` and `safety` choose the law and the safety layer of the robots, and keyword arguments their
    values: `law="goal_flock", min_distance_m=0.6, k1=2`. Others override scenario fields, with `__`
    for each dot; further names fit into `overrides={"plane.group[0].count": 40}`. With `record=N` every N-th tick is kept for `page`.
    Without commands the run equals that of `staya run`, bit for bit. Raises `ScenarioError` with
    file, line, field and remedy. A pickled copy continues at the same tick, with the same trace
    hash.
    """

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        *,
        seed: int | None = None,
        ticks: int | None = None,
        record: int | None = None,
        law: Law | None = None,
        safety: Layer | None = None,
        overrides: dict[str, Any] | None = None,
        **fields: Any,
    ) -> None:
        path = Path(scenario)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise ScenarioError(f"cannot read {path}: {error}; give the path of a scenario") from None
        self._begin(text, path, seed, ticks, record, law, safety, {**(overrides or {}), **_fields(fields)})

    @classmethod
    def from_text(
        cls,
        text: str,
        *,
        folder: str | os.PathLike[str] = ".",
        seed: int | None = None,
        ticks: int | None = None,
        record: int | None = None,
        law: Law | None = None,
        safety: Layer | None = None,
        overrides: dict[str, Any] | None = None,
        **fields: Any,
    ) -> Simulation:
        """Creates a simulation from the text of a scenario; relative paths refer to `folder`."""
        self = cls.__new__(cls)
        path = Path(folder, "scenario.toml")
        self._begin(text, path, seed, ticks, record, law, safety, {**(overrides or {}), **_fields(fields)})
        return self

    def _begin(
        self,
        text: str,
        path: Path,
        seed: int | None,
        ticks: int | None,
        record: int | None,
        law: str | None,
        safety: str | None,
        fields: dict[str, Any],
    ) -> None:
        seed = None if seed is None else _check.whole("seed", seed, 0, 2**63 - 1)
        ticks = None if ticks is None else _check.whole("ticks", ticks, 1)
        record = None if record is None else _check.whole("record", record, 1)
        settings = [f"{name}={_check.toml(name, value)}" for name, value in fields.items()]
        for name, value in [("law", law), ("safety", safety)]:
            if not isinstance(value, str | None):
                raise ValueError(f"{name} is {value!r}; give a name in quotes")
        self._hold(Run(text, path, seed, ticks, law, safety, settings, record))

    def _hold(self, run: Run) -> None:
        self._run = run
        self._ids = self._run.ids()
        self._ids.flags.writeable = False
        bodies = self._run.bodies()
        self._bodies = np.full((len(self._ids), 2), np.nan) if bodies is None else bodies
        self._bodies.flags.writeable = False

    def __getstate__(self) -> Run:
        return self._run

    def __setstate__(self, run: Run) -> None:
        self._hold(run)

    def __repr__(self) -> str:
        return f"<Simulation {self.name!r}: {len(self)} robots, tick {self.tick} of {self.ticks}>"

    def __len__(self) -> int:
        """Number of robots. Arrays per robot are in the order of `ids`."""
        return len(self._ids)

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self._run.name

    @property
    def seed(self) -> int:
        """Seed of all random numbers."""
        return self._run.seed

    @property
    def tick(self) -> int:
        """Number of ticks done."""
        return self._run.tick

    @property
    def ticks(self) -> int:
        """Number of ticks after which `run` ends."""
        return self._run.ticks

    @property
    def tick_s(self) -> float:
        """Length of a tick, seconds."""
        return self._run.tick_s

    @property
    def time_s(self) -> float:
        """Simulated time, seconds."""
        return self.tick * self.tick_s

    @property
    def is_over(self) -> bool:
        """Whether `run` would do nothing: all robots have arrived, or the ticks are used up."""
        return self._run.is_over

    @property
    def trace_hash(self) -> str:
        """Trace hash, 16 hex digits: equal for equal runs on any machine."""
        return self._run.trace_hash

    @property
    def ids(self) -> NDArray[np.uint32]:
        """Robot numbers, rising: shape (n,)."""
        return self._ids

    @property
    def radii(self) -> NDArray[np.float64]:
        """Radii, metres: shape (n,); NaN on a grid."""
        return self._bodies[:, 0]

    @property
    def max_speeds(self) -> NDArray[np.float64]:
        """Highest speeds, m/s: shape (n,); NaN on a grid."""
        return self._bodies[:, 1]

    @property
    def positions(self) -> NDArray[np.float64]:
        """Positions, metres: shape (n, 3), a copy."""
        return self._run.positions()

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities, m/s: shape (n, 3), a copy."""
        return self._run.velocities()

    @property
    def goals(self) -> NDArray[np.float64]:
        """Goals, metres: shape (n, 3); NaN for none."""
        return self._run.goals()

    @property
    def modes(self) -> NDArray[np.uint8]:
        """Modes: shape (n,), each a `Mode`."""
        return self._run.modes()

    @property
    def is_up(self) -> NDArray[np.bool_]:
        """Whether each robot's computer runs: shape (n,)."""
        return self._run.is_up()

    @property
    def neighbors(self) -> NDArray[np.uint32]:
        """Number of neighbours that each robot knows by radio: shape (n,)."""
        return self._run.neighbors()

    def step(self, n: int = 1, *, guidance: Guidance | None = None) -> None:
        """Does `n` ticks, also beyond the end of the run, without the interpreter lock. Ctrl-C
        stops it after a tick.

        With `guidance` each tick begins with `wish(guidance(self))`: your own law over all robots.
        The robots' collision avoidance and radio stay in effect. A law may also return a pair of
        velocities and a boolean for each robot: robots with `True` have arrived; their own
        guidance keeps them at their goals and reports the arrival.
        """
        n = _check.whole("n", n, 0)
        if guidance is None:
            return self._run.step(n)
        for _ in range(n):
            wished = guidance(self)
            velocities, arrived = wished if isinstance(wished, tuple) else (wished, None)
            self.wish(velocities, mask=None if arrived is None else ~np.asarray(arrived, dtype=np.bool_))
            self._run.step(1)

    def run(self, *, every: int | None = None, guidance: Guidance | None = None, until: int | None = None) -> Result:
        """Runs to the end or to tick `until`. Returns the summary, and the trace from the present
        tick.

        The trace has the robots' lines every `every` ticks; by default every n-th tick for up to n
        thousand robots, as in `staya run`. Memory: 78 bytes per line.
        """
        every = 0 if every is None else _check.whole("every", every, 1)
        until = None if until is None else _check.whole("until", until, 0)
        self._run.begin_trace(every)
        try:
            if guidance is None:
                self._run.run(until)
            else:
                end = self.ticks if until is None else min(until, self.ticks)
                while self.tick < end and not self.is_over:
                    self.step(guidance=guidance)
        finally:
            columns = self._run.end_trace()
        return Result(columns, figures(self._run), self._run.page if self._run.records else None)

    def wish(self, velocities: ArrayLike, *, mask: Sequence[bool] | NDArray[np.bool_] | None = None) -> None:
        """Sets the preferred velocities from now on, m/s: shape (n, 2) or (n, 3). Robots whose
        `mask` is false follow their own law. The safety layers stay in effect. Only in the plane or
        in space."""
        wishes = _check.vectors("velocities", velocities, len(self))
        self._run.wish(wishes, _check.mask("mask", mask, len(self)))

    def release(self) -> None:
        """Makes all robots follow their own laws again."""
        self._run.wish(np.zeros((len(self), 3)), np.zeros(len(self), dtype=np.bool_))

    def order(self, kind: str, **fields: Any) -> None:
        """Does an `[[intervention]]` of scenarios before the next tick: `order("goal", robot=3,
        place_m=[4, 5, 0])`.

        scenarios/README.md lists kinds and fields. Robots are identified by number (`ids`).
        """
        given = {name: value for name, value in fields.items() if value is not None}
        self._run.intervene(f"order = {_check.toml('order', {'kind': kind, **given})}")

    def set_goal(self, robot: int | Literal["all"], place: ArrayLike) -> None:
        """Sets the goal of one robot, or of all with "all", metres. A formation keeps its shape
        around its first robot's goal."""
        self.order("goal", robot=_one_or_all(robot), place_m=_check.point("place", place))

    def set_parameter(self, robot: int | Literal["all"], name: str, value: float) -> None:
        """Sets a parameter of the guidance law or the safety layer of one robot, or with "all" of
        all robots that have it."""
        self.order("parameter", robot=_one_or_all(robot), name=name, value=value)

    def set_radio(self, *, loss: float | None = None, range_m: float | None = None) -> None:
        """Sets the radio's probability of loss and range in metres."""
        self.order("radio", loss=loss, range_m=None if range_m is None else float(range_m))

    def take_down(self, robot: int, for_s: float | None = None) -> None:
        """Turns a robot's computer off for `for_s` seconds, or for good: the robot stops and is
        silent."""
        self.order("down", robot=robot, for_s=for_s)

    def page(self) -> Page:
        """The recording so far as one HTML page that plays in any browser; displayed inline in
        Jupyter."""
        html = self._run.page()
        if html is None:
            raise ValueError("nothing was recorded; give record=1 when you create the simulation")
        return Page(html)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the scenario with all orders, with which `staya run` repeats this run. Relative
        paths in it refer to the folder of the original scenario."""
        if self._run.has_wishes:
            raise ValueError(
                "velocities set by `wish` cannot be saved in a scenario; use orders instead, or keep the program"
            )
        Path(path).write_text(self._run.scenario_text(), encoding="utf-8")

    def _repr_html_(self) -> str | None:
        return self.page()._repr_html_() if self._run.records else None


def _one_or_all(robot: int | Literal["all"]) -> int | None:
    if robot == "all":
        return None
    if isinstance(robot, bool) or not isinstance(robot, (int, np.integer)):
        raise ValueError(f'robot: {robot!r} is not a robot id; give an id of `ids`, or "all"')
    return int(robot)


def _fields(fields: dict[str, Any]) -> dict[str, Any]:
    return {name.replace("__", "."): value for name, value in fields.items()}
