"""PCA, dynamic PCA and CVA on Tennessee Eastman, as docs/scores.md says: prints the table of the peers there.

usage: tep_peers.py DIR        DIR has d00.dat, d00_te.dat and d01_te.dat to d21_te.dat
"""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Signals of a file, a row a sample, to a statistic at each sample, which is larger where more is wrong.
Statistic = Callable[[Array], Array]
#: Samples that do not count at the beginning, sample of the fault, quantile of d00_te.dat below the threshold.
SKIP, ONSET, QUANTILE = 20, 160, 0.99


def read(path: Path) -> Array:
    signals = np.loadtxt(path)
    return signals.T if len(signals) == 52 else signals


def pca(train: Array, lags: int, variance: float = 0.9) -> list[Statistic]:
    """T2 of the components with 90 % of the variance, and Q of the rest; of `lags` samples more."""

    def stacked(x: Array) -> Array:
        return np.hstack([np.vstack([x[:1].repeat(lag, axis=0), x[: len(x) - lag]]) for lag in range(lags + 1)])

    rows = stacked(train)[lags:]
    mean, sd = rows.mean(0), rows.std(0, ddof=1)
    _, singular, axes = np.linalg.svd((rows - mean) / sd, full_matrices=False)
    power = singular**2 / (len(rows) - 1)
    kept = int(np.searchsorted(np.cumsum(power) / power.sum(), variance)) + 1

    def t2(x: Array) -> Array:
        scores = ((stacked(x) - mean) / sd) @ axes[:kept].T
        return np.asarray((scores**2 / power[:kept]).sum(1))

    def q(x: Array) -> Array:
        z = (stacked(x) - mean) / sd
        return np.asarray(((z - z @ axes[:kept].T @ axes[:kept]) ** 2).sum(1))

    return [t2, q]


def cva(train: Array, lags: int = 3, states: int = 29) -> list[Statistic]:
    """T2 of the states that tell most of the future from the past, and T2 of the rest; 22 measured signals and 11 commands."""
    which = [*range(22), *range(41, 52)]
    mean, sd = train[:, which].mean(0), train[:, which].std(0, ddof=1)

    def past(x: Array) -> Array:
        z = (x[:, which] - mean) / sd
        return np.hstack([np.vstack([z[:1].repeat(lag, axis=0), z[: len(z) - lag]]) for lag in range(1, lags + 1)])

    z = (train[:, which] - mean) / sd
    last = len(z) - lags + 1
    future = np.hstack([z[lag : last + lag] for lag in range(lags)])[lags:]
    before = past(train)[lags:last]
    centre = before.mean(0)
    both = np.cov(before.T, future.T)
    width = before.shape[1]

    def root(covariance: Array) -> Array:
        values, vectors = np.linalg.eigh(covariance)
        return np.asarray(vectors @ np.diag(np.maximum(values, 1e-10 * values.max()) ** -0.5) @ vectors.T)

    whiten = root(both[:width, :width])
    u, _, _ = np.linalg.svd(whiten @ both[:width, width:] @ root(both[width:, width:]))
    to_states = u.T @ whiten

    def of(part: slice) -> Statistic:
        return lambda x: np.asarray((((past(x) - centre) @ to_states.T[:, part]) ** 2).sum(1))

    return [of(slice(states)), of(slice(states, None))]


def main() -> None:
    folder = Path(sys.argv[1])
    train, normal = read(folder / "d00.dat"), read(folder / "d00_te.dat")
    faulty = [read(folder / f"d{number:02}_te.dat") for number in range(1, 22)]
    statistics = [*pca(train, 0), *pca(train, 2), *cva(train)]
    columns = []
    for statistic in statistics:
        quiet = statistic(normal)[SKIP:]
        threshold = float(np.quantile(quiet, QUANTILE))
        by_training = float(np.quantile(statistic(train)[SKIP:], QUANTILE))
        alarms = [statistic(x) > threshold for x in faulty]
        detected = [float(alarm[ONSET:].mean()) for alarm in alarms]
        before = float(np.mean([alarm[SKIP:ONSET].mean() for alarm in alarms]))
        columns.append([*detected, float(np.mean(detected)), before, float((quiet > by_training).mean())])
    print("| fault | PCA T2 | PCA Q | dynamic PCA T2 | dynamic PCA Q | CVA T2, states | CVA T2, rest |")
    print("|---|---|---|---|---|---|---|")
    names = [f"IDV {number}" for number in range(1, 22)]
    names += ["mean of all", "in alarm before the faults", "in alarm in d00_te.dat with a threshold from d00.dat"]
    for name, row in zip(names, zip(*columns, strict=True), strict=True):
        print(f"| {name} | " + " | ".join(f"{x:.3f}" for x in row) + " |")


if __name__ == "__main__":
    main()
