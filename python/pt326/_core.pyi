# Made from python/src by tools/try-python --stubs.
import os
import typing

import numpy

"""
The native half of pt326: use `import pt326`.
"""

from _typeshed import SupportsGetItem
from collections.abc import Iterator
from typing import Any, Final, SupportsFloat, SupportsIndex, final
from typing_extensions import disjoint_base

__all__ = ["VERSION", "Board", "Cells", "Codes", "Config", "Finding", "Instrument", "Monitor", "Observer", "Record", "Recording", "Report", "Rig", "Setting", "columns", "isolability", "repeat", "rls", "run", "scenario", "tune"]

VERSION: Final[str]
"""
The version of this package.
"""

@final
class Board:
    """
    A real board at a serial port: its ticks as they come, its console, and stop. As long as nobody says `heat=True`, nothing that it is asked from
    here makes it heat; with it the heater is switched off again where a `with` ends, however that may be. What it does by itself it goes on with.

    `port` is the only one that a board may be at, unless it is given. A board that says nothing for `patience` s is an error.
    """
    def __enter__(self, /) -> Board: ...
    def __exit__(self, /, *_raised: "object") -> None: ...
    def __iter__(self, /) -> Board: ...
    def __new__(cls, /, port: str | None = None, *, heat: bool = False, patience: SupportsFloat | SupportsIndex = 15.0) -> Board: ...
    def __next__(self, /) -> dict:
        """
        The next tick.
        """
    def __repr__(self, /) -> str: ...
    def arm(self, /) -> str:
        """
        Begins to regulate; only with `heat=True`.
        """
    def ask(self, /, line: str) -> str:
        """
        Types a line on its console and gives the answer. What it refuses is raised.
        """
    @property
    def heat(self, /) -> bool:
        """
        Whether it may be made to heat from here.
        """
    @property
    def linked(self, /) -> bool:
        """
        Whether it was heard lately.
        """
    @property
    def port(self, /) -> str:
        """
        Its port.
        """
    @property
    def said(self, /) -> list[str]:
        """
        What its console has said without being asked.
        """
    @property
    def sample_time(self, /) -> float:
        """
        Ts, s.
        """
    @property
    def settings(self, /) -> dict[str, float]:
        """
        Its numbers that are not the defaults, as far as they have been heard.
        """
    def status(self, /) -> str:
        """
        How it is.
        """
    def stop(self, /) -> None:
        """
        Heater off. It is on its way before this returns, whatever else is under way.
        """

@final
class Cells:
    """
    A campaign, ready to run: its cells, and the rows of those runs that are finished.
    """
    def __new__(cls, /, definition: "str | os.PathLike[str] | dict[str, object]", config: Config | None = None, only: str | None = None, scale: SupportsFloat | SupportsIndex | None = None, first_seed: "int | None" = None) -> Cells:
        """
        `definition` is the path of a TOML, a dict, or the name of a campaign that is built in: default, quick, physics or ablation. `scale`
        multiplies the numbers of runs; `only` is in the names of the cells that are wanted.
        """
    @property
    def names(self, /) -> list[str]:
        """
        Names of the cells.
        """
    def observer(self, /, cell: SupportsIndex, run: SupportsIndex) -> Observer:
        """
        Who scores a detector over one run.
        """
    def results(self, /) -> "dict[str, typing.Any]":
        """
        What the finished runs showed: campaign.json.
        """
    def results_of(self, /, observers: SupportsGetItem[int, Observer]) -> "dict[str, typing.Any]":
        """
        The same of a detector from outside: what its `observers` saw stands where else the likelihood diagnosis does.
        """
    def run(self, /, progress: "typing.Callable[[int, int | None], object] | None" = None) -> None:
        """
        Runs all, on all cores.
        """
    @property
    def runs(self, /) -> list[tuple[int, int]]:
        """
        Cell and number of each run.
        """
    def runs_csv(self, /) -> str:
        """
        A row for each finished run: runs.csv.
        """
    def table(self, /) -> str:
        """
        What `pt326 campaign` prints.
        """
    def watch(self, /, runs: SupportsGetItem[int, tuple[SupportsIndex, SupportsIndex]]) -> "list[numpy.ndarray]":
        """
        Runs some, on all cores, and gives for each what a detector sees: T0, T1, T2 in degC (NaN where one reads nothing) and the power in %, a
        row a tick.
        """
    def write(self, /, folder: "str | os.PathLike[str]") -> str:
        """
        Writes what `pt326 campaign` writes into a folder, and gives the names.
        """

