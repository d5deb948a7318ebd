import math
import sys
from collections.abc import Iterator
from typing import Any

import pytest

tclab = pytest.importorskip("pt326.tclab")


class Time:
    """A clock that stands still unless somebody sleeps."""

    def __init__(self) -> None:
        self.now = 1000.0

    def time(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += max(0.001, seconds)  # as a real one, no shorter than the system can


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> Iterator[Time]:
    """What the lab's package takes for the time of the day."""
    clock = Time()
    monkeypatch.setattr(sys.modules["tclab.labtime"], "time", clock)
    tclab.labtime.reset()
    tclab.labtime.set_rate(1)
    yield clock


def test_a_program_that_sleeps_sees_the_rig_move(time: Time) -> None:
    with tclab.TCLab(seed=2) as lab:
        before = lab.T1
        assert lab.Q1(100) == 100
        assert lab.T1 == before, "no time has passed"
        time.sleep(300)
        assert before + 20 < lab.T1 < before + 34
        assert lab.T2 < lab.T1
    assert lab.Q1() == 0, "closed"


@pytest.mark.parametrize("speedup", [1, 10])
def test_a_program_of_that_lab_runs_in_its_time(time: Time, speedup: int) -> None:
    lab_class = tclab.setup(connected=False, speedup=speedup)
    begun, seen = time.now, []
    with lab_class(preset="trainer") as lab:
        history = tclab.Historian(lab.sources)
        for t in tclab.clock(30, 2, adaptive=False):
            lab.U1 = 40
            history.update(t)
            seen.append(t)
    assert (seen[0], seen[-1]) == pytest.approx((0, 30), abs=0.01)
    assert time.now - begun == pytest.approx(30 / speedup, abs=0.1)
    assert history.columns == ["Time", "T1", "T2", "Q1", "Q2"]
    assert history.logdict["T1"][-1] > history.logdict["T1"][0] + 8


def test_an_experiment_runs_as_fast_as_it_can(time: Time) -> None:
    def heat(t: float, lab: Any) -> None:
        lab.Q1(50)

    done = tclab.runexperiment(heat, connected=False, plot=False, time=600, synced=False)
    assert len(done.historian.log) == 600
    assert done.historian.logdict["T1"][-1] > 35
    assert isinstance(done.lab, tclab.TCLabModel)
    assert time.now == 1000.0, "nobody has waited"


def test_half_of_the_most_is_half_of_the_power(time: Time) -> None:
    rises = []
    for most, power in ((200, 50), (100, 100), (255, 100)):
        lab = tclab.TCLab(disturbance="none")
        lab.P1, before = most, lab.T1
        lab.U1 = power
        time.sleep(300)
        rises.append(lab.T1 - before)
    assert rises[0] == pytest.approx(rises[1], abs=0.01)
    assert rises[2] == pytest.approx(2 * rises[0], rel=0.05), "no more than the heater has"


def test_limits_and_what_there_is_not(time: Time) -> None:
    lab = tclab.TCLab()
    assert [lab.Q1(120), lab.Q1(-3), lab.Q2(30), lab.LED(50)] == [100, 0, 30, 50]
    assert lab.scan() == (lab.T1, lab.T2, 0, 30)
    assert abs(lab.T0 - lab.T1) < 1
    with pytest.raises(RuntimeError, match="port is 'COM3', expected none"):
        tclab.TCLab(port="COM3")
    assert tclab.setup() is tclab.TCLab
    with pytest.raises(ValueError, match="real time"):
        tclab.setup(connected=True, speedup=2)


def test_faults_are_done_to_its_rig(time: Time) -> None:
    with tclab.TCLab(preset="paper", disturbance="none") as lab:
        time.sleep(1)
        before = lab.T1
        lab.rig.offset("t1", 5.0)
        time.sleep(1)
        assert lab.T1 == pytest.approx(before + 5.0, abs=1.0)
        lab.rig.open("t2")
        time.sleep(1)
        assert math.isnan(lab.T2)
