"""Recordings of heaters that something else controls."""

from __future__ import annotations

import io
import os
import warnings
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from . import _core, _frames
from ._core import Config, Monitor
from ._rig import Rig
from ._run import Run

#: What a column may be, as in ``pt326 diagnose --map``.
ROLES = ("time", "t0", "t1", "t2", "power", "known", "fan", "supply")


class Diagnosis(Run):
    """What a recording showed: a run without truth, with what was learnt of the heater."""

    def __init__(self, record: _core.Record, learnt: dict[str, Any], recording: _core.Recording) -> None:
        super().__init__(record)
        self._recording = recording
        #: Why the part that was learnt from is trusted.
        self.because: str = learnt["because"]
        #: What was learnt: gain in degC per %, times in s.
        self.model: dict[str, Any] = learnt["model"]
        #: 95 % intervals of what was looked for, by the names of ``model``; None: the samples do not tell it.
        self.intervals: dict[str, tuple[float, float] | None] = learnt["intervals"]
        #: What the samples do not tell, in words.
        self.unknown: list[str] = learnt["unknown"]
        #: How much of T1 the model explains where it was learnt, simulated, %.
        self.fit: float = learnt["fit"]
        #: The same of the rest; NaN where nothing is left.
        self.fit_on_the_rest: float = learnt["fit_on_the_rest"]
        #: The first time that was watched, s.
        self.watched_from: float = learnt["watched_from"]
        #: What whoever reads the results must know.
        self.remarks: list[str] = recording.remarks

    def monitor(self) -> Monitor:
        """A monitor that has learnt the same, for what comes next from this heater."""
        self._here("monitor")
        return self._recording.monitor()

    def __getstate__(self) -> dict[str, Any]:
        """All that is known of it, but not the recording, which stays in the process in which it was read."""
        self["t1_expected"]
        return {**super().__getstate__(), "_recording": None}

    def plot(self, figure: Any = None) -> Any:
        """Temperatures, what was expected, and what was said, made by pyplot; ``figure`` is one of the paper's."""
        return _frames.plots().diagnosis(self) if figure is None else super().plot(figure)

    def __repr__(self) -> str:
        return f"<pt326.Diagnosis of {len(self)} samples: {len(self.events)} events>"


def diagnose(
    recording: str | os.PathLike[str] | Mapping[str, Any] | Any,
    *,
    time: str | None = None,
    t0: str | None = None,
    t1: str | None = None,
    t2: str | None = None,
    power: str | None = None,
    known: str | None = None,
    fan: str | None = None,
    supply: str | None = None,
    heater: int = 1,
    train: tuple[float, float] | None = None,
    train_on: str | os.PathLike[str] | Mapping[str, Any] | Any = None,
    from_rest: bool = False,
    force: bool = False,
    ts: float | None = None,
    time_unit: Literal["ns", "us", "ms", "s", "min", "h", "d"] | None = None,
    resample: bool = False,
    full_power: float | None = None,
    degc: float | None = None,
    has_fan: bool | None = None,
    config: Config | None = None,
    progress: bool | _frames.Progress = True,
) -> Diagnosis:
    """Diagnoses the recording of a heater that something else controls: ``pt326 diagnose``.

    ``recording`` is a file, a data frame, or a mapping of columns. ``time`` to ``supply`` say which column is what; left out: guessed from the
    header. It learns from the part ``train`` (from, to in s), from another recording ``train_on``, or from a part that seems normal.
    A model that explains less than 30 % of T1 is refused unless ``force``; below 60 % a warning tells why.
    """
    roles = (time, t0, t1, t2, power, known, fan, supply)
    other = {} if train_on is None else {f"other_{kind}": of for kind, of in _source(train_on).items()}
    read = _read(recording, roles, ts, time_unit, resample, full_power, degc, has_fan, **other)
    if from_rest:
        read.put_rest_before()
    with _frames.shown("samples", progress) as tell:
        record, learnt = read.diagnose(
            heater=heater,
            train=train,
            from_rest=from_rest,
            force=force,
            config=config,
            progress=tell,
        )
    if warning := learnt.pop("warning"):
        warnings.warn(warning, stacklevel=2)
    return Diagnosis(record, learnt, read)


