import copy
import json
import os
import pickle
import re
import signal
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pt326
from conftest import Command

GOLDEN = Path(__file__).parents[2] / "tests" / "golden" / "paper.csv"


@pytest.fixture(scope="module")
def paper() -> pt326.Run:
    return pt326.run()


def fnv(data: bytes) -> str:
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return f"{value:016x}"


def test_the_papers_run_has_the_bits_of_the_golden_record(paper: pt326.Run) -> None:
    hash_line = GOLDEN.read_text().splitlines()[0]
    assert hash_line == f"# hash of all {len(paper)} rows: {fnv(paper.trace().encode())}"


@pytest.mark.parametrize(
    ("options", "keys"),
    [
        ([], {}),
        (
            ["--seed", "7", "--disturbance", "lively", "--fault-size", "small"],
            {"seed": 7, "disturbance": "lively", "fault_size": "small"},
        ),
        (["--preset", "oven", "--seed", "2"], {"preset": "oven", "seed": 2}),
    ],
)
def test_a_run_is_that_of_the_command_line(
    command: Command, tmp_path: Path, options: list[str], keys: dict[str, Any]
) -> None:
    done = command("run", *options, "--out", tmp_path / "cli")
    run = pt326.run(**keys)
    assert done.stdout.startswith(str(run))
    assert run.trace() == (tmp_path / "cli" / "trace.csv").read_text()
    assert run.summary == json.loads((tmp_path / "cli" / "summary.json").read_text())
    run.write(tmp_path / "ours")
    for written in sorted((tmp_path / "cli").iterdir()):
        assert (tmp_path / "ours" / written.name).read_bytes() == written.read_bytes(), written.name


def test_rig_and_instrument_tick_by_tick_are_the_run(paper: pt326.Run) -> None:
    rig = pt326.Rig("paper", faults=pt326.scenario()["fault"])
    instrument = pt326.Instrument()
    instrument.arm()
    codes = rig.codes
    said: dict[str, list[Any]] = {"t1_c": [], "pa_pct": [], "rsg1_f": [], "verdict": [], "truth": []}
    for _ in range(len(paper)):
        power = instrument.control(codes)
        report = instrument.diagnose()
        for name in ("t1_c", "rsg1_f", "verdict"):
            said[name].append(report[name])
        said["pa_pct"].append(power)
        said["truth"].append(rig.truth)
        codes = rig.step(power)
    for name, values in said.items():
        if name == "verdict":
            assert values == list(paper[name])
        else:
            np.testing.assert_array_equal(np.array(values, dtype=np.float32), paper[name], err_msg=name)
    assert instrument.mode == "monitor"


def test_verbs_and_findings_have_names() -> None:
    rig, instrument = pt326.Rig("paper", seed=3), pt326.Instrument(seed=3)
    instrument.arm()
    report = None
    while rig.t < 395.0:
        power = instrument.control(rig.codes)
        report = instrument.diagnose()
        if 384.0 <= rig.t < 384.1:
            rig.offset("t2", 1.5, duration=25.0)
        rig.step(power)
    assert report is not None
    finding = report.finding
    assert finding is not None
    assert (finding.name, finding.unit, report.alarm, report.readiness) == ("t2_offset", "degC", True, "armed")
    assert finding.magnitude == pytest.approx(1.5, abs=0.5)
    assert finding.sentence.startswith("T2 reads")
    assert finding.onset == pytest.approx(384.1, abs=0.5)
    assert rig.truth == 1
    rig.mend()
    assert rig.truth == 0


def test_columns_are_arrays_and_frames(paper: pt326.Run) -> None:
    pandas = pytest.importorskip("pandas")
    assert paper.t.dtype == np.float64
    assert paper["t1_c"].dtype == np.float64
    assert paper["t1_c"] is paper["t1_c"], "made once"
    frame = paper.to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == paper.columns
    assert set(frame["mode"]) == {"settle", "learn", "monitor"}
    assert paper.unit("t1_c") == "degC"
    with pytest.raises(KeyError):
        paper["t9"]


def test_polars_takes_all_columns(paper: pt326.Run) -> None:
    polars = pytest.importorskip("polars")
    frame = paper.to_polars()
    assert isinstance(frame, polars.DataFrame)
    assert frame.columns == paper.columns
    assert frame["verdict"].drop_nulls().unique().sort().to_list()[-1] == "t2_offset"


