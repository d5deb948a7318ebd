"""Campaigns, and detectors of others scored in them."""

from __future__ import annotations

import copy
import os
from collections.abc import Callable
from functools import cached_property
from typing import Any, Protocol

from . import _core, _frames
from ._core import Config

Definition = str | os.PathLike[str] | dict[str, Any]


class Detector(Protocol):
    """Whatever can be asked, tick by tick, whether something is wrong.

    It may have ``armed``, a bool: what it says before it watches is not held against it, and what happens then it is not asked for.
    """

    def step(self, t0: float, t1: float, t2: float, power: float, /) -> str | None:
        """Temperatures in degC (NaN where a thermistor reads nothing) and the power from now on in %.

        Gives None where all is well, the name of a class (``Finding.classes()``), or any other word for an alarm without a name.
        """
        ...


class Campaign:
    """What the runs of a campaign showed."""

    def __init__(self, cells: _core.Cells) -> None:
        self._cells = cells

    @cached_property
    def results(self) -> dict[str, Any]:
        """All results, as in campaign.json."""
        return self._cells.results()

    @cached_property
    def runs(self) -> list[dict[str, Any]]:
        """The few numbers that are kept of each run, as in runs.csv."""
        return _frames.rows_of(self._cells.runs_csv())

    def to_pandas(self) -> Any:
        """The runs as a pandas.DataFrame."""
        return _frames.to_pandas(self.runs)

    def to_polars(self) -> Any:
        """The runs as a polars.DataFrame."""
        return _frames.to_polars(self.runs)

    def write(self, folder: str | os.PathLike[str]) -> str:
        """Writes what ``pt326 campaign`` writes: campaign.json, cells.csv, runs.csv, tables and pictures. Gives their names."""
        return self._cells.write(folder)

    def __str__(self) -> str:
        return self._cells.table()

    def __repr__(self) -> str:
        return f"<pt326.Campaign of {len(self._cells.names)} cells>"


def campaign(
    definition: Definition = "default",
    *,
    config: Config | None = None,
    only: str | None = None,
    scale: float | None = None,
    first_seed: int | None = None,
    progress: bool | _frames.Progress = True,
) -> Campaign:
    """Runs a campaign on all cores: ``pt326 campaign``. Ctrl-C ends it.

    ``definition`` is default, quick, physics or ablation, the path of a TOML, or a dict. ``only`` is in the names of the cells that are wanted,
    ``scale`` multiplies the numbers of runs.
    """
    cells = _core.Cells(definition, config=config, only=only, scale=scale, first_seed=first_seed)
    with _frames.shown("runs", progress) as tell:
        cells.run(progress=tell)
    return Campaign(cells)


class Evaluation(Campaign):
    """A detector beside both of ours: a row for each cell and detector."""

    def __init__(self, cells: _core.Cells, observers: list[_core.Observer], name: str) -> None:
        super().__init__(cells)
        self.name = name
        theirs = cells.results_of(observers)["cells"]
        said = [(cell, other["likelihood"]) for cell, other in zip(self.results["cells"], theirs, strict=True)]
        self.rows = [
            _row(cell, by, statistics)
            for cell, other in said
            for by, statistics in ((name, other), ("likelihood", cell["likelihood"]), ("signature", cell["signature"]))
        ]

    def to_pandas(self) -> Any:
        """The rows as a pandas.DataFrame."""
        return _frames.to_pandas(self.rows)

    def to_polars(self) -> Any:
        """The rows as a polars.DataFrame."""
        return _frames.to_polars(self.rows)

    def plot(self) -> Any:
        """Detected, rightly named, how soon, and how often for nothing, made by pyplot."""
        return _frames.plots().evaluation(self)

    def __str__(self) -> str:
        lines = [
            f"{'cell':<34} {'detector':<14} {'runs':>5} {'seen %':>7} {'named %':>8} {'delay s':>8} {'alarms/h':>9}"
        ]
        for row in self.rows:
            cell = row["cell"] if row["by"] == self.name else ""
            lines.append(
                f"{cell:<34.34} {row['by']:<14.14} {row['runs']:>5} {_cell(row['detected_pct'], 0):>7} "
                f"{_cell(row['isolated_pct'], 0):>8} {_cell(row['delay_s'], 2):>8} {_cell(row['alarms_per_hour'], 2):>9}"
            )
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<pt326.Evaluation of {self.name}>"


def _cell(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _row(cell: dict[str, Any], by: str, statistics: dict[str, Any]) -> dict[str, Any]:
    fault, runs = statistics["fault"], statistics["runs"]

    def share(count: str) -> float | None:
        return 100.0 * (1.0 - fault[count] / fault["runs"]) if fault else None

    return {
        "cell": cell["name"] + (f" [{cell['setting']}]" if cell["setting"] else ""),
        "by": by,
        "runs": runs,
        "unarmed": statistics["unarmed"],
        "detected_pct": share("missed"),
        "isolated_pct": share("not_isolated"),
        "delay_s": fault["detection_delay_s"]["median"] if fault else None,
        "delay_95_s": fault["detection_delay_s"]["p95"] if fault else None,
        "isolation_delay_s": fault["isolation_delay_s"]["median"] if fault else None,
        "alarms": statistics["alarms"]["alarms"],
        "hours": statistics["alarms"]["hours"],
        "alarms_per_hour": statistics["alarms"]["per_hour"],
    }


def evaluate(
    detector: Detector | Callable[[], Detector],
    campaign: Definition = "quick",
    *,
    name: str | None = None,
    config: Config | None = None,
    only: str | None = None,
    scale: float | None = None,
    first_seed: int | None = None,
    progress: bool | _frames.Progress = True,
) -> Evaluation:
    """Scores anybody's detector beside both of ours over the runs of a campaign, by the same rules.

    ``detector`` is a class or another callable that gives a new one for each run, or one that is copied for each. The instrument regulates;
    all three look on. ``campaign``, ``only`` and ``scale`` are those of ``campaign()``.
    """
    cells = _core.Cells(campaign, config=config, only=only, scale=scale, first_seed=first_seed)
    runs, observers = cells.runs, []
    if hasattr(detector, "step") and not isinstance(detector, type):
        called = type(detector).__name__
    else:
        called = getattr(detector, "__name__", "detector")
    batch = 4 * (os.cpu_count() or 1)
    with _frames.shown("runs", progress) as tell:
        for start in range(0, len(runs), batch):
            some = runs[start : start + batch]
            for (cell, run), seen in zip(some, cells.watch(some), strict=True):
                observer = cells.observer(cell, run)
                observer.watch(_new(detector), seen)
                observers.append(observer)
                if tell is not None:
                    tell(len(observers), len(runs))
    return Evaluation(cells, observers, name or called)


def _new(detector: Any) -> Any:
    if hasattr(detector, "step") and not isinstance(detector, type):
        return copy.deepcopy(detector)
    return detector()
