"""The simulated rig, with what can happen to it as verbs."""

from __future__ import annotations

from typing import Literal

from . import _core

Sensor = Literal["t0", "t1", "t2"]


class Rig(_core.Rig):
    """The simulated rig in motion: ``step(power)`` drives the heater until the next tick and gives its codes.

    What happens to it begins now, or in ``at`` s, and lasts for ``duration`` s, or until ``mend()``.
    """

    def offset(self, sensor: Sensor, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """A sensor reads ``size`` degC too high (negative: too low)."""
        self._do("offset", at, duration, sensor=sensor, size=size)

    def drift(self, sensor: Sensor, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """A sensor's error grows by ``size`` degC a minute."""
        self._do("drift", at, duration, sensor=sensor, size=size)

    def clog(
        self, sensor: Sensor, size: float, *, lag: float | None = None, at: float = 0.0, duration: float = 1e9
    ) -> None:
        """A sensor sees ``size`` times the rise of the air, with the time constant ``lag`` s."""
        self._do("clog", at, duration, sensor=sensor, size=size, lag=lag)

    def open(self, sensor: Sensor, *, at: float = 0.0, duration: float = 1e9) -> None:
        """A sensor's wire is broken."""
        self._do("open", at, duration, sensor=sensor)

    def short(self, sensor: Sensor, *, at: float = 0.0, duration: float = 1e9) -> None:
        """A sensor's wires touch."""
        self._do("short", at, duration, sensor=sensor)

    def stuck(self, sensor: Sensor, *, at: float = 0.0, duration: float = 1e9) -> None:
        """A sensor repeats its last code."""
        self._do("stuck", at, duration, sensor=sensor)

    def freeze(self, sensor: Sensor, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """A sensor repeats its last code, with noise of the standard deviation ``size`` codes."""
        self._do("freeze", at, duration, sensor=sensor, size=size)

    def loose(self, sensor: Sensor, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """A sensor's contact is loose: it reads ``size`` degC too high, or right, each for 40 s in the mean."""
        self._do("loose", at, duration, sensor=sensor, size=size)

    def spike(self, sensor: Sensor, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """One single sample of a sensor is ``size`` degC off."""
        self._do("spike", at, duration, sensor=sensor, size=size)

    def missing(self, sensor: Sensor, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """Samples of a sensor go missing with the probability ``size``."""
        self._do("missing", at, duration, sensor=sensor, size=size)

    def detach(
        self,
        sensor: Sensor,
        size: float = 1.0,
        *,
        over: float | None = None,
        lag: float | None = None,
        at: float = 0.0,
        duration: float = 1e9,
    ) -> None:
        """A sensor slides out of the tube in ``over`` s: it sees 1 - ``size`` of the rise, with the time constant ``lag`` s."""
        self._do("detach", at, duration, sensor=sensor, size=size, over=over, lag=lag)

    def swap(self, sensor: Sensor, other: Sensor, *, at: float = 0.0, duration: float = 1e9) -> None:
        """Two sensors are exchanged at their inputs."""
        self._do("swap", at, duration, sensor=sensor, **{"with": other})

    def air_flow(self, size: float, *, over: float | None = None, at: float = 0.0, duration: float = 1e9) -> None:
        """The air flow is ``size`` times the nominal one."""
        self._do("air-flow", at, duration, size=size, over=over)

    def heater_power(self, size: float, *, over: float | None = None, at: float = 0.0, duration: float = 1e9) -> None:
        """The heater gives ``size`` times the power asked for."""
        self._do("heater-power", at, duration, size=size, over=over)

    def heater_stuck(self, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """The heater gives ``size`` % whatever is asked for."""
        self._do("heater-stuck", at, duration, size=size)

    def ambient(self, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """The room is ``size`` degC warmer."""
        self._do("ambient", at, duration, size=size)

    def ambient_drift(self, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """The room grows warmer by ``size`` degC a minute."""
        self._do("ambient-drift", at, duration, size=size)

    def supply_voltage(self, size: float, *, at: float = 0.0, duration: float = 1e9) -> None:
        """The heater's supply has ``size`` times its nominal voltage."""
        self._do("supply-voltage", at, duration, size=size)

    def _do(self, verb: str, at: float, duration: float, **keys: object) -> None:
        self.inject({"do": verb, "at": at, "for": duration, **keys})