@final
class Codes:
    """
    What the inputs of the board read on a tick: codes of a converter of 12 bits. NaN where a sample went missing.
    """
    def __eq__(self, value: object, /) -> bool: ...
    def __getitem__(self, index: SupportsIndex, /) -> float: ...
    def __getnewargs__(self, /) -> tuple[float, float, float, float]: ...
    def __iter__(self, /) -> Iterator: ...
    def __len__(self, /) -> int: ...
    def __ne__(self, value: object, /) -> bool: ...
    def __new__(cls, /, t0: SupportsFloat | SupportsIndex, t1: SupportsFloat | SupportsIndex, t2: SupportsFloat | SupportsIndex, supply: SupportsFloat | SupportsIndex = 0.0) -> Codes:
        """
        Codes of the three thermistors and of the heater's supply, which is 0 where it is not measured.
        """
    def __repr__(self, /) -> str: ...
    @property
    def supply(self, /) -> float:
        """
        Supply of the heater; 0 where it is not measured.
        """
    @property
    def t0(self, /) -> float:
        """
        Thermistor of the ambient air.
        """
    @property
    def t1(self, /) -> float:
        """
        Thermistor at the heater's outlet.
        """
    @property
    def t2(self, /) -> float:
        """
        Thermistor behind T1.
        """

@final
class Config:
    """
    The settings of an instrument: those of a preset (`oven`, `hotend`, `tclab`; any other rig has the defaults), then changed.

    `config["pid.kp"] = 3` sets one and checks it; `Config.settings()` says what each is, in which unit, and its bounds.
    """
    def __copy__(self, /) -> Config: ...
    def __deepcopy__(self, /, _memo: Any) -> Config: ...
    def __eq__(self, value: object, /) -> bool: ...
    def __getitem__(self, name: str, /) -> Any: ...
    def __ne__(self, value: object, /) -> bool: ...
    def __new__(cls, /, preset: "str" = "paper") -> Config: ...
    def __reduce__(self, /) -> tuple[Any, tuple[str]]:
        """
        Pickled as TOML.
        """
    def __repr__(self, /) -> str: ...
    def __setitem__(self, name: str, value: Any, /) -> None: ...
    def check(self, /) -> None:
        """
        Refuses settings that make no instrument: that are out of bounds, or do not go together.
        """
    def copy(self, /) -> Config:
        """
        A copy, to be changed.
        """
    @staticmethod
    def from_dict(settings: "dict[str, object]") -> Config:
        """
        From a dict; keys that it leaves out have their defaults.
        """
    @staticmethod
    def from_toml(text: str) -> Config:
        """
        From TOML; keys that it leaves out have their defaults.
        """
    @staticmethod
    def settings() -> list[Setting]:
        """
        What each setting is.
        """
    def to_dict(self, /) -> "dict[str, object]":
        """
        As nested dicts.
        """
    def to_toml(self, /) -> str:
        """
        As commented TOML, which `pt326 --config` reads, too.
        """

@final
class Finding:
    """
    A fault that the likelihood diagnosis has named.
    """
    def __repr__(self, /) -> str: ...
    @staticmethod
    def classes() -> list[str]:
        """
        Names of all classes.
        """
    @property
    def confidence(self, /) -> float:
        """
        Probability of the class among all that were considered.
        """
    @property
    def half_width(self, /) -> float | None:
        """
        Half of the 95 % interval of the magnitude.
        """
    @property
    def magnitude(self, /) -> float | None:
        """
        How large it is, in `unit`; None where the class has no size.
        """
    @property
    def name(self, /) -> str:
        """
        Its class, such as `t2_offset`.
        """
    @property
    def onset(self, /) -> float:
        """
        When it is thought to have begun, s.
        """
    @property
    def sentence(self, /) -> str:
        """
        All of it as a sentence.
        """
    @property
    def unit(self, /) -> str:
        """
        Unit of the magnitude.
        """

