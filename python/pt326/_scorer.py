"""The diagnosis with the calls of PyOD and River."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._core import Config, Monitor, Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: What a sample has, in the order of the columns of an array: degC, and what drives the heater from the sample on, %.
FEATURES = ("t0", "t1", "t2", "power")


class Scorer:
    """The diagnosis as PyOD calls a detector (``fit``, ``decision_function``, ``predict``), and as River does (``learn_one``, ``score_one``).

    The score is how far T1 and T2 read from what the models expect, degC, the larger of both; 0 until it watches. ``predict`` says whether it is
    alarmed, which is no threshold on the score. Samples are in the order of time, each ``sample_time`` of ``config`` after the last. ``fit`` takes
    at least ``likelihood.fit_time`` and ``likelihood.check_time`` of them without a fault.
    """

    def __init__(self, config: Config | None = None) -> None:
        self.monitor = Monitor(config)

    def fit(self, X: Any, y: object = None) -> Scorer:
        """Learns what is normal from rows of t0, t1, t2 and power: an array, a data frame or a mapping of columns."""
        for row in _rows(X):
            self.learn_one(row)
        return self

    def decision_function(self, X: Any) -> NDArray[np.float64]:
        """The score of each row, as if these came right after what it has seen; that it forgets again."""
        return np.array([_score(report, row) for report, row in self._watched(X)], dtype=np.float64)

    def predict(self, X: Any) -> NDArray[np.int64]:
        """Whether it is alarmed on each row, 1 or 0."""
        return np.array([int(report.alarm) for report, _ in self._watched(X)], dtype=np.int64)

    def learn_one(self, x: Mapping[str, Any]) -> None:
        """Takes in a sample that is normal: ``{"t0": .., "t1": .., "t2": .., "power": ..}``; what is missing may be left out."""
        self.monitor.step(**x, learn=True)

    def score_one(self, x: Mapping[str, Any]) -> float:
        """Takes in the next sample, and gives its score."""
        return _score(self.monitor.step(**x), x)

    def _watched(self, X: Any) -> list[tuple[Report, Mapping[str, Any]]]:
        monitor = copy.copy(self.monitor)
        return [(monitor.step(**row), row) for row in _rows(X)]


def _score(report: Report, row: Mapping[str, Any]) -> float:
    off = [
        abs(row[name] - at)
        for name, at in zip(FEATURES[1:3], report.expected[1:], strict=True)
        if name in row and at is not None
    ]
    return float(np.nanmax([0.0, *off]))


def _rows(X: Any) -> list[dict[str, Any]]:
    """Samples by their names; numbers that are missing stay NaN."""
    if isinstance(X, Mapping) or hasattr(X, "columns"):
        columns = {name: np.asarray(X[name], dtype=np.float64) for name in FEATURES if name in X}
    else:
        columns = dict(zip(FEATURES, np.asarray(X, dtype=np.float64).T, strict=True))
    return [dict(zip(columns, map(float, row), strict=True)) for row in zip(*columns.values(), strict=True)]