def test_events_say_what_was_said(paper: pt326.Run) -> None:
    named = [(event["by"], event["name"]) for event in paper.events]
    for fault in ("t2_offset", "t1_clogged", "air_flow"):
        assert ("likelihood", fault) in named
        assert ("signature", fault) in named
    first = next(event for event in paper.events if event["by"] == "likelihood")
    assert first["at"] == paper.faults[0]["likelihood"]["detected_s"]


def test_a_figure_shows_all_that_the_paper_has(paper: pt326.Run) -> None:
    for number, panels in ((4, 4), (5, 4), (6, 8)):
        figure = paper.plot(number)  # type: ignore[arg-type]
        assert len(figure.axes) == panels
    assert "T2 reads" in paper.plot().axes[-1].get_xlabel()
    with pytest.raises(ValueError, match="4, 5 or 6"):
        paper.plot(7)  # type: ignore[arg-type]


def test_settings_go_to_toml_and_dict_and_back() -> None:
    config = pt326.Config("tclab")
    assert config != pt326.Config()
    assert pt326.Config.from_toml(config.to_toml()) == config
    assert pt326.Config.from_dict(config.to_dict()) == config
    config["pid.kp"] = 3
    assert config["pid.kp"] == 3.0
    assert "pid.kp" in repr(config)
    settings = {setting.name: setting for setting in pt326.Config.settings()}
    assert (settings["pid.kp"].unit, settings["pid.kp"].min, settings["pid.kp"].max) == ("%/degC", 0.0, 1000.0)
    assert settings["pid.kp"].doc
    with pytest.raises(KeyError):
        config["pid.kq"]


def test_a_dict_is_the_scenario_that_its_toml_is(tmp_path: Path) -> None:
    """To the last bit of each number, whatever kind of number it is."""
    size, at = 1.2345678901234567e-1, 384.12345678901234
    scenario = {
        "duration": np.int64(450),
        "fault": [{"do": "offset", "sensor": "t2", "size": size, "at": np.float64(at), "for": 9, "lag": None}],
        "action": ({"at": 20, "relearn": True},),
    }
    (tmp_path / "my.toml").write_text(
        f'duration = 450\nfault = [{{ do = "offset", sensor = "t2", size = {size}, at = {at}, for = 9 }}]\n'
        "action = [{ at = 20, relearn = true }]\n"
    )
    ours, theirs = pt326.run(scenario), pt326.run(tmp_path / "my.toml")
    assert ours.summary == theirs.summary
    assert ours.summary["truth"][0]["size"] == size
    assert ours.summary["truth"][0]["at"] == at
    assert ours.hash() == theirs.hash()
    with pytest.raises(TypeError):
        pt326.run({"duration": object()})


def test_what_is_refused_is_refused_in_the_words_of_the_command_line(command: Command, tmp_path: Path) -> None:
    file = tmp_path / "my.toml"

    def told(*arguments: str | Path) -> str:
        done = command(*arguments)
        assert done.returncode == 2
        return done.stderr.removeprefix("error: ").strip()

    with pytest.raises(pt326.Error) as refused:
        pt326.run(preset="kettle")
    assert str(refused.value) == told("run", "--preset", "kettle")
    file.write_text("arm_at = -1\n")
    with pytest.raises(pt326.Error) as refused:
        pt326.run(file)
    assert str(refused.value) == told("run", "--scenario", file)
    with pytest.raises(pt326.Error) as refused:
        pt326.run({"arm_at": -1})
    assert told("run", "--scenario", file).endswith(str(refused.value))
    with pytest.raises(pt326.Error, match=r"pid.kp is 1000000000, expected 0 to 1000"):
        pt326.Config()["pid.kp"] = 1e9
    with pytest.raises(pt326.Error, match="unknown word `ofset`, expected one of `offset`"):
        pt326.run({"fault": [{"do": "ofset", "at": 1, "for": 1}]})


def test_orders_that_make_no_sense_are_refused() -> None:
    instrument = pt326.Instrument()
    with pytest.raises(pt326.Error, match="set-point 500 degC refused, expected"):
        instrument.set_setpoint(500)
    with pytest.raises(RuntimeError, match="control comes before diagnose"):
        instrument.diagnose()
    with pytest.raises(TypeError, match="2 codes"):
        instrument.control([1.0, 2.0])
    with pytest.raises(pt326.Error, match="power is 101"):
        pt326.Rig().step(101)
    with pytest.raises(pt326.Error, match="kettle"):
        pt326.Rig("kettle")
    with pytest.raises(pt326.Error, match="wild"):
        pt326.Rig(disturbance="wild")


