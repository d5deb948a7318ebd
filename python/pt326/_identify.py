"""An ARX model of a recording, by the recursive least squares that runs on the board."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from . import _core, _frames
from ._error import Error

#: Most past outputs, and most inputs.
ORDER_MAX = 8
#: Parameters of the estimator: those of the largest order, and a constant.
PARAMETERS = 2 * ORDER_MAX + 1


class Model:
    """An ARX model, y[k] + a1 y[k-1] + .. = b1 u[k-nk] + .. + e[k], with what follows from it and reasons for doubt."""

    def __init__(self, a: Any, b: Any, delay: int, ts: float, report: dict[str, Any]) -> None:
        #: a1, a2, ..
        self.a: list[float] = [float(x) for x in a]
        #: b1, b2, ..
        self.b: list[float] = [float(x) for x in b]
        #: Samples from the input to the output.
        self.delay = delay
        #: Sample time, s.
        self.ts = ts
        #: Standard deviations ``sd`` of a and b; ``static_gain`` and its ``static_gain_sd``; ``time_constants_s``; ``fit_pct``, the share of y that
        #: the model explains when it is simulated, on the rows that it was estimated from and on those to test on; ``doubts``, in words.
        self.report = report

    def transfer_function(self) -> Any:
        """It as a control.TransferFunction."""
        control = _frames.needed("control", "transfer_function")
        excess = self.delay + len(self.b) - 1 - len(self.a)
        numerator, denominator = [*self.b, *[0.0] * max(0, -excess)], [1.0, *self.a, *[0.0] * max(0, excess)]
        return control.TransferFunction(numerator, denominator, self.ts)

    def __str__(self) -> str:
        names = [f"a{i + 1}" for i in range(len(self.a))] + [f"b{i + 1}" for i in range(len(self.b))]
        lines = [
            f"  {name} {value:10.6g} +- {sd:.2g}"
            for name, value, sd in zip(names, [*self.a, *self.b], self.report["sd"], strict=True)
        ]
        gain, sd = self.report["static_gain"], self.report["static_gain_sd"]
        times = ", ".join(f"{time:.3g}" for time in self.report["time_constants_s"]) or "none"
        fits = " and ".join(f"{fit:.1f} %" for fit in self.report["fit_pct"])
        lines += [f"  gain {gain:.4g} +- {sd:.2g}; time constants {times} s; simulated, it explains {fits}"]
        return "\n".join([repr(self)[1:-1], *lines, *(f"  doubt: {doubt}" for doubt in self.report["doubts"])])

    def __repr__(self) -> str:
        return f"<pt326.Model ARX({len(self.a)},{len(self.b)},{self.delay}), {self.ts:g} s>"


def identify(
    recording: str | os.PathLike[str] | Mapping[str, Any] | Any,
    *,
    u: str,
    y: str,
    order: tuple[int, int, int],
    ts: float,
    lam: float = 1.0,
    detrend: Literal["none", "mean", "offset"] = "offset",
    rows: tuple[int, int] | None = None,
    validate: tuple[int, int] | None = None,
) -> Model:
    """Identifies an ARX model with the board's recursive least squares.

    ``recording`` is a file, a data frame, or a mapping of columns; ``order`` is na, nb, nk: past outputs, inputs, delay in samples. ``ts`` is the
    sample time in s. What u and y are at rest is estimated with the model ("offset"), or is the mean ("mean"), or 0 ("none"). ``rows`` are those
    to estimate from, ``validate`` those to test on, each (first, one behind the last).
    """
    if not all(1 <= n <= ORDER_MAX for n in order[:2]) or not 0 <= order[2] <= 100:
        raise Error(f"order is {order}, expected na and nb from 1 to {ORDER_MAX}, nk from 0 to 100")
    if detrend not in ("none", "mean", "offset"):
        raise Error(f'detrend is {detrend!r}, expected "none", "mean" or "offset"')
    if not ts > 0 or not 0.5 <= lam <= 1:
        raise Error(f"ts is {ts} and lam is {lam}, expected a time above 0 s and a number from 0.5 to 1")
    all_u, all_y = _columns(recording, u, y)
    part = slice(*(rows or (0, len(all_y))))
    input_, output = all_u[part], all_y[part]
    rest = (input_.mean(), output.mean()) if detrend == "mean" else (0.0, 0.0)
    phi, goal, weight = _regressors(input_ - rest[0], output - rest[1], order, lam, detrend == "offset")
    if len(goal) < 3 * phi.shape[1]:
        raise Error(f"{len(goal)} rows for {phi.shape[1]} parameters, expected three for each")
    scale = np.sqrt(np.mean(phi**2, axis=0))
    scale[scale == 0] = 1.0
    size = float(np.sqrt(np.mean(goal**2))) or 1.0
    padded = np.zeros((len(goal), PARAMETERS), np.float32)
    padded[:, : phi.shape[1]] = phi / scale
    theta = _core.rls(padded, (goal / size).astype(np.float32), lam)[: phi.shape[1]].astype(float) * size / scale
    residual = goal - phi @ theta
    variance = float(weight @ residual**2) / max(1.0, weight.sum() - len(theta))
    information = (phi * weight[:, None]).T @ phi
    covariance = variance * np.linalg.pinv(information, hermitian=True)
    return _model(theta, covariance, order, ts, residual, (all_u, all_y), (part, validate))


def _columns(recording: Any, u: str, y: str) -> tuple[Any, Any]:
    from ._recording import _as_csv  # a data frame in the words of a file, as for diagnose()

    is_file = isinstance(recording, (str, os.PathLike))
    found = _core.columns(recording if is_file else None, None if is_file else _as_csv(recording), [u, y])
    return found[u], found[y]


def _regressors(u: Any, y: Any, order: tuple[int, int, int], lam: float, constant: bool) -> tuple[Any, Any, Any]:
    """Backward differences of past outputs and inputs, and the step of the output (the delta operator, Middleton and Goodwin 1990): lagged values
    of what is sampled fast are nearly the same, and their differences would drown in single precision."""
    na, nb, nk = order
    first = max(na, nb + nk - 1)
    at = np.arange(first, len(y))
    columns = [np.diff(y, i)[at - 1 - i] for i in range(na)] + [np.diff(u, i)[at - nk - i] for i in range(nb)]
    if constant:
        columns.append(np.ones(len(at)))
    return np.column_stack(columns), y[at] - y[at - 1], lam ** np.arange(len(at) - 1, -1, -1.0)


def _lags(n: int) -> Any:
    """What turns parameters of differences into those of lagged values: D^i x[k] = sum (-1)^j binomial(i, j) x[k-j]."""
    return np.array([[(-1) ** j * math.comb(i, j) if j <= i else 0 for i in range(n)] for j in range(n)], float)


def _model(
    theta: Any, covariance: Any, order: tuple[int, int, int], ts: float, residual: Any, data: Any, parts: Any
) -> Model:
    na, nb, nk = order
    turn = np.zeros((na + nb, len(theta)))
    turn[:na, :na], turn[na:, na : na + nb] = -_lags(na), _lags(nb)
    a_b = turn @ theta
    a_b[0] -= 1.0
    sd = np.sqrt(np.diag(turn @ covariance @ turn.T))
    # At rest all differences are zero: alpha_0 y + beta_0 u + constant = 0.
    alpha, beta = theta[0], theta[na]
    gain = -beta / alpha if alpha else math.inf
    slope = np.zeros(len(theta))
    slope[0], slope[na] = (beta / alpha**2, -1 / alpha) if alpha else (0.0, 0.0)
    gain_sd = float(np.sqrt(slope @ covariance @ slope))
    at_rest = -theta[-1] / alpha if len(theta) > na + nb and alpha else None
    poles = np.roots([1.0, *a_b[:na]])
    decaying = [pole.real for pole in poles if abs(pole.imag) < 1e-9 and 0 < pole.real < 1]
    u, y = data
    spans = [part if isinstance(part, slice) else slice(*part) for part in parts if part is not None]
    fits = [_fit(u[span], y[span], a_b, order, at_rest) for span in spans]
    report = {
        "sd": [float(x) for x in sd],
        "static_gain": float(gain),
        "static_gain_sd": gain_sd,
        "time_constants_s": sorted((-ts / math.log(pole) for pole in decaying), reverse=True),
        "fit_pct": fits,
        "doubts": _doubts(a_b, sd, poles, gain, gain_sd, residual),
    }
    return Model(a_b[:na], a_b[na:], nk, ts, report)


def _fit(u: Any, y: Any, a_b: Any, order: tuple[int, int, int], at_rest: float | None) -> float:
    """How much of y the model explains that is simulated from its first values, %: 100 (1 - |y - simulated| / |y - mean|)."""
    na, nb, nk = order
    first = max(na, nb + nk - 1)
    if at_rest is None:
        u, y = u - u.mean(), y - y.mean()
        at_rest = 0.0
    simulated = (y - at_rest).copy()
    for k in range(first, len(y)):
        past = -simulated[k - na : k][::-1] @ a_b[:na]
        simulated[k] = past + u[k - nk - nb + 1 : k - nk + 1][::-1] @ a_b[na:]
    error, spread = np.linalg.norm(y - at_rest - simulated), np.linalg.norm(y - y.mean())
    return float(100 * (1 - error / spread)) if spread else math.nan


def _doubts(a_b: Any, sd: Any, poles: Any, gain: float, gain_sd: float, residual: Any) -> list[str]:
    doubts = []
    if any(abs(pole) >= 1 for pole in poles):
        doubts.append("it is not stable: drift, or a feedback that is not in the model")
    if not gain_sd < 0.3 * abs(gain):
        doubts.append("the gain is not known: the input moved too little, or only in one direction")
    if all(sd > abs(a_b)):
        doubts.append("no parameter is larger than its standard deviation")
    lagged = np.array([residual[i:] @ residual[: len(residual) - i] for i in range(1, 11)])
    portmanteau = len(residual) * float(np.sum((lagged / (residual @ residual)) ** 2))
    if portmanteau > 29.6:  # 0.1 % of a chi-square of ten degrees of freedom (Ljung, System Identification, 16.6)
        doubts.append("the residuals are not white: standard deviations are too small, another order may fit")
    return doubts
