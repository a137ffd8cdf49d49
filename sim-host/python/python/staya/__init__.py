"""Swarms of robots, each with its own onboard controller.

`Simulation` runs a scenario with the trace hash of the command `staya run`. `orca`, `route` and the
laws in `staya.flock` are single behaviours of the controller, applied to all robots at once, with
the settings that `staya.settings` describes.
`staya.rl` (the extra `rl`) has environments for Gymnasium and PettingZoo. Units are metres, seconds
and metres per second; x is east, y north, z up.
"""

from . import flock, settings
from ._staya import ScenarioError, __version__
from .behaviors import Negotiation, Orca, Routes, orca, route
from .result import Page, Result
from .simulation import Mode, Simulation

__all__ = ["Mode", "Negotiation", "Orca", "Page", "Result", "Routes", "ScenarioError", "Simulation", "__version__", "flock", "orca", "route", "settings"]