def test_codes_are_numbers_with_names() -> None:
    codes = pt326.Rig("trainer").codes
    assert [codes.t0, codes.t1, codes.t2, codes.supply] == list(codes)
    first, second = pt326.Instrument(), pt326.Instrument()
    first.arm()
    second.arm()
    assert first.control(codes) == second.control(tuple(codes))
    assert first.temperatures == second.temperatures
    assert pt326.Codes(*codes) == codes


def test_repeat_is_that_of_the_command_line(command: Command) -> None:
    told: list[tuple[int, int | None]] = []
    repeated = pt326.repeat(runs=4, first_seed=5, progress=lambda done, of: told.append((done, of)))
    assert repeated == json.loads(command("repeat", "--seeds", "4", "--from", "5", "--json").stdout)
    assert told[-1] == (4, 4)


def test_ctrl_c_ends_it() -> None:
    with pytest.raises(KeyboardInterrupt):
        pt326.repeat(runs=100_000, progress=lambda *_: os.kill(os.getpid(), signal.SIGINT))


def test_what_the_progress_raises_ends_it() -> None:
    def enough(done: int, of: int | None) -> None:
        raise LookupError(f"{done} of {of}")

    with pytest.raises(LookupError):
        pt326.campaign("quick", progress=enough)


def test_faults_can_be_told_apart() -> None:
    rows = pt326.isolability(within=[10], progress=False)
    offset = [row for row in rows if row["fault"] == "t2_offset" and row["from"] == "nothing"]
    assert offset
    assert all(row["told"] == "above" and row["size"] < 1.5 and row["within_s"] == 10 for row in offset)


def test_a_run_comes_back_from_another_process(paper: pt326.Run) -> None:
    twin: pt326.Run = pickle.loads(pickle.dumps(paper))
    assert (twin.hash(), twin.summary, twin.events, str(twin)) == (
        paper.hash(),
        paper.summary,
        paper.events,
        str(paper),
    )
    assert all(np.array_equal(twin[name], paper[name], equal_nan=twin[name].dtype != object) for name in paper.columns)
    assert (len(twin), twin.sample_time) == (len(paper), paper.sample_time)
    assert len(twin.plot().axes) == 8
    with pytest.raises(pt326.Error, match="write of a run that another process has made"):
        twin.write("nowhere")


def test_a_copy_is_a_run_of_its_own(paper: pt326.Run, tmp_path: Path) -> None:
    shallow, deep = copy.copy(paper), copy.deepcopy(paper)
    assert shallow["t1_c"] is paper["t1_c"]
    deep["t1_c"][0] = 99.0
    assert paper["t1_c"][0] != 99.0
    deep.write(tmp_path)
    assert (tmp_path / "trace.csv").read_text() == paper.trace()


def test_what_else_can_be_copied_and_pickled() -> None:
    config = pt326.Config("oven")
    config["pid.kp"] = 0.1
    assert pickle.loads(pickle.dumps(config)) == copy.deepcopy(config) == config
    rig, instrument = pt326.Rig(), pt326.Instrument()
    assert pickle.loads(pickle.dumps(rig.codes)) == rig.codes
    instrument.arm()
    instrument.control(rig.codes)
    twin = copy.deepcopy(instrument)
    assert twin.control(rig.codes) == instrument.control(rig.codes) > 0
    twin.stop()
    assert (twin.control(rig.codes), instrument.control(rig.codes) > 0) == (0.0, True)


def test_a_figure_is_one_of_pyplot(paper: pt326.Run) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    assert paper.plot() is pyplot.gcf()
    pyplot.close("all")


def test_a_package_that_is_missing_is_named_with_how_to_get_it(
    paper: pt326.Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    for package, call in (("pandas", paper.to_pandas), ("polars", paper.to_polars), ("matplotlib", paper.plot)):
        monkeypatch.setitem(sys.modules, package, None)
        with pytest.raises(ImportError, match=f"needs {package}: pip install {package}"):
            call()


@pytest.mark.parametrize("seed", [-1, 1.5, 2**64, "one"])
def test_a_seed_that_is_none_is_refused(seed: Any) -> None:
    for call in (pt326.run, pt326.Rig, pt326.Instrument, pt326.tune, pt326.isolability):
        with pytest.raises(pt326.Error, match=re.escape(f"a seed is {seed!r}, expected a whole number from 0")):
            call(seed=seed)
    for many in (pt326.repeat, pt326.campaign):
        with pytest.raises(pt326.Error, match="a seed is"):
            many(first_seed=seed, progress=False)
