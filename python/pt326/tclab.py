"""Programs for the Temperature Control Lab, on a simulated rig: ``from pt326.tclab import TCLab, clock`` in place of ``from tclab import ...``.

All but the rig is that lab's own package (``pip install tclab``): its clock, which is real time unless ``setup`` makes it faster, its historian
and its plotter. Its makers have no part in this.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ._core import Config, Instrument
from ._frames import needed
from ._rig import Rig

_theirs = needed("tclab", "pt326.tclab")
Historian, Plotter = _theirs.Historian, _theirs.Plotter
clock, labtime, setnow = _theirs.clock, _theirs.labtime, _theirs.setnow

__all__ = [
    "Experiment",
    "Historian",
    "Plotter",
    "TCLab",
    "TCLabModel",
    "clock",
    "labtime",
    "runexperiment",
    "setnow",
    "setup",
]

#: The longest time between two samples of the rig, s (that of the lab's own model).
STEP = 0.2
#: ``P1`` with which ``Q1(100)`` is all that the rig's heater has: that with which the lab starts.
USUAL_P1 = 200.0


class TCLabModel(_theirs.TCLabModel):  # type: ignore[misc, name-defined]
    """The lab's own model with one of our rigs in it. It runs with ``labtime``, or, not ``synced``, up to ``update(t)``.

    ``preset`` is a rig of ``Rig.presets()``: tclab answers within minutes, as that lab does, trainer, a PT-326, within seconds. ``rig`` is the rig
    itself, to which faults can be done. T2 lies behind T1. There is no second heater: ``Q2`` and ``P2`` keep their values and warm nothing.
    """

    version = "pt326: simulated rig"

    def __init__(
        self,
        port: str = "",
        debug: bool = False,
        synced: bool = True,
        *,
        preset: str = "tclab",
        seed: int = 1,
        disturbance: str = "calm",
    ) -> None:
        super().__init__(port, debug, synced)
        self.port = port
        self._config = Config(preset)
        self.rig = Rig(preset, seed, disturbance, sample_time=min(self._config["sample_time"], STEP))
        self._read()

    def update(self, t: float | None = None) -> None:
        """Lets the rig run up to ``t`` s from the start on; without it, up to now, if it is ``synced``."""
        if t is None:
            t = labtime.time() - self.tstart if self.synced else 0.0
        power = min(100.0, self._Q1 * self._P1 / USUAL_P1)
        while self.rig.t + self.rig.sample_time <= t:
            self.rig.step(power)
        self._read()

    def measurement(self, T: float) -> float:
        """What a thermistor reads: the rig's readings have noise and steps of a converter already."""
        return T

    @property
    def T0(self) -> float:
        """Temperature of the room, degC: what that lab has not."""
        self.update()
        return self._T0

    def _read(self) -> None:
        # A new instrument for each reading: it has no sample before to doubt this one by.
        reads = Instrument(self._config)
        reads.control(self.rig.codes)
        self._T0, self._T1, self._T2 = (float("nan") if read is None else read for read in reads.temperatures)


class TCLab(TCLabModel):
    """The same where a program asks for the lab itself: in real time, and at no port."""

    def __init__(self, port: str = "", debug: bool = False, **rig: Any) -> None:
        if port:
            raise RuntimeError(f"port is {port!r}, expected none: this lab is simulated, no device is looked for")
        labtime.set_rate(1)
        super().__init__(port, debug, **rig)


class Experiment(_theirs.Experiment):  # type: ignore[misc, name-defined]
    """That package's own, with our labs: ``with Experiment(connected=False, synced=False) as experiment: ...``."""

    def __enter__(self) -> Experiment:
        self.lab = TCLab() if self.connected else TCLabModel(synced=self.synced)
        self.historian = Historian(self.lab.sources, dbfile=self.dbfile)
        if self.plot:
            self.plotter = Plotter(self.historian, twindow=self.twindow)
        return self


def runexperiment(function: Callable[[float, TCLabModel], object], *args: Any, **kwargs: Any) -> Experiment:
    """Calls ``function(t, lab)`` on every tick of an ``Experiment``, which it gives back."""
    with Experiment(*args, **kwargs) as experiment:
        for t in experiment.clock():
            function(t, experiment.lab)
    return experiment


def setup(connected: bool = True, speedup: float = 1.0) -> type[TCLabModel]:
    """``TCLab``, or, not ``connected``, ``TCLabModel`` with a ``labtime`` that is ``speedup`` times as fast as real time."""
    _theirs.setup(connected, speedup)
    return TCLab if connected else TCLabModel
