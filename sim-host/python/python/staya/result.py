"""Results of a run."""

from __future__ import annotations

import html
import json
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas
    import polars

    from ._staya import Run

Table = Literal["trace", "series"]
Columns = dict[str, NDArray[Any]]

_MODES = np.array(["idle", "forming", "cruise", "hold", "arrived", "down", "passive"])
_WAITS = np.array(["team", "stopped", "route", "radio", "turn", "robots", "goal_taken"])


def figures(run: Run) -> dict[str, Any]:
    """The summary of a run so far, as printed by `staya run --json`."""
    summary: dict[str, Any] = json.loads(run.summary())
    return summary


class Page:
    """A run as one HTML page without server and network; displayed inline in Jupyter."""

    def __init__(self, text: str) -> None:
        self.html = text

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the page to a file."""
        Path(path).write_text(self.html, encoding="utf-8")

    def _repr_html_(self, height_px: int = 480) -> str:
        inside = html.escape(self.html, quote=True)
        style = f"width: 100%; height: {height_px}px; border: 0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{inside}"></iframe>'


class Result:
    """Results of a run: `summary`, `trace` with a line per robot and sampled tick, `series` with a
    line per tick.

    Tables are dictionaries of numpy arrays named like the columns of `staya run`'s files;
    `to_pandas` and `to_polars` convert them.
    """

    def __init__(
        self, columns: dict[str, Columns], summary: dict[str, Any], page: Callable[[], str | None] | None
    ) -> None:
        self.summary = summary
        self.trace: Columns = dict(columns["trace"])
        self.series: Columns = dict(columns["series"])
        for name, words in [("mode", _MODES), ("wait", _WAITS)]:
            codes = self.trace[name]
            self.trace[name] = np.append(words, "")[np.minimum(codes, len(words))]
        self._page = page

    def __getstate__(self) -> dict[str, Any]:
        text = None if self._page is None else self._page()
        return {"summary": self.summary, "trace": self.trace, "series": self.series, "page": text}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.summary, self.trace, self.series = state["summary"], state["trace"], state["series"]
        text: str | None = state["page"]
        self._page = None if text is None else lambda: text

    @property
    def trace_hash(self) -> str:
        """Trace hash of the run, 16 hex digits."""
        return str(self.summary["trace_hash"])

    def to_pandas(self, table: Table = "trace") -> pandas.DataFrame:
        """A table as a pandas DataFrame; needs pandas."""
        import pandas

        return pandas.DataFrame(self._table(table))

    def to_polars(self, table: Table = "trace") -> polars.DataFrame:
        """A table as a polars DataFrame; needs polars."""
        import polars

        return polars.DataFrame(self._table(table))

    def page(self) -> Page:
        """The run as a page; the simulation must record."""
        text = None if self._page is None else self._page()
        if text is None:
            raise ValueError("nothing was recorded; give record=1 when you create the simulation")
        return Page(text)

    def _table(self, table: Table) -> Columns:
        if table not in ("trace", "series"):
            raise ValueError(f'table is {table!r}; give "trace" or "series"')
        return self.trace if table == "trace" else self.series

    def __repr__(self) -> str:
        summary = self.summary
        arrived = f"{summary['arrived']} of {summary['robots']} robots arrived"
        return f"<Result of {summary['scenario']!r}: {arrived}, {summary['ticks']} ticks, hash {summary['trace_hash']}>"

    def _repr_html_(self) -> str:
        if self._page is not None:
            return self.page()._repr_html_()
        names = ["scenario", "seed", "robots", "arrived", "ticks", "sim_seconds", "collisions", "trace_hash"]
        lines = "".join(f"<tr><th>{name}</th><td>{html.escape(str(self.summary[name]))}</td></tr>" for name in names)
        return f"<table>{lines}</table>"
