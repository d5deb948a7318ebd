"""Both FMUs with FMPy; run by tools/try-fmu with the folder that cargo builds in, and --accept to put what the example prints into its page."""

import contextlib
import csv
import io
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import fmpy
import numpy
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from lxml import etree

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/fmi.md"
TARGET = Path(sys.argv[1])
ACCEPT = "--accept" in sys.argv[2:]
RIG = TARGET / "fmu/pt326_rig.fmu"
INSTRUMENT = TARGET / "fmu/pt326_instrument.fmu"
CODES = ["code_t0", "code_t1", "code_t2", "code_supply"]
# Columns of trace.csv by the output that has the same; the truth is the rig's.
NUMBERS = {
    "pa_pct": "power",
    "t0_c": "t0",
    "t1_c": "t1",
    "t2_c": "t2",
    "setpoint_c": "setpoint_in_force",
    "confidence": "confidence",
    "magnitude": "size",
    "onset_s": "onset",
    "rap_f": "rap",
    "ry12_f": "ry12",
    "rsg1_f": "rsg1",
    "rsg2_f": "rsg2",
    "rbw1_f": "rbw1",
    "sg1": "sg1",
    "sg2": "sg2",
}
COUNTS = {"fdv": "fdv", "fiv": "fiv"}
FLAGS = {"alarm": "alarm", "advice": "advice"}
WORDS = {"mode": "mode", "verdict": "finding", "magnitude_unit": "size_unit"}
# The paper's three faults, as parameters.
SLOTS = {
    **{"fault1.kind": "offset", "fault1.sensor": "t2", "fault1.size": 1.5, "fault1.start": 384.5, "fault1.duration": 25.0},
    **{"fault2.kind": "clog", "fault2.sensor": "t1", "fault2.size": 0.85, "fault2.lag": 0.4},
    **{"fault2.start": 495.0, "fault2.duration": 10.0},
    **{"fault3.kind": "air-flow", "fault3.size": 1.26, "fault3.start": 730.0, "fault3.duration": 25.0},
}


def expect(what, is_so):
    if not is_so:
        sys.exit(f"try-fmu: not so: {what}")
    print(f"ok: {what}")


class Part:
    """An instance, its variables by their names."""

    def __init__(self, file, folder, **values):
        about = fmpy.read_model_description(file)
        self.of = {variable.name: variable for variable in about.modelVariables}
        self.said = []
        logger = lambda _, status, category, message: self.said.append(message.decode())
        self.fmu = fmpy.instantiate_fmu(folder, about, logger=logger, debug_logging=True)
        self.set(values)

    def set(self, values):
        for name, value in values.items():
            getattr(self.fmu, f"set{self.of[name].type}")([self.of[name].valueReference], [value])

    def begin(self):
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.step = self.get(["step_size"])[0]
        self.ticks = 0

    def get(self, names):
        get = getattr(self.fmu, f"get{self.of[names[0]].type}")
        return get([self.of[name].valueReference for name in names])

    def tick(self):
        self.fmu.doStep(self.ticks * self.step, self.step)
        self.ticks += 1


def together(rig, instrument, ticks, at_once=False):
    """Steps both, the instrument first, so that the rig gets the power of the same tick; or both at once. Gives each tick's row."""
    rig.begin()
    instrument.begin()
    rows = []
    for _ in range(ticks):
        truth = rig.get(["truth"])[0]
        instrument.set(dict(zip(CODES, rig.get(CODES))))
        if at_once:
            rig.set({"power": instrument.get(["power"])[0]})
        instrument.tick()
        if not at_once:
            rig.set({"power": instrument.get(["power"])[0]})
        rig.tick()
        row = {"truth": str(truth)}
        row |= dict(zip(NUMBERS, instrument.get(list(NUMBERS.values()))))
        row |= dict(zip(COUNTS, instrument.get(list(COUNTS.values()))))
        row |= dict(zip(FLAGS, instrument.get(list(FLAGS.values()))))
        row |= dict(zip(WORDS, instrument.get(list(WORDS.values()))))
        rows.append(row)
    return rows


def same(name, value, cell):
    """Whether an output is what stands in a cell of trace.csv, to the bit."""
    if name == "onset_s":
        return numpy.isnan(value) if cell == "" else value == float(cell)
    if name in NUMBERS:
        return numpy.isnan(value) if cell == "" else value == float(numpy.float32(cell))
    if name in COUNTS:
        return value == (-1 if cell == "" else int(cell))
    return str(int(value)) == cell if name in FLAGS else value == cell


def trace(folder, *arguments):
    """What the command line comes to."""
    subprocess.run([TARGET / "release/pt326", "run", "--out", folder, *arguments], check=True, stdout=subprocess.DEVNULL)
    with open(folder / "trace.csv", newline="") as file:
        return list(csv.DictReader(file))


def description(file):
    expect(f"{file.name} keeps the standard's schema and rules: {validate_fmu(str(file))}", validate_fmu(str(file)) == [])
    schema = Path(fmpy.__file__).parent / "schema/fmi3/fmi3TerminalsAndIcons.xsd"
    terminals = zipfile.ZipFile(file).read("terminalsAndIcons/terminalsAndIcons.xml")
    expect("its terminals, too", etree.XMLSchema(etree.parse(schema)).validate(etree.fromstring(terminals)))


def example():
    """The page's example prints what the page says."""
    page = PAGE.read_text()
    blocks = re.search(r"```python\n(.*?)```.*?```text\n(.*?)```", page, re.S)
    code, printed = blocks.groups()
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(code.replace("target/fmu/", f"{TARGET}/fmu/"), {})
    prints = "".join(line.rstrip() + "\n" for line in out.getvalue().splitlines())
    if ACCEPT:
        PAGE.write_text(page[: blocks.start(2)] + prints + page[blocks.end(2) :])
    else:
        expect("the example of docs/fmi.md prints what stands there (else: tools/try-fmu --accept)", prints == printed)


