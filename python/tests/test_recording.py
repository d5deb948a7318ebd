import copy
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pt326
from conftest import Command


@pytest.fixture(scope="module")
def frame() -> Any:
    pandas = pytest.importorskip("pandas")
    scenario = pt326.scenario()
    scenario["action"] = [
        {"at": 60.0, "setpoint": 42.0},
        {"at": 150.0, "setpoint": 30.0},
        {"at": 250.0, "setpoint": 35.0},
    ]
    run = pt326.run(scenario, seed=3)
    columns = {"t": run.t, "room": run["t0_c"], "box": run["t1_c"], "behind": run["t2_c"], "heat": run["pa_pct"]}
    return pandas.DataFrame(columns)


MAP: dict[str, Any] = {"time": "t", "t0": "room", "t1": "box", "t2": "behind", "power": "heat"}


def test_a_frame_is_diagnosed(frame: Any) -> None:
    told: list[tuple[int, int | None]] = []
    found = pt326.diagnose(frame, **MAP, train=(0.0, 300.0), progress=lambda done, of: told.append((done, of)))
    named = [event["name"] for event in found.events if event["by"] == "likelihood"]
    assert {"t2_offset", "t1_clogged", "air_flow"} <= set(named)
    assert found.model["gain"] == pytest.approx(0.29, abs=0.05)
    assert found.because == "0 to 300 s are said to be normal"
    gain = found.intervals["gain"]
    assert gain is not None
    assert gain[0] < found.model["gain"] < gain[1] < 1.2 * gain[0]
    assert found.watched_from == pytest.approx(300.0, abs=0.2)
    assert told
    assert len(found.plot().axes) == 3
    assert "t2_offset" in set(found.to_pandas()["verdict"])