class FittedRig:
    """A simulated rig that answers as a recorded one does: ``run(fitted.scenario)``, or tick by tick ``fitted.rig()``."""

    def __init__(self, fitted: dict[str, Any], sample_time: float) -> None:
        #: The rig as a scenario without faults: add some, and give it to ``run``, ``repeat``, ``isolability`` or ``tune``.
        self.scenario: dict[str, Any] = fitted["scenario"]
        #: The same as ``pt326 fit-rig`` writes it.
        self.toml: str = fitted["toml"]
        #: How much of T1 its model explains, simulated, %.
        self.fit: float = fitted["fit"]
        #: What of the recorded rig no simulated one can have, with what stands in its place.
        self.beyond: list[str] = fitted["beyond"].splitlines()
        #: Ts of the recording, s.
        self.sample_time = sample_time

    def rig(self, seed: int = 1, disturbance: Literal["none", "calm", "lively"] = "none") -> Rig:
        """It in motion, with the sample time of the recording."""
        return Rig("paper", seed, disturbance, sample_time=self.sample_time, constants=self.scenario["rig"])

    def __str__(self) -> str:
        return self.toml

    def __repr__(self) -> str:
        return f"<pt326.FittedRig: {self.fit:.1f} % of T1>"


def fit_rig(
    recording: str | os.PathLike[str] | Mapping[str, Any] | Any,
    *,
    time: str | None = None,
    t0: str | None = None,
    t1: str | None = None,
    t2: str | None = None,
    power: str | None = None,
    known: str | None = None,
    fan: str | None = None,
    supply: str | None = None,
    heater: int = 1,
    ts: float | None = None,
    time_unit: Literal["ns", "us", "ms", "s", "min", "h", "d"] | None = None,
    resample: bool = False,
    full_power: float | None = None,
    degc: float | None = None,
    has_fan: bool | None = None,
    progress: bool | _frames.Progress = True,
) -> FittedRig:
    """Fits a simulated rig to a recording without a fault, in which the power moves: ``pt326 fit-rig``.

    ``recording`` and the columns are given as to ``diagnose``. Gain, lags, dead time and wall are those of the model that the diagnosis learns; what
    that leaves unexplained becomes noise and wander. What one thermistor cannot tell is the reference rig's.
    """
    roles = (time, t0, t1, t2, power, known, fan, supply)
    read = _read(recording, roles, ts, time_unit, resample, full_power, degc, has_fan)
    with _frames.shown("samples", progress) as tell:
        fitted = read.fit_rig(heater, tell)
    if warning := fitted["warning"]:
        warnings.warn(warning, stacklevel=2)
    return FittedRig(fitted, read.sample_time)


def _read(
    recording: Any,
    roles: tuple[str | None, ...],
    ts: float | None,
    time_unit: str | None,
    resample: bool,
    full_power: float | None,
    degc: float | None,
    has_fan: bool | None,
    **other: Any,
) -> _core.Recording:
    """A recording, and another of the same heater with it."""
    if roles[0] is None and (when := _dates(recording)) is not None:
        roles = (when, *roles[1:])
    columns = [f"{role}={column}" for role, column in zip(ROLES, roles, strict=True) if column is not None]
    reading: dict[str, object] = {
        "map": columns,
        "ts": ts,
        "time_unit": time_unit,
        "resample": resample,
        "full_power": full_power,
        "degc": degc,
        "fan": has_fan,
    }
    return _core.Recording(**_source(recording), **other, reading=reading)


def _source(recording: Any) -> dict[str, Any]:
    """A file by its path, and all else as the text of one."""
    return {"path": recording} if isinstance(recording, (str, os.PathLike)) else {"text": _as_csv(recording)}


def _as_csv(columns: Any) -> str:
    """A mapping or a data frame as CSV; numbers are written so that the same are read."""
    named = {str(name): columns[name] for name in getattr(columns, "columns", columns)}
    if (when := _dates(columns)) is not None:
        named = {when: columns.index, **named}
    cells = [_cells(np.asarray(column)) for column in named.values()]
    text = io.StringIO()
    text.write(",".join(f'"{name}"' for name in named) + "\n")
    text.writelines(",".join(row) + "\n" for row in zip(*cells, strict=True))
    return text.getvalue()


def _dates(frame: Any) -> str | None:
    """The name of the column that a DatetimeIndex becomes, one that no other column has."""
    index = getattr(frame, "index", None)
    if not hasattr(index, "tz"):
        return None
    name = str(getattr(index, "name", None) or "time")
    while name in frame.columns:
        name += "_"
    return name


def _cells(column: Any) -> list[str]:
    if column.dtype.kind == "M":  # dates, which tolist() makes numbers of
        return ["" if np.isnat(date) else np.datetime_as_string(date) for date in column]
    return ["" if value is None or value != value else str(value) for value in column.tolist()]
