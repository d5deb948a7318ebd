import math

import pytest

from pt326.tclab import TCLab, clock, setup


def test_a_program_of_that_lab_runs() -> None:
    """The step test that stands in every introduction to that lab, with one line changed."""
    temperatures = []
    with TCLab(seed=2) as lab:
        before = lab.T1
        assert lab.Q1(40) == 40
        for t in clock(30, 2):
            temperatures.append((t, lab.T1, lab.T2))
        assert lab.scan == (lab.T1, lab.T2, 40, 0)
    assert [t for t, _, _ in temperatures] == list(range(0, 31, 2))
    assert temperatures[0][1] == before
    assert temperatures[-1][1] > before + 8
    assert lab.Q1() == 0, "closed"


def test_limits_and_what_there_is_not() -> None:
    lab = setup(connected=False, speedup=10)()
    assert lab.Q1(120) == 100
    assert lab.Q1(-3) == 0
    assert lab.Q2(30) == 30
    lab.U1 = 25
    assert (lab.U1, lab.Q1()) == (25, 25)
    assert lab.LED(50) == 50
    assert [name for name, _ in lab.sources] == ["T1", "T2", "Q1", "Q2"]
    lab.close()


def test_faults_are_done_to_its_rig() -> None:
    with TCLab("paper", disturbance="none") as lab:
        lab.wait(1)
        lab.rig.offset("t1", 5.0)
        before = lab.T1
        lab.wait(1)
        assert lab.T1 == pytest.approx(before + 5.0, abs=1.0)
        lab.rig.open("t2")
        lab.wait(1)
        assert math.isnan(lab.T2)
