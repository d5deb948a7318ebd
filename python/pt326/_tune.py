"""PID settings for a rig."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _core, _frames
from ._core import Config
from ._run import Disturbance

if TYPE_CHECKING:
    from numpy.typing import NDArray

Rule = Literal["relay", "model", "quick"]


class Tuning:
    """A rig as a lag with dead time, found by an experiment, and the PID settings that each rule makes of it; ``print`` tells all."""

    def __init__(self, found: dict[str, Any]) -> None:
        #: The rig: degC per %.
        self.gain: float = found["gain"]
        #: The rig: time constant, s.
        self.time: float = found["time"]
        #: The rig: dead time, s, with that of sampling in it.
        self.dead: float = found["dead"]
        #: What each rule proposes (kp in % per degC, ti and td in s) and what is to be expected of it: overshoot_pct, settled_s, gain_margin,
        #: phase_margin_deg. A rule whose loop would not settle in 20 time constants is not there.
        self.rules: dict[str, dict[str, float]] = found["rules"]
        #: The experiment: time, s.
        self.t: NDArray[np.float64] = found["t"]
        #: The experiment: what T1 read, degC.
        self.t1: NDArray[np.float64] = found["t1"]
        #: The experiment: what the heater got, %.
        self.power: NDArray[np.float64] = found["power"]
        self._before: Config = found["config"]
        self._text: str = found["text"]

    def config(self, rule: Rule = "quick") -> Config:
        """The settings with what a rule proposes, for ``run(config=...)``, ``Instrument`` or ``pt326 --config``."""
        if rule not in self.rules:
            raise KeyError(f"{rule!r}, expected one of {', '.join(self.rules)}")
        config = self._before.copy()
        for name in ("kp", "ti", "td"):
            config[f"pid.{name}"] = self.rules[rule][name]
        return config

    def plot(self) -> Any:
        """T1 and the power during the experiment, made by pyplot."""
        return _frames.plots().tuning(self)

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return (
            f"<pt326.Tuning: {self.gain:.3g} degC per %, time constant {self.time:.3g} s, dead time {self.dead:.3g} s>"
        )


def tune(
    scenario: str | os.PathLike[str] | dict[str, Any] | None = None,
    *,
    config: Config | None = None,
    seed: int = 1,
    preset: str | None = None,
    disturbance: Disturbance | None = None,
) -> Tuning:
    """Finds PID settings for a simulated rig, as ``tune start`` on the board's console does for a real one.

    The rig is that of the scenario, cold, without its faults. It is heated by a constant power until T1 stands still, then a relay switches the
    power up and down. Where that comes to no result, the Error says why.
    """
    return Tuning(_core.tune(scenario, config=config, seed=seed, preset=preset, disturbance=disturbance))