def the_same_bits(folders, folder):
    config = folder / "config.toml"
    config.write_text("setpoint = 36.0\n[pid]\nkp = 3.0\n")
    trainer = {"preset": "trainer", "scenario": "paper", "seed": 7, "disturbance": "lively"}
    for about, rig, instrument, arguments in [
        ("the paper's experiment", {"scenario": "paper"}, {}, []),
        ("its faults as parameters", SLOTS, {}, []),
        ("the trainer, seed 7, lively", trainer, {"seed": 7}, ["--preset", "trainer", "--seed", "7", "--disturbance", "lively"]),
        ("other settings, as text", {"scenario": "paper"}, {"configuration": config.read_text()}, ["--config", config]),
        ("other settings, as a file", {"scenario": "paper"}, {"configuration": str(config)}, ["--config", config]),
        ("TCLab", {"preset": "tclab", "scenario": "paper"}, {"preset": "tclab"}, ["--preset", "tclab"]),
    ]:
        expected = trace(folder / "run", *arguments)
        both = Part(RIG, folders[0], **rig), Part(INSTRUMENT, folders[1], arm=True, **instrument)
        rows = together(*both, len(expected))
        wrong = [(k, name) for k, row in enumerate(rows) for name in row if not same(name, row[name], expected[k][name])]
        cells = sum(map(len, rows))
        expect(f"{about}: {cells} numbers of {len(rows)} ticks as in the trace of pt326 run; other: {wrong[:3]}", not wrong)
        names = {row["verdict"] for row in rows if row["verdict"]}
        expect(f"  with findings: {', '.join(sorted(names))}", len(names) > 2)


def instances(folders):
    """Two rigs side by side, and one that is reset, do not disturb each other."""
    a, b = (Part(RIG, folders[0], seed=seed) for seed in (3, 4))

    def codes(parts, ticks):
        seen = [[] for _ in parts]
        for part in parts:
            part.set({"power": 50.0})
            part.begin()
        for _ in range(ticks):
            for part, list_ in zip(parts, seen):
                part.tick()
                list_.append(part.get(CODES))
        return seen

    first, second = codes([a, b], 200)
    a.fmu.terminate()
    a.fmu.reset()
    a.set({"seed": 4})
    expect("two rigs differ by their seeds; one that is reset and given the other's is the other", first != second and codes([a], 200) == [second])


def refusals(folders):
    rig = Part(RIG, folders[0])
    rig.begin()
    with contextlib.suppress(FMICallException):
        rig.fmu.doStep(0.0, 0.1)
        sys.exit("try-fmu: a wrong step was taken")
    expect(f"a wrong step is told as docs/fmi.md shows it: {rig.said[-1]}", rig.said[-1] in PAGE.read_text())
    rig.set({"power": 100.0000001})
    expect(f"a power that rounding made too large: {rig.said[-1]}", "held to 100" in rig.said[-1] and rig.get(["power"]) == [100.0])
    wrong = Part(RIG, folders[0], scenario="[rig]\ngain = -1")
    with contextlib.suppress(FMICallException):
        wrong.begin()
        sys.exit("try-fmu: a wrong rig was made")
    expect(f"a wrong rig: {wrong.said[-1]}", "rig.gain is -1" in wrong.said[-1])


def by_a_master(folder):
    """FMPy's own loop drives the rig alone with half of the power; its command line runs both with its defaults."""
    result = fmpy.simulate_fmu(str(RIG), stop_time=60, start_values={"power": 50.0}, output=["air_t1"])
    rise = result["air_t1"][-1] - result["air_t1"][0]
    expect(f"FMPy's own loop: 50 % for 60 s warm the air by {rise:.1f} degC", 14 < rise < 16)
    for file in RIG, INSTRUMENT:
        out = folder / "out.csv"
        subprocess.run([Path(sys.executable).with_name("fmpy"), "simulate", file, "--output-file", out], check=True)
        times = numpy.genfromtxt(out, delimiter=",", names=True)["time"]
        told = f"fmpy simulate {file.name}: {len(times)} rows up to {times[-1]} s, each {times[1] - times[0]:.2f} s"
        expect(told, times[-1] > 849 and len(times) < 1001)
    start = 1.7e9  # seconds since 1970, where the last place of the time is 0.2 us
    result = fmpy.simulate_fmu(str(RIG), start_time=start, stop_time=start + 60, output_interval=0.11, output=["air_t1"])
    expect(f"from {start:.0f} s on: {len(result)} rows", len(result) > 500)


def both_at_once(folders):
    """What a simulator comes to that steps all parts at once: no bits to compare, but the same findings, later."""
    both = Part(RIG, folders[0], scenario="paper"), Part(INSTRUMENT, folders[1], arm=True)
    rows = together(*both, 7727, at_once=True)
    named = [(k, row["verdict"]) for k, row in enumerate(rows) if row["verdict"] != (rows[k - 1]["verdict"] if k else "")]
    told = ", ".join(f"{name} at {k * 0.11:.2f} s" for k, name in named if name)
    names = {"t2_offset", "t1_clogged", "air_flow"}
    expect(f"both stepped at once, so that the power comes a sample late: {told}", names <= {name for _, name in named})


def main():
    for file in RIG, INSTRUMENT:
        description(file)
    folders = [fmpy.extract(str(file)) for file in (RIG, INSTRUMENT)]
    example()
    with tempfile.TemporaryDirectory() as folder:
        the_same_bits(folders, Path(folder))
        by_a_master(Path(folder))
    instances(folders)
    refusals(folders)
    both_at_once(folders)


if __name__ == "__main__":
    main()
