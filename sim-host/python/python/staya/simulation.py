"""A scenario in motion."""

from __future__ import annotations

import enum
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _check
from ._staya import Run, ScenarioError
from .result import Page, Result, figures

Guidance = Callable[["Simulation"], ArrayLike]


class Mode(enum.IntEnum):
    """What a robot is doing as a whole, as in `Simulation.modes`."""

    IDLE = 0
    FORMING = 1
    CRUISE = 2
    HOLD = 3
    ARRIVED = 4
    FAULT = 5
    PASSIVE = 6


class Simulation:
    """A scenario before its first tick: `Simulation("scenarios/six-robots.toml", seed=3, radio__loss=0.3)`.

    Whatever a scenario says can be said otherwise, by its name with `__` for each dot, or in a dictionary as
    `overrides={"plane.group[0].count": 40}`. With `record=N` every N-th tick is kept for `page`. The run is, to the
    bit, the one of the command `staya run`, as long as nobody commands. Raises `ScenarioError`, which names file,
    line, field and remedy.
    """

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        *,
        seed: int | None = None,
        ticks: int | None = None,
        record: int | None = None,
        overrides: dict[str, Any] | None = None,
        **fields: Any,
    ) -> None:
        path = Path(scenario)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise ScenarioError(f"cannot read {path}: {error}; give the name of a scenario's file") from None
        self._begin(text, path, seed, ticks, record, {**(overrides or {}), **_fields(fields)})

    @classmethod
    def from_text(
        cls,
        text: str,
        *,
        folder: str | os.PathLike[str] = ".",
        seed: int | None = None,
        ticks: int | None = None,
        record: int | None = None,
        overrides: dict[str, Any] | None = None,
        **fields: Any,
    ) -> Simulation:
        """The same of a scenario's text; files that it names are looked for in `folder`."""
        self = cls.__new__(cls)
        self._begin(text, Path(folder, "scenario.toml"), seed, ticks, record, {**(overrides or {}), **_fields(fields)})
        return self

    def _begin(
        self, text: str, path: Path, seed: int | None, ticks: int | None, record: int | None, fields: dict[str, Any]
    ) -> None:
        seed = None if seed is None else _check.whole("seed", seed, 0, 2**63 - 1)
        ticks = None if ticks is None else _check.whole("ticks", ticks, 1)
        record = None if record is None else _check.whole("record", record, 1)
        settings = [f"{name}={_check.toml(name, value)}" for name, value in fields.items()]
        self._run = Run(text, path, seed, ticks, settings, record)
        self._ids = self._run.ids()
        self._ids.flags.writeable = False
        bodies = self._run.bodies()
        self._bodies = np.full((len(self._ids), 2), np.nan) if bodies is None else bodies
        self._bodies.flags.writeable = False

    def __repr__(self) -> str:
        return f"<Simulation {self.name!r}: {len(self)} robots, tick {self.tick} of {self.ticks}>"

    def __len__(self) -> int:
        """How many robots there are; everything per robot is in the order of `ids`."""
        return len(self._ids)

    @property
    def name(self) -> str:
        """The scenario's name."""
        return self._run.name

    @property
    def seed(self) -> int:
        """The seed of everything random."""
        return self._run.seed

    @property
    def tick(self) -> int:
        """Ticks done."""
        return self._run.tick

    @property
    def ticks(self) -> int:
        """Ticks after which `run` ends."""
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
        """Whether `run` would do nothing: all have arrived, or the ticks are used up."""
        return self._run.is_over

    @property
    def trace_hash(self) -> str:
        """The fingerprint of everything that robots did, 16 hex digits: equal for equal runs on any machine."""
        return self._run.trace_hash

    @property
    def ids(self) -> NDArray[np.uint32]:
        """Robots' numbers, rising: shape (n,)."""
        return self._ids

    @property
    def radii(self) -> NDArray[np.float64]:
        """Radii of bodies, metres: shape (n,); NaN where they go from cell to cell."""
        return self._bodies[:, 0]

    @property
    def max_speeds(self) -> NDArray[np.float64]:
        """Highest speeds of bodies, m/s: shape (n,); NaN where they go from cell to cell."""
        return self._bodies[:, 1]

    @property
    def positions(self) -> NDArray[np.float64]:
        """Where robots are, metres: shape (n, 3), an array of its own."""
        return self._run.positions()

    @property
    def velocities(self) -> NDArray[np.float64]:
        """How robots move, m/s: shape (n, 3), an array of its own."""
        return self._run.velocities()

    @property
    def goals(self) -> NDArray[np.float64]:
        """Where robots are to go, metres: shape (n, 3); NaN: nowhere in particular."""
        return self._run.goals()

    @property
    def modes(self) -> NDArray[np.uint8]:
        """What robots are doing: shape (n,), each a `Mode`."""
        return self._run.modes()

    @property
    def is_up(self) -> NDArray[np.bool_]:
        """Whose computers run: shape (n,)."""
        return self._run.is_up()

    @property
    def neighbors(self) -> NDArray[np.uint32]:
        """How many others each robot knows of by radio: shape (n,)."""
        return self._run.neighbors()

    def step(self, n: int = 1, *, guidance: Guidance | None = None) -> None:
        """Does `n` ticks, also beyond the end of the run; the interpreter is free meanwhile, and Ctrl-C ends it
        after a tick.

        With `guidance` each tick begins with `wish(guidance(self))`: your own law over all robots, behind the
        robots' own collision avoidance and with what their radio brings.
        """
        n = _check.whole("n", n, 0)
        if guidance is None:
            return self._run.step(n)
        for _ in range(n):
            self.wish(guidance(self))
            self._run.step(1)

    def run(self, *, every: int | None = None, guidance: Guidance | None = None, until: int | None = None) -> Result:
        """Goes on to the end of the run, or up to tick `until`: a result with the figures, and the trace from here
        on.

        Robots' lines are kept every `every` ticks; without it, as `staya run` does, one line per robot and tick for
        each started thousand robots. Memory: 78 bytes a line.
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
        """Tells robots which velocities to wish for from now on, m/s: shape (n, 2) or (n, 3); those where `mask` is
        false follow their own law. What they then do is up to their safety layers. Only in the plane or in
        space."""
        wishes = _check.vectors("velocities", velocities, len(self))
        self._run.wish(wishes, _check.mask("mask", mask, len(self)))

    def release(self) -> None:
        """Lets all robots follow their own laws again."""
        self._run.wish(np.zeros((len(self), 3)), np.zeros(len(self), dtype=np.bool_))

    def order(self, kind: str, **fields: Any) -> None:
        """Does what `[[intervention]]` in a scenario does, before the next tick: `order("goal", robot=3,
        place_m=[4, 5, 0])`.

        Kinds and their fields are in scenarios/README.md. Robots go by their numbers (`ids`).
        """
        given = {name: value for name, value in fields.items() if value is not None}
        self._run.intervene(f"order = {_check.toml('order', {'kind': kind, **given})}")

    def set_goal(self, place: ArrayLike, robot: int | None = None) -> None:
        """Gives a robot another goal, metres, or all robots; a formation keeps its shape around that of its first."""
        self.order("goal", robot=robot, place_m=_check.point("place", place))

    def set_parameter(self, name: str, value: float, robot: int | None = None) -> None:
        """Changes a parameter of the guidance law or the safety layer, of a robot or of all that have it."""
        self.order("parameter", robot=robot, name=name, value=value)

    def set_radio(self, *, loss: float | None = None, range_m: float | None = None) -> None:
        """Changes the radio for everybody: probability of loss, farthest distance in metres."""
        self.order("radio", loss=loss, range_m=None if range_m is None else float(range_m))

    def take_down(self, robot: int, for_s: float | None = None) -> None:
        """Stops a robot's computer for so many seconds, or for good: it stands and is silent."""
        self.order("down", robot=robot, for_s=for_s)

    def page(self) -> Page:
        """What was recorded so far, as one HTML page that plays in any browser and shows itself in Jupyter."""
        html = self._run.page()
        if html is None:
            raise ValueError("nothing was recorded; give record=1 when the simulation is made")
        return Page(html)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the scenario with all orders, so that `staya run` makes the same run of it. File names in it are
        relative to the folder of the scenario that it was made of."""
        if self._run.has_wishes:
            raise ValueError(
                "robots were told velocities, which no scenario can say; give orders instead, or keep the program"
            )
        Path(path).write_text(self._run.scenario_text(), encoding="utf-8")

    def _repr_html_(self) -> str | None:
        return self.page()._repr_html_() if self._run.records else None


def _fields(fields: dict[str, Any]) -> dict[str, Any]:
    return {name.replace("__", "."): value for name, value in fields.items()}