@final
class Instrument:
    """
    The instrument: what the board runs, bit for bit. Each tick takes `control(codes)`, which gives the power, then `diagnose()`.

    It is off until `arm()`. `seed` moves the start of the excitation as `pt326 run --seed` does; with 1 it is the board's.
    """
    def __copy__(self, /) -> Instrument: ...
    def __deepcopy__(self, /, _memo: Any) -> Instrument: ...
    def __new__(cls, /, config: Config | None = None, seed: "int" = ...) -> Instrument: ...
    def acknowledge(self, /) -> None:
        """
        Leaves a trip whose cause has gone.
        """
    def arm(self, /) -> None:
        """
        Begins to regulate.
        """
    def control(self, /, codes: "Codes | typing.Sequence[float]") -> float:
        """
        First half of a tick: takes in the codes (`Codes`, or three or four numbers), gives the power to drive the heater with, %.
        """
    def diagnose(self, /, applied: SupportsFloat | SupportsIndex | None = None) -> Report:
        """
        Second half of the tick. `applied` is what the heater really gets, %, where that is not what `control` gave.
        """
    def excite(self, /, on: bool) -> None:
        """
        Switches the excitation on or off.
        """
    def fan(self, /, level: SupportsFloat | SupportsIndex) -> None:
        """
        Announces the level of the fan, %.
        """
    @property
    def mode(self, /) -> str:
        """
        The mode of the last tick: off, settle, learn, monitor, tripped or tune.
        """
    def relearn(self, /) -> None:
        """
        Forgets what is normal and learns it anew.
        """
    def retune(self, /, config: Config) -> None:
        """
        Takes over other settings without a bump; the set-point stays.
        """
    @property
    def sample_time(self, /) -> float:
        """
        Ts, s.
        """
    def set_setpoint(self, /, celsius: SupportsFloat | SupportsIndex) -> None:
        """
        Asks for another set-point, degC.
        """
    def stop(self, /) -> None:
        """
        Heater off.
        """
    @property
    def temperatures(self, /) -> tuple[float | None, float | None, float | None]:
        """
        What the thermistors read on the last tick, degC: T0, T1, T2. None where one reads nothing.
        """

@final
class Monitor:
    """
    The diagnosis alone, for a heater that something else controls: temperatures and power in, reports out. It learns from the samples of which
    `learn` is said.
    """
    def __copy__(self, /) -> Monitor: ...
    def __deepcopy__(self, /, _memo: Any) -> Monitor: ...
    def __new__(cls, /, config: Config | None = None, *, t0: bool = True, t2: bool = True, fan: bool = True, celsius: SupportsFloat | SupportsIndex = 1.0, full_power: SupportsFloat | SupportsIndex = 100.0) -> Monitor:
        """
        `t0`, `t2`, `fan`: what of it the rig has. `celsius` is how many degC one unit of a temperature counts for, `full_power` the power that is 100 %.
        """
    def model(self, /) -> "dict[str, typing.Any] | None":
        """
        What was learnt, in s, degC and %; None: nothing yet.
        """
    def resume(self, /) -> None:
        """
        The next sample is the first of another recording of the same rig.
        """
    def step(self, /, t0: SupportsFloat | SupportsIndex | None = None, t1: SupportsFloat | SupportsIndex | None = None, t2: SupportsFloat | SupportsIndex | None = None, power: SupportsFloat | SupportsIndex | None = None, *, beside: SupportsFloat | SupportsIndex | None = None, fan: SupportsFloat | SupportsIndex | None = None, supply: SupportsFloat | SupportsIndex | None = None, learn: bool = False) -> Report:
        """
        One sample: temperatures, and what drives the heater from it on. What is None, or no number, is missing.
        """

@final
class Observer:
    """
    Scores a detector over one run as ours are scored, tick by tick.
    """
    def watch(self, /, detector: "object", seen: "numpy.ndarray") -> None:
        """
        Lets a detector see a run, a row (T0, T1, T2, power) a tick: calls `step(t0, t1, t2, power)`, which gives the name of a class (any other
        word: an alarm without a name), or None where all is well. `armed`, where it has that, says whether it watches.
        """

@final
class Record:
    """
    A run, whole.
    """
    def __len__(self, /) -> int: ...
    def column(self, /, name: "str") -> "numpy.ndarray | list[str | None]":
        """
        A column: an array of float64 with NaN where it is not defined, or a list of words.
        """
    @staticmethod
    def columns() -> list[str]:
        """
        Names of the columns of trace.csv.
        """
    def events(self, /) -> "list[dict[str, typing.Any]]":
        """
        What was said, and when: a dict each.
        """
    @property
    def sample_time(self, /) -> float:
        """
        Ts, s.
        """
    @property
    def sigma_factor(self, /) -> float:
        """
        How many standard deviations a threshold lies from the mean.
        """
    def summary(self, /) -> "dict[str, typing.Any]":
        """
        All scores: summary.json.
        """
    def table(self, /) -> str:
        """
        What `pt326 run` prints.
        """
    def trace(self, /) -> str:
        """
        trace.csv.
        """
    @staticmethod
    def unit(name: str) -> str:
        """
        Unit of a column; empty where it has none.
        """
    def write(self, /, folder: "str | os.PathLike[str]") -> None:
        """
        Writes what `pt326 run` writes: trace.csv, summary.json, figures, report.html.
        """

