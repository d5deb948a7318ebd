"""The interface of the Temperature Control Lab's Python package, for programs that were written for it: on a simulated PT-326.

Names and meaning of what is called are those of that package; nothing of it is used here, and its makers have no part in this. One line is
changed in such a program: ``from pt326.tclab import TCLab, clock``. Time is that of the simulation: ``clock`` lets it pass, and nobody waits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import TracebackType
from typing import Any

from ._core import Config, Instrument
from ._rig import Rig

_open: list[TCLab] = []


class TCLab:
    """A rig with a heater and two thermistors: ``Q1(power)``, ``T1``, ``T2``.

    ``preset`` is a rig of ``Rig.presets()``: trainer, a PT-326, answers within seconds; tclab within minutes, as that lab does. ``rig`` is the rig
    itself, to which faults can be done. There is no second heater: ``Q2`` keeps its value and warms nothing.
    """

    def __init__(self, preset: str = "trainer", seed: int = 1, disturbance: str = "calm") -> None:
        self.rig = Rig(preset, seed, disturbance)
        # Off for ever: it reads the thermistors.
        self._reads = Instrument(Config(preset))
        self._power = [0.0, 0.0]
        self.P1, self.P2 = 200.0, 100.0
        self._led = 0.0
        self._sample()
        _open.append(self)

    def __enter__(self) -> TCLab:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Heaters off."""
        self._power = [0.0, 0.0]
        if self in _open:
            _open.remove(self)

    @property
    def T1(self) -> float:
        """Temperature at the heater's outlet, degC; NaN where the thermistor reads nothing."""
        return self._temperatures[1]

    @property
    def T2(self) -> float:
        """Temperature behind T1, degC."""
        return self._temperatures[2]

    @property
    def T0(self) -> float:
        """Temperature of the room, degC: what that lab has not."""
        return self._temperatures[0]

    def Q1(self, value: float | None = None) -> float:
        """Sets the power of the heater, % (held to 0 to 100), where one is given; gives it."""
        return self._set(0, value)

    def Q2(self, value: float | None = None) -> float:
        """The same of a second heater, which there is not."""
        return self._set(1, value)

    @property
    def U1(self) -> float:
        """The power of the heater, %, as an attribute."""
        return self.Q1()

    @U1.setter
    def U1(self, value: float) -> None:
        self.Q1(value)

    @property
    def U2(self) -> float:
        """The same of a second heater, which there is not."""
        return self.Q2()

    @U2.setter
    def U2(self, value: float) -> None:
        self.Q2(value)

    def LED(self, value: float = 100.0) -> float:
        """Sets the brightness of a lamp, which there is not, %; gives it."""
        self._led = max(0.0, min(100.0, float(value)))
        return self._led

    @property
    def scan(self) -> tuple[float, float, float, float]:
        """T1, T2, Q1, Q2."""
        return self.T1, self.T2, self.Q1(), self.Q2()

    @property
    def version(self) -> str:
        """What this is."""
        return "pt326: simulated PT-326"

    @property
    def sources(self) -> list[tuple[str, Callable[[], float]]]:
        """What can be logged, by its name."""
        return [("T1", lambda: self.T1), ("T2", lambda: self.T2), ("Q1", self.Q1), ("Q2", self.Q2)]

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self.rig.t

    def wait(self, seconds: float) -> None:
        """Lets simulated time pass."""
        end = self.rig.t + seconds
        while self.rig.t < end - 1e-9:
            self.rig.step(self._power[0])
            self._sample()

    def _set(self, which: int, value: float | None) -> float:
        if value is not None:
            self._power[which] = max(0.0, min(100.0, float(value)))
        return self._power[which]

    def _sample(self) -> None:
        self._reads.control(self.rig.codes)
        nothing = float("nan")
        self._temperatures = [nothing if t is None else t for t in self._reads.temperatures]


def clock(period: float, step: float = 1.0, tol: float = float("inf"), adaptive: bool = True) -> Iterator[float]:
    """Gives the time every ``step`` s from 0 to ``period``, and lets the rigs that are open run meanwhile.

    Nobody waits, so nothing is ever late: ``tol`` and ``adaptive`` are there for programs that give them.
    """
    count = 0
    while count * step <= period + 1e-9:
        yield count * step
        for lab in list(_open):
            lab.wait(step)
        count += 1


def setup(connected: bool = True, speedup: float = 1.0) -> Callable[..., Any]:
    """Gives ``TCLab``. There is nothing to connect to, and simulated time passes as fast as it can."""
    del connected, speedup
    return TCLab
