"""PID settings from an experiment on the simulated rig."""

import re

import numpy as np
import pytest

import pt326
from conftest import Command


@pytest.fixture(scope="module")
def paper() -> pt326.Tuning:
    return pt326.tune()


def test_a_rig_is_found_and_its_settings_regulate_it(paper: pt326.Tuning) -> None:
    assert paper.gain == pytest.approx(0.3, rel=0.05)
    assert list(paper.rules) == ["relay", "model", "quick"]
    quick = paper.rules["quick"]
    assert quick["gain_margin"] >= 2.5
    assert quick["settled_s"] <= paper.rules["model"]["settled_s"]
    config = paper.config("quick")
    assert config["pid.kp"] == pytest.approx(quick["kp"])
    assert config["pid.output_max"] == pt326.Config()["pid.output_max"]
    run = pt326.run(config=config)
    assert abs(run["t1_c"][3000:3400].mean() - 35.0) < 0.1
    with pytest.raises(KeyError, match="expected one of relay, model, quick"):
        paper.config("slow")  # type: ignore[arg-type]


def test_the_experiment_is_there_to_be_looked_at(paper: pt326.Tuning) -> None:
    assert len(paper.t) == len(paper.t1) == len(paper.power)
    assert paper.t.dtype == np.float64
    assert (paper.power[0], paper.power[-1]) == (0.0, 0.0)
    assert len(np.unique(paper.power)) == 4, "off, constant, and both of the relay"
    pytest.importorskip("matplotlib")
    assert len(paper.plot().axes) == 2


def test_the_console_comes_to_the_same_rig(paper: pt326.Tuning, command: Command) -> None:
    done = command("console", typed="check\nwait 60\ntune start\nwait 200\ntune\n")
    said = done.stdout.split("> tune\n")[-1]
    number = r"(\d+\.\d+)"
    form = re.sub(number, "#", str(paper).split("; ")[0]).splitlines()[0]
    assert re.sub(number, "#", said).splitlines()[0] == form
    gain = float(re.findall(number, said)[0])
    assert gain == pytest.approx(paper.gain, rel=0.02)


def test_other_rigs_and_what_comes_to_no_result() -> None:
    scenario = pt326.scenario()
    scenario["rig"]["gain"] = 0.5
    assert pt326.tune(scenario).gain == pytest.approx(0.5, rel=0.05)
    assert pt326.tune(preset="oven").time > 10.0
    scenario["rig"]["gain"] = 0.01
    with pytest.raises(pt326.Error, match="ended without a result, it tripped: much power, and T1 has not risen"):
        pt326.tune(scenario)