@final
class Recording:
    """
    A recording of a heater that something else controls, as it is read by `pt326 diagnose`.
    """
    def __len__(self, /) -> int: ...
    def __new__(cls, /, path: "str | os.PathLike[str] | None" = None, text: str | None = None, reading: "dict[str, object] | None" = None, other_path: "str | os.PathLike[str] | None" = None, other_text: str | None = None) -> Recording:
        """
        From a file, or from the text of one; `reading` has the options of `pt326 diagnose`: map, ts, resample, full_power, degc, fan. Another
        of the same heater is read with it, in the same units, to learn from.
        """
    def diagnose(self, /, heater: SupportsIndex = 1, train: tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex] | None = None, from_rest: bool = False, force: bool = False, config: Config | None = None, progress: "typing.Callable[[int, int | None], object] | None" = None) -> "tuple[Record, dict[str, typing.Any]]":
        """
        Learns from the other recording if there is one, from a part (from, to in s), or from a part that seems normal; then watches. A model that explains less than
        30 % of T1 is refused, unless `force`.
        """
    def fit_rig(self, /, heater: SupportsIndex = 1, progress: "typing.Callable[[int, int | None], object] | None" = None) -> "dict[str, typing.Any]":
        """
        A simulated rig that answers as one of its heaters does: `pt326 fit-rig`. All of the recording is taken for normal.
        """
    @property
    def heaters(self, /) -> list[str]:
        """
        What each heater's columns are.
        """
    def monitor(self, /) -> Monitor:
        """
        A monitor that has learnt what `diagnose` learnt, for what comes next from the same rig.
        """
    def put_rest_before(self, /) -> float:
        """
        The rig was cold and its heater off before the first sample. Gives for how long that is put before it, s.
        """
    @property
    def remarks(self, /) -> list[str]:
        """
        Whoever reads the results must know this.
        """
    @property
    def sample_time(self, /) -> float:
        """
        Ts, s.
        """

@final
class Report:
    """
    What both diagnoses say on a tick. `report["rsg1_f"]` is any number of the tick, by its name in trace.csv.
    """
    def __getitem__(self, name: str, /) -> Any: ...
    def __repr__(self, /) -> str: ...
    @property
    def alarm(self, /) -> bool:
        """
        The likelihood diagnosis says that something is wrong.
        """
    @property
    def expected(self, /) -> tuple[float | None, float | None, float | None]:
        """
        What T0, T1 and T2 should read by the models, degC.
        """
    @property
    def fdv(self, /) -> int | None:
        """
        The paper's detection vector by the low-passed residuals; None while it does not monitor.
        """
    @property
    def finding(self, /) -> Finding | None:
        """
        What is wrong, once that can be told.
        """
    @property
    def fiv(self, /) -> int | None:
        """
        The paper's isolation vector by the low-passed residuals; None while it does not monitor.
        """
    @property
    def learned(self, /) -> int:
        """
        Samples that the baseline has been learnt from.
        """
    def log_line(self, /) -> str | None:
        """
        The line that a board's log has of this tick, as `pt326 replay` reads it; None of a `Monitor`, which sees no codes.
        """
    @property
    def readiness(self, /) -> str:
        """
        Whether the likelihood diagnosis watches: untrained, training, armed, refused_..., restarted.
        """
    @property
    def t(self, /) -> float:
        """
        Time of the tick, s.
        """
    @property
    def taught(self, /) -> str | None:
        """
        The fault of the user's own that it is.
        """

