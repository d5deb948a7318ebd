"""Experiments on the simulated rig."""

from __future__ import annotations

import copy
import hashlib
import os
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _core, _frames
from ._core import Config
from ._error import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

Disturbance = Literal["none", "calm", "lively"]


class Run:
    """A run, whole: ``run["t1_c"]`` is a column of trace.csv, ``run.summary`` the scores, ``run.events`` what was said and when.

    It can be copied and pickled, so that a pool of processes gives runs back; ``write`` works where it was run.
    """

    def __init__(self, record: _core.Record) -> None:
        self._record: _core.Record | None = record

    def __getstate__(self) -> dict[str, Any]:
        """All that is known of it; the record itself stays in the process in which it was made."""
        for column in self.columns:
            self[column]
        for what in ("summary", "events", "sample_time", "_sigma_factor", "_trace", "_table"):
            getattr(self, what)
        return {**self.__dict__, "_record": None}

    def __copy__(self) -> Run:
        twin: Run = object.__new__(type(self))
        twin.__dict__.update(self.__dict__)
        return twin

    def __deepcopy__(self, memo: dict[int, Any]) -> Run:
        twin = copy.copy(self)
        for name, value in self.__dict__.items():
            if not isinstance(value, (_core.Record, _core.Recording)):  # which nobody changes
                twin.__dict__[name] = copy.deepcopy(value, memo)
        return twin

    def _here(self, what: str) -> _core.Record:
        if self._record is None:
            raise Error(f"{what} of a run that another process has made: expected in that one")
        return self._record

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return _core.Record.columns()

    def unit(self, column: str) -> str:
        """Unit of a column; empty where it has none."""
        return _core.Record.unit(column)

    def __getitem__(self, column: str) -> NDArray[Any]:
        """A column: float64 with NaN where it is not defined, or words with None."""
        if column not in self._columns:
            values = self._here(column).column(column)
            self._columns[column] = values if isinstance(values, np.ndarray) else np.array(values, dtype=object)
        return self._columns[column]

    @cached_property
    def _columns(self) -> dict[str, NDArray[Any]]:
        return {}

    def __len__(self) -> int:
        """Number of ticks."""
        return len(self.t)

    @property
    def t(self) -> NDArray[np.float64]:
        """Time of each tick, s."""
        return self["t_s"]

    @cached_property
    def sample_time(self) -> float:
        """Ts, s."""
        return self._here("sample_time").sample_time

    @cached_property
    def _sigma_factor(self) -> float:
        return self._here("sigma_factor").sigma_factor

    @cached_property
    def summary(self) -> dict[str, Any]:
        """All scores, as in summary.json."""
        return self._here("summary").summary()

    @property
    def faults(self) -> list[dict[str, Any]]:
        """How each fault was seen, by both diagnoses."""
        faults: list[dict[str, Any]] = self.summary["faults"]
        return faults

    @cached_property
    def events(self) -> list[dict[str, Any]]:
        """What was said, from when until when: alarms and names of the likelihood diagnosis and of the paper's, and trips."""
        return self._here("events").events()

    @property
    def sentences(self) -> list[str]:
        """What the likelihood diagnosis called each fault, as sentences."""
        return [event["sentence"] for event in self.events if event["sentence"]]

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """All columns."""
        return {column: self[column] for column in self.columns}

    def to_pandas(self) -> Any:
        """All columns as a pandas.DataFrame."""
        return _frames.to_pandas(self.to_dict())

    def to_polars(self) -> Any:
        """All columns as a polars.DataFrame."""
        return _frames.to_polars(self.to_dict())

    def trace(self) -> str:
        """trace.csv."""
        return self._trace

    @cached_property
    def _trace(self) -> str:
        return self._here("trace").trace()

    @cached_property
    def _table(self) -> str:
        return self._here("table").table()

    def hash(self) -> str:
        """SHA-256 of trace.csv: of equal runs it is equal, here and at the command line."""
        return hashlib.sha256(self.trace().encode()).hexdigest()

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes what ``pt326 run`` writes: trace.csv, summary.json, figures, report.html."""
        self._here("write").write(folder)

    def plot(self, figure: Literal[4, 5, 6] = 6) -> Any:
        """A figure of the paper, made by pyplot: 4 what is measured, 5 features, 6 residuals and what was said."""
        return _frames.plots().figure(self, figure)

    def __str__(self) -> str:
        return self._table

    def __repr__(self) -> str:
        return f"<pt326.Run of {len(self)} ticks>"


def run(
    scenario: str | os.PathLike[str] | dict[str, Any] | None = None,
    *,
    config: Config | None = None,
    seed: int = 1,
    preset: str | None = None,
    disturbance: Disturbance | None = None,
    fault_size: str | float = "nominal",
) -> Run:
    """Runs an experiment on the simulated rig: ``pt326 run``, to the same bits.

    ``scenario`` is the path of a TOML (``pt326 scenario``) or a dict (``pt326.scenario()``), by default the paper's experiment. ``preset`` names
    another rig, with its settings unless ``config`` has some; ``fault_size`` is small, nominal, large, or a factor.
    """
    return Run(
        _core.run(scenario, config=config, seed=seed, preset=preset, disturbance=disturbance, fault_size=fault_size)
    )


def repeat(
    scenario: str | os.PathLike[str] | dict[str, Any] | None = None,
    *,
    config: Config | None = None,
    runs: int = 200,
    first_seed: int = 1,
    preset: str | None = None,
    disturbance: Disturbance | None = None,
    fault_size: str | float = "nominal",
    progress: bool | _frames.Progress = True,
) -> dict[str, Any]:
    """Runs an experiment with many seeds on all cores: ``pt326 repeat --json``. Ctrl-C ends it."""
    with _frames.shown("runs", progress) as tell:
        return _core.repeat(
            scenario,
            config=config,
            runs=runs,
            first_seed=first_seed,
            preset=preset,
            disturbance=disturbance,
            fault_size=fault_size,
            progress=tell,
        )


def isolability(
    scenario: str | os.PathLike[str] | dict[str, Any] | None = None,
    *,
    config: Config | None = None,
    seed: int = 1,
    preset: str | None = None,
    disturbance: Disturbance | None = None,
    within: Sequence[float] = (1.0, 10.0, 60.0),
    equal_odds: bool = False,
    progress: bool | _frames.Progress = True,
) -> list[dict[str, Any]]:
    """Which faults can be told apart on a rig, how soon (``within`` so many s), and from which size on: ``pt326 isolability``.

    A row for each fault, what it is told ``from``, and time; ``told`` is never, any or above, and then ``size`` says from which size on.
    """
    with _frames.shown("ticks", progress) as tell:
        return _frames.rows_of(
            _core.isolability(
                scenario,
                config=config,
                seed=seed,
                preset=preset,
                disturbance=disturbance,
                within=list(within),
                equal_odds=equal_odds,
                progress=tell,
            )
        )
