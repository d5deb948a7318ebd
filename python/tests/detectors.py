"""Detectors that one writes in ten lines, beside `pt326.diagnose`, on the same records: prints the table of docs/evidence/records.md.

usage: detectors.py DIR        DIR has tclab/prbs.csv, setpoint_0.csv and faults_0.csv (docs/evidence/records.md)

Each detector learns from the same fault-free record. Its threshold is the lowest that raises no alarm on a second fault-free record, which is more
than a user would know; `pt326.diagnose` has its defaults, and raises none there either.
"""

import csv
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import pt326

Array = NDArray[np.float64]
#: Time, temperature, and the powers: the own one first.
Record = dict[str, Array]
#: Onset, end, and what it is.
Fault = tuple[int, int, str]
#: An alarm counts for a fault from its onset to so many samples behind its end; it has to rise within the first of them.
LATEST, AFTER = 90, 90


class Arx:
    """y[k] from y[k-1], y[k-2], both powers at two samples and a constant, by least squares; the delay is the one that leaves least."""

    def __init__(self, record: Record) -> None:
        y = record["t1"][60:]
        tried = [self.rows(record, delay) for delay in range(20)]
        fits: list[Array] = [np.asarray(np.linalg.lstsq(rows, y, rcond=None)[0], dtype=np.float64) for rows in tried]
        left = [float(np.sum((y - rows @ theta) ** 2)) for rows, theta in zip(tried, fits, strict=True)]
        self.delay = int(np.argmin(left))
        self.theta = fits[self.delay]

    @staticmethod
    def rows(record: Record, delay: int) -> Array:
        y, inputs = record["t1"], [record["power"], record["known"]]
        back = [u[60 - lag - delay : len(y) - lag - delay] for u in inputs for lag in (1, 2)]
        return np.column_stack([y[59:-1], y[58:-2], *back, np.ones(len(y) - 60)])

    def predicted(self, record: Record) -> Array:
        """What is left of each sample with the two before it known."""
        left = record["t1"][60:] - self.rows(record, self.delay) @ self.theta
        return np.concatenate([np.zeros(60), left])

    def simulated(self, record: Record) -> Array:
        """What is left of each sample with the first ones known only."""
        driven = self.rows(record, self.delay)[:, 2:] @ self.theta[2:]
        y = list(record["t1"][:60])
        for forced in driven:
            y.append(self.theta[0] * y[-1] + self.theta[1] * y[-2] + forced)
        left: Array = record["t1"] - np.array(y)
        return left


def ewma(left: Array, share: float) -> Array:
    out, mean = np.empty_like(left), 0.0
    for k, x in enumerate(left):
        mean += share * (x - mean)
        out[k] = mean
    return out


def cusum(left: Array, sigma: float, limit: float) -> Array:
    """The larger of both sums at an allowance of half a standard deviation, begun anew beyond the limit."""
    out, up, down = np.empty_like(left), 0.0, 0.0
    for k, x in enumerate(left / sigma):
        up, down = max(0.0, up + x - 0.5), max(0.0, down - x - 0.5)
        out[k] = max(up, down)
        if out[k] > limit:
            up = down = 0.0
    return out


def detectors(normal: Record) -> dict[str, Callable[[Record, float], Array]]:
    """Of a record and a threshold what is held against it, by name."""
    model = Arx(normal)
    sigma = float(np.std(model.simulated(normal)))
    return {
        "ARX, residual of one step": lambda record, _: np.abs(model.predicted(record)),
        "ARX, one step, EWMA of 10": lambda record, _: np.abs(ewma(model.predicted(record), 0.1)),
        "ARX simulated, EWMA of 10": lambda record, _: np.abs(ewma(model.simulated(record), 0.1)),
        "ARX simulated, CUSUM": lambda record, limit: cusum(model.simulated(record), sigma, limit),
    }


def ours(normal: Record, record: Record) -> NDArray[np.bool_]:
    roles: dict[str, Any] = {role: role for role in ("time", "t1", "power", "known")}
    found = pt326.diagnose(record, **roles, train_on=normal, full_power=100.0, has_fan=False, progress=False)
    alarm = np.zeros(len(record["t1"]), dtype=bool)
    alarm[np.rint((found.t - record["time"][0]) / found.sample_time).astype(int)] = found["alarm"] > 0
    return alarm


def score(alarm: NDArray[np.bool_], faults: list[Fault]) -> tuple[dict[str, list[int | None]], int]:
    """Delays by kind of fault, none where it was missed, and how many alarms rose while nothing was wrong."""
    rises = np.flatnonzero(alarm & ~np.concatenate([[False], alarm[:-1]]))
    delays: dict[str, list[int | None]] = {}
    excused = np.zeros(len(alarm), dtype=bool)
    for onset, end, kind in faults:
        excused[onset : end + AFTER] = True
        within = rises[(rises >= onset) & (rises < onset + LATEST)]
        delays.setdefault(kind, []).append(int(within[0]) - onset if len(within) else None)
    return delays, int(np.sum(~excused[rises]))