@disjoint_base
class Rig:
    """
    The simulated rig in motion: power goes in, codes come out. It knows nothing of any instrument.

    `preset` is one of `Rig.presets()`; `constants` changes some of its constants, with the keys of `[rig]` in `pt326 scenario`; `faults` are
    dicts with the keys of `[[fault]]`. The sample time is that of the preset's instrument unless it is given, s.
    """
    def __new__(cls, /, preset: "str" = "trainer", seed: "int" = ..., disturbance: "str" = "calm", *, sample_time: SupportsFloat | SupportsIndex | None = None, faults: "list[dict[str, object]] | None" = None, constants: "dict[str, object] | None" = None) -> Rig: ...
    def __repr__(self, /) -> str: ...
    @property
    def air(self, /) -> tuple[float, float]:
        """
        The true temperature of the air at T1 and at T2, without turbulence, degC.
        """
    @property
    def codes(self, /) -> Codes:
        """
        The codes of this tick.
        """
    def fan(self, /, level: SupportsFloat | SupportsIndex) -> None:
        """
        Sets the fan, % of its nominal level.
        """
    def inject(self, /, fault: "dict[str, object]") -> None:
        """
        Lets something happen that a dict describes, with the keys of `[[fault]]`; `at` counts from now, s. The next codes are the first that show it.
        """
    def mend(self, /) -> None:
        """
        Ends all that happens, and forgets what was still to come.
        """
    @staticmethod
    def presets() -> list[str]:
        """
        Names of the rigs that there are.
        """
    @property
    def sample_time(self, /) -> float:
        """
        Ts, s.
        """
    @property
    def sensor_error(self, /) -> float:
        """
        How far the input that is worst off reads from what it would read without any fault of a sensor, degC.
        """
    def step(self, /, power: SupportsFloat | SupportsIndex) -> Codes:
        """
        Drives the heater with `power`, %, until the next tick, and gives the codes of that.
        """
    @property
    def t(self, /) -> float:
        """
        Time of this tick, s.
        """
    @property
    def truth(self, /) -> int:
        """
        Number of the fault that acts now, as in the column `truth` of a trace; 0 for none.
        """

@final
class Setting:
    """
    What there is to know of a setting.
    """
    def __repr__(self, /) -> str: ...
    @property
    def doc(self, /) -> str:
        """
        What it is.
        """
    @property
    def max(self, /) -> float | None:
        """
        Its largest value; None where it is no number.
        """
    @property
    def min(self, /) -> float | None:
        """
        Its least value; None where it is no number.
        """
    @property
    def name(self, /) -> str:
        """
        Its name, as in `config["pid.kp"]`.
        """
    @property
    def unit(self, /) -> str:
        """
        Its unit; empty for plain numbers and words.
        """
    @property
    def words(self, /) -> list[str]:
        """
        The words of which it is one; empty for numbers and switches.
        """

def columns(path: "str | os.PathLike[str] | None", text: "str | None", names: "list[str]") -> "dict[str, numpy.ndarray]":
    """
    Columns of a file, or of the text of one, by name or number; each cell must be a number.
    """

def isolability(scenario: "object" = None, config: Config | None = None, seed: "int" = ..., preset: str | None = None, disturbance: str | None = None, within: SupportsGetItem[int, SupportsFloat | SupportsIndex] = ..., equal_odds: bool = False, progress: "typing.Callable[[int, int | None], object] | None" = None) -> str:
    """
    Which faults can be told apart on a rig, how soon, and from which size on: isolability.csv.
    """

def repeat(scenario: "object" = None, config: Config | None = None, runs: SupportsIndex = 200, first_seed: "int" = ..., preset: str | None = None, disturbance: str | None = None, fault_size: "str | float | None" = None, progress: "typing.Callable[[int, int | None], object] | None" = None) -> "dict[str, typing.Any]":
    """
    The same experiment with many seeds, on all cores: `pt326 repeat --json`.
    """

def rls(phi: "numpy.ndarray", y: "numpy.ndarray", lam: "float" = 1.0) -> "numpy.ndarray":
    """
    Recursive least squares in single precision, as on the board: rows of 17 regressors and outputs, both scaled to some 1.
    """

def run(scenario: "object" = None, config: Config | None = None, seed: "int" = ..., preset: str | None = None, disturbance: str | None = None, fault_size: "str | float | None" = None) -> Record:
    """
    Runs an experiment on the simulated rig: `pt326 run`, to the same bits.
    """

def scenario() -> "dict[str, typing.Any]":
    """
    The paper's experiment as a dict, to be changed and run: rig, faults, what its user does.
    """

def tune(scenario: "object" = None, config: Config | None = None, seed: "int" = ..., preset: str | None = None, disturbance: str | None = None) -> "dict[str, typing.Any]":
    """
    The experiment of the console's `tune start` on a simulated rig, and what each rule proposes.
    """