def test_the_command_line_says_the_same(frame: Any, command: Command, tmp_path: Path) -> None:
    file = tmp_path / "box.csv"
    frame.astype(np.float64).to_csv(file, index=False)
    roles = [word for role, column in MAP.items() for word in ("--map", f"{role}={column}")]
    done = command("diagnose", file, *roles, "--train", "0:300", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    trace = (tmp_path / "out" / "trace.csv").read_text()
    assert pt326.diagnose(file, **MAP, train=(0, 300), progress=False).trace() == trace
    assert pt326.diagnose(frame, **MAP, train=(0, 300), progress=False).trace() == trace
    mapping = {name: frame[name].to_numpy() for name in frame}
    assert pt326.diagnose(mapping, **MAP, train=(0, 300), progress=False).trace() == trace


@pytest.mark.parametrize("zone", [None, "UTC"])
def test_times_may_be_dates(frame: Any, zone: str | None) -> None:
    pandas = pytest.importorskip("pandas")
    columns = {role: column for role, column in MAP.items() if role != "time"}
    dated = frame.drop(columns="t")
    dated.index = pandas.date_range("2026-10-25", periods=len(frame), freq="110ms", tz=zone)
    counted = pt326.diagnose(frame, **MAP, train=(0, 300), progress=False)
    for given, when in ((dated, None), (dated.rename_axis("box"), None), (dated.reset_index(names="when"), "when")):
        found = pt326.diagnose(given, time=when, **columns, train=(0, 300), progress=False)
        assert found.sample_time == pytest.approx(0.11)
        assert found.events == counted.events


def test_milliseconds_are_said_to_be_such(frame: Any) -> None:
    counted = pt326.diagnose(frame[:3000], **MAP, train=(0, 300), progress=False)
    found = pt326.diagnose(
        frame[:3000].assign(t=1000 * frame["t"]), **MAP, time_unit="ms", train=(0, 300), progress=False
    )
    assert found.model == counted.model


def test_a_diagnosis_comes_back_from_another_process(frame: Any) -> None:
    found = pt326.diagnose(frame[:3600], **MAP, train=(0, 300), progress=False)
    twin: pt326.Diagnosis = pickle.loads(pickle.dumps(found))
    assert (twin.sentences, twin.model, twin.fit) == (found.sentences, found.model, found.fit)
    assert len(twin.plot().axes) == 3
    with pytest.raises(pt326.Error, match="monitor of a run that another process"):
        twin.monitor()
    monitor = copy.deepcopy(found).monitor()
    assert copy.deepcopy(monitor).model() == found.model


def test_another_recording_can_be_learnt_from_and_a_monitor_goes_on(frame: Any) -> None:
    normal, rest = frame[:2700], frame[2700:]
    found = pt326.diagnose(rest, **MAP, train_on=normal, progress=False)
    assert found.because == "all of data, which is said to be normal"
    monitor = found.monitor()
    said = set()
    for row in rest.itertuples():
        report = monitor.step(row.room, row.box, row.behind, row.heat)
        said |= {report.finding.name} if report.finding else set()
    assert {"t2_offset", "t1_clogged"} <= said
    assert monitor.model() == found.model


def test_a_recording_and_what_it_is_trained_on_have_the_same_units(frame: Any) -> None:
    # Counts of 255, of which the part that is learnt from has no more than 100, as if it were in %.
    largest = frame["heat"][1500:2700].max()
    counts = frame.assign(heat=(100.0 / largest * frame["heat"]).round())
    normal, other = counts[1500:2700], counts[:1500]
    assert other["heat"].max() > 100.0 >= normal["heat"].max()
    guessed, told = (
        pt326.diagnose(other, **MAP, full_power=full_power, train_on=normal, progress=False)
        for full_power in (None, 255.0)
    )
    assert guessed.model == told.model
    assert guessed.trace() == told.trace()


def test_what_cannot_be_is_refused(frame: Any) -> None:
    with pytest.raises(pt326.Error, match=r"there is no column|no column"):
        pt326.diagnose(frame, t1="kettle", power="heat", time="t")
    with pytest.raises(pt326.Error, match=r"no column is said to be `power`: add power=COLUMN$"):
        pt326.diagnose(frame, t1="box", time="t")
    with pytest.raises(pt326.Error, match="add time=COLUMN, or ts= with the sample time in s"):
        pt326.diagnose(frame, t1="box", power="heat")
    with pytest.raises(pt326.Error, match="0 <= from < to <="):
        pt326.diagnose(frame, **MAP, train=(5.0, 1.0))
    with pytest.raises(pt326.Error, match="full_power is 0"):
        pt326.diagnose(frame, **MAP, full_power=0.0)
    with pytest.raises(pt326.Error, match="heaters 1 to 1"):
        pt326.diagnose(frame, **MAP, heater=2)


def test_a_monitor_says_what_it_is_given() -> None:
    monitor = pt326.Monitor(t0=False, t2=False, fan=False)
    report = monitor.step(t1=35.0, power=40.0, learn=True)
    assert report.finding is None
    assert report["t1_c"] == 35.0
    assert monitor.model() is None


@pytest.mark.parametrize("detrend", ["offset", "mean"])
def test_a_model_has_the_parameters_of_the_process_within_its_standard_deviations(detrend: Any) -> None:
    a, b, delay = [-1.5, 0.56], [0.3, 0.1], 3
    noise, process = np.random.default_rng(1), [0.0] * 4
    u = np.repeat(noise.choice([20.0, 40.0], 400), 10)
    for k in range(4, len(u)):
        pushed = b[0] * (u[k - delay] - 30) + b[1] * (u[k - delay - 1] - 30)
        process.append(-a[0] * process[k - 1] - a[1] * process[k - 2] + pushed + 0.02 * noise.standard_normal())
    model = pt326.identify(
        {"u": u, "y": np.array(process) + 22}, u="u", y="y", order=(2, 2, 3), ts=0.1, detrend=detrend
    )
    for value, truth, sd in zip([*model.a, *model.b], [*a, *b], model.report["sd"], strict=True):
        assert abs(value - truth) < 4 * sd + 1e-4, (value, truth, sd)
    assert model.report["static_gain"] == pytest.approx(0.4 / 0.06, rel=0.01)
    assert model.report["time_constants_s"] == pytest.approx([-0.1 / np.log(0.8), -0.1 / np.log(0.7)], rel=0.05)
    assert model.report["fit_pct"][0] > 95
    if detrend == "offset":  # the mean of a transient is no steady state
        assert model.report["doubts"] == []


def test_a_model_says_what_speaks_against_it() -> None:
    noise = np.random.default_rng(2)
    still = {"u": np.full(300, 20.0) + 1e-3 * noise.standard_normal(300), "y": 30 + noise.standard_normal(300)}
    model = pt326.identify(still, u="u", y="y", order=(1, 1, 1), ts=1.0)
    assert any("the gain is not known" in doubt for doubt in model.report["doubts"]) and "doubt" in str(model)
    drift = {"u": noise.standard_normal(300), "y": np.cumsum(1 + noise.standard_normal(300))}
    model = pt326.identify(drift, u="u", y="y", order=(1, 1, 1), ts=1.0, detrend="none")
    assert any("not stable" in doubt for doubt in model.report["doubts"]), model.report


def test_a_file_and_a_frame_give_the_same_model(frame: Any, tmp_path: Path) -> None:
    file = tmp_path / "box.csv"
    frame.astype(np.float64).to_csv(file, index=False)
    asked: dict[str, Any] = {"u": "heat", "y": "box", "order": (2, 1, 2), "ts": 0.11, "validate": (3000, 4000)}
    assert pt326.identify(file, **asked).report == pt326.identify(frame, **asked).report


@pytest.mark.parametrize("order", [(2, 1, 2), (1, 2, 1), (3, 1, 1)])
def test_a_model_is_a_transfer_function(frame: Any, order: tuple[int, int, int]) -> None:
    control = pytest.importorskip("control")
    model = pt326.identify(frame, u="heat", y="box", order=order, ts=0.11, rows=(0, 3000))
    transfer = model.transfer_function()
    assert transfer.dt == model.ts == 0.11
    assert control.dcgain(transfer) == pytest.approx(model.report["static_gain"], rel=1e-3)
    _, response = control.impulse_response(transfer, T=np.arange(6) * model.ts)
    first = next(k for k, value in enumerate(response) if abs(value) > 1e-9)
    assert first == model.delay


def test_what_cannot_be_identified_is_refused(frame: Any) -> None:
    with pytest.raises(pt326.Error, match="expected na and nb from 1 to 8"):
        pt326.identify(frame, u="heat", y="box", order=(9, 1, 1), ts=0.11)
    with pytest.raises(pt326.Error, match="kettle"):
        pt326.identify(frame, u="kettle", y="box", order=(1, 1, 1), ts=0.11)
    with pytest.raises(pt326.Error, match="detrend"):
        pt326.identify(frame, u="heat", y="box", order=(1, 1, 1), ts=0.11, detrend="never")  # type: ignore[arg-type]
    with pytest.raises(pt326.Error, match="rows for"):
        pt326.identify(frame, u="heat", y="box", order=(2, 2, 1), ts=0.11, rows=(0, 12))


def test_a_fitted_rig_is_that_of_the_command_line_and_runs(frame: Any, command: Command, tmp_path: Path) -> None:
    normal = frame[:3400]
    file, written = tmp_path / "box.csv", tmp_path / "rig.toml"
    normal.astype(np.float64).to_csv(file, index=False)
    roles = [word for role, column in MAP.items() for word in ("--map", f"{role}={column}")]
    done = command("fit-rig", file, *roles, "-o", written)
    assert done.returncode == 0, done.stderr
    told: list[tuple[int, int | None]] = []
    fitted = pt326.fit_rig(file, **MAP, progress=lambda done, of: told.append((done, of)))
    assert fitted.toml == str(fitted) == written.read_text()
    assert told
    assert f"Fit, simulated: {fitted.fit:.1f} % of T1" in done.stdout
    assert fitted.beyond == []
    assert pt326.fit_rig(normal, **MAP, progress=False).scenario == fitted.scenario
    assert fitted.scenario["rig"]["gain"] == pytest.approx(0.3, abs=0.03)
    clogged = [{"do": "air-flow", "size": 0.7, "at": 440.0, "for": 60.0}]
    scenario = {**fitted.scenario, "duration": 500.0, "fault": clogged}
    assert "air_flow" in {event["name"] for event in pt326.run(scenario).events}
    rig = fitted.rig()
    assert rig.sample_time == pytest.approx(0.11)
    cold = rig.air[0]
    for _ in range(200):
        rig.step(40.0)
    assert rig.air[0] - cold == pytest.approx(40.0 * fitted.scenario["rig"]["gain"], rel=0.1)


def test_what_no_rig_can_be_fitted_to_is_refused_as_at_the_command_line(
    frame: Any, command: Command, tmp_path: Path
) -> None:
    file = tmp_path / "noise.csv"
    noise = np.random.default_rng(1).normal(30.0, 5.0, 2000)
    frame[:2000].assign(box=noise, behind=noise, room=20.0).astype(np.float64).to_csv(file, index=False)
    roles = [word for role, column in MAP.items() for word in ("--map", f"{role}={column}")]
    done = command("fit-rig", file, *roles, "-o", tmp_path / "rig.toml")
    with pytest.raises(pt326.Error) as refused:
        pt326.fit_rig(file, **MAP, progress=False)
    said = done.stderr.strip().replace("--train FROM:TO or --train-on RECORD", "train=(FROM, TO) or train_on=RECORD")
    assert said == f"error: {refused.value}".strip()
    with pytest.raises(pt326.Error, match="heater is 2, expected 1 to 1"):
        pt326.fit_rig(frame[:3400], **MAP, heater=2, progress=False)