def tclab(folder: Path) -> list[tuple[Record, Record, Record, list[Fault]]]:
    """Of each heater of the lab: what is learnt from, a second fault-free record, and one with faults and where these are."""

    def columns(name: str) -> dict[str, Array]:
        with (folder / "tclab" / name).open() as file:
            rows = list(csv.DictReader(file))
        return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}

    def record(of: dict[str, Array], own: int) -> Record:
        def column(*names: str) -> Array:
            return next(of[name] for name in names if name in of)

        powers = {i: column(f"Q{i}_pct", f"Q{i}_cmd_pct") for i in (1, 2)}
        t1 = column(f"T{own}_degC", f"T{own}_read_degC")
        return {"time": of["t_s"], "t1": t1, "power": powers[own], "known": powers[3 - own]}

    normal, quiet, faulty = columns("prbs.csv"), columns("setpoint_0.csv"), columns("faults_0.csv")
    parts = []
    for own in (1, 2):
        faults: list[Fault] = []
        for column, kind in ((f"dout{own}_degC", "offset"), (f"din{own}_pct", "power")):
            acts = np.concatenate([[False], faulty[column] != 0.0, [False]])
            edges = np.flatnonzero(acts[1:] != acts[:-1])
            faults += [(int(on), int(off), kind) for on, off in edges.reshape(-1, 2)]
        # A fault of the heater beside is one of this rig, too: what is said of it is no false alarm, nor is it asked for.
        acts = np.concatenate([[False], faulty[f"din{3 - own}_pct"] != 0.0, [False]])
        edges = np.flatnonzero(acts[1:] != acts[:-1])
        faults += [(int(on), int(off), "beside") for on, off in edges.reshape(-1, 2)]
        parts.append((record(normal, own), record(quiet, own), record(faulty, own), faults))
    return parts


def made(seed: int) -> tuple[Record, Record, Record, list[Fault]]:
    """A heater of two lags in a room that wanders by 0.3 degC: an offset of 1 degC, then a fifth of the power lost."""
    dice = np.random.default_rng(seed)
    slow, fast, gain = dice.uniform(30, 90), dice.uniform(3, 10), dice.uniform(0.35, 0.5)

    def record(faulty: bool) -> Record:
        count = 3000
        power = np.repeat(dice.uniform(10, 80, count // 40), 40)
        phase = dice.uniform(0, 6)
        t1, heat, warm = np.empty(count), 40.0, 40.0
        for k in range(count):
            off = 1.0 if faulty and 1000 <= k < 1300 else 0.0
            room = 21.0 + 0.3 * np.sin(k / 500 + phase)
            t1[k] = room + gain * warm + dice.normal(0, 0.05) + off
            given = power[k] * (0.8 if faulty and 2000 <= k < 2300 else 1.0)
            heat += (given - heat) / slow
            warm += (heat - warm) / fast
        return {"time": np.arange(count, dtype=float), "t1": t1, "power": power, "known": np.zeros(count)}

    return record(False), record(False), record(True), [(1000, 1300, "offset"), (2000, 2300, "power")]


def row(name: str, scores: list[tuple[dict[str, list[int | None]], int]], quiet: int, watched: int) -> str:
    cells = []
    for kind in ("offset", "power"):
        delays = [delay for by_kind, _ in scores for delay in by_kind.get(kind, [])]
        seen = sorted(delay for delay in delays if delay is not None)
        middle = f", {seen[len(seen) // 2]} s" if seen else ""
        cells.append(f"{len(seen)} of {len(delays)}{middle}")
    false = sum(count for _, count in scores)
    return (
        f"| {name} | {cells[0]} | {cells[1]} | {quiet} in {watched / 3600:.1f} h | {false} in {watched / 3600:.1f} h |"
    )


def table(title: str, parts: list[tuple[Record, Record, Record, list[Fault]]]) -> None:
    print(
        f"\n| {title} | offsets seen, after | power seen, after | false alarms, fault-free | false alarms, with faults |"
    )
    print("|---|---|---|---|---|")
    watched = sum(len(record["t1"]) for _, _, record, _ in parts)
    found: dict[str, list[Any]] = {}
    quiet_alarms: dict[str, int] = {}
    for normal, quiet, record, faults in parts:
        for name, statistic in detectors(normal).items():
            limit = float(np.max(statistic(quiet, np.inf)[60:]))
            alarm = statistic(record, limit) > limit
            found.setdefault(name, []).append(score(alarm, faults))
            quiet_alarms[name] = 0
        name = "`pt326.diagnose`"
        found.setdefault(name, []).append(score(ours(normal, record), faults))
        quiet_alarms[name] = quiet_alarms.get(name, 0) + score(ours(normal, quiet), [])[1]
    for name, scores in found.items():
        print(row(name, scores, quiet_alarms[name], watched))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    table("TCLab, faults_0, both heaters", tclab(Path(sys.argv[1])))
    table("made, 20 records", [made(seed) for seed in range(20)])
