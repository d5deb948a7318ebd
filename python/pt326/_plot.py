"""Pictures with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import pyplot

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._campaign import Evaluation
    from ._recording import Diagnosis
    from ._run import Run
    from ._tune import Tuning

# Okabe and Ito's colours, which the colour-blind can tell apart.
BLUE, VERMILLION, INK = "#0072b2", "#d55e00", "#202830"
RAW: dict[str, Any] = {"color": "#b9c1cb", "lw": 0.7}
FILTERED: dict[str, Any] = {"color": "#0b3c6f", "lw": 1.2}
FAULTS = ("#e69f00", "#009e73", "#cc79a7", "#56b4e9")


def figure(run: Run, number: int) -> Any:
    """A figure of the paper."""
    drawn = {4: _measurements, 5: _features, 6: _residuals}.get(number)
    if drawn is None:
        raise ValueError(f"figure is {number}, expected 4, 5 or 6")
    return drawn(run)


def _panels(run: Run, titles: list[str], heights: list[float] | None = None) -> tuple[Any, Any]:
    figure = pyplot.figure(figsize=(10, 1.3 * len(titles) + 0.6), layout="constrained")
    panels = figure.subplots(len(titles), 1, sharex=True, height_ratios=heights)
    for panel, title in zip(panels, titles, strict=True):
        panel.set_title(title, loc="left", fontsize=9)
        panel.tick_params(labelsize=8)
        panel.grid(alpha=0.3)
        for fault, colour in zip(run.faults, FAULTS * len(run.faults), strict=False):
            end = min(fault["onset_s"] + fault["duration_s"], run.t[-1])
            panel.axvspan(fault["onset_s"], end, color=colour, alpha=0.2, lw=0)
    for fault in run.faults:
        panels[0].annotate(
            fault["name"], (fault["onset_s"], 1), xycoords=("data", "axes fraction"), fontsize=8, va="top"
        )
    panels[-1].set_xlabel("time (s)")
    panels[-1].set_xlim(run.t[0], run.t[-1])
    return figure, panels


def _measurements(run: Run) -> Any:
    figure, (room, outlet, power, rise) = _panels(
        run,
        ["Ambient temperature T0 (°C)", "Set-point R and outlet temperatures T1, T2 (°C)", "Heating power Pa (%)",
         "Rise over the room: measured y1, y2 and one-step predictions (°C)"],
    )  # fmt: skip
    room.plot(run.t, run["t0_c"], **FILTERED)
    outlet.plot(run.t, run["t2_c"], color=VERMILLION, lw=0.8, label="T2")
    outlet.plot(run.t, run["t1_c"], color=BLUE, lw=0.8, label="T1")
    outlet.plot(run.t, run["setpoint_c"], color=INK, lw=1.2, drawstyle="steps-post", label="R")
    power.plot(run.t, run["pa_pct"], **FILTERED)
    for column, colour, width in (
        ("y2_c", "#f3c09a", 2), ("y2m_c", VERMILLION, 0.8), ("y1_c", "#9ccbe6", 2), ("y1m_c", BLUE, 0.8)
    ):  # fmt: skip
        rise.plot(run.t, run[column], color=colour, lw=width, label=column.removesuffix("_c"))
    outlet.legend(fontsize=7, loc="upper right", ncols=3)
    rise.legend(fontsize=7, loc="upper right", ncols=4)
    return figure


def _features(run: Run) -> Any:
    figure, (ry1, ry2, gains, bandwidth) = _panels(
        run,
        ["Output residual ry1 = y1 - y1m (°C)", "Output residual ry2 = y2 - y2m (°C)",
         "Static gains sg1 and sg2 (°C per %)", "Bandwidth bw1 (rad/s)"],
    )  # fmt: skip
    for panel, column in ((ry1, "ry1"), (ry2, "ry2")):
        panel.plot(run.t, run[column], **RAW)
        panel.plot(run.t, run[column + "_f"], **FILTERED)
    gains.plot(run.t, run["sg1"], color=BLUE, label="sg1")
    gains.plot(run.t, run["sg2"], color=VERMILLION, label="sg2")
    gains.legend(fontsize=7, loc="upper right", ncols=2)
    bandwidth.plot(run.t, run["bw1"], **FILTERED)
    return figure


def _residuals(run: Run) -> Any:
    titles = {
        "rap": "Power residual rAP (%)",
        "ry12": "Sensor difference residual ry12 (°C)",
        "rsg1": "Static gain residual rsg1 of MS1 (°C per %)",
        "rsg2": "Static gain residual rsg2 of MS2 (°C per %)",
        "rbw1": "Bandwidth residual rbw1 of MS1 (rad/s)",
        "fdv": "Fault detection vector fdv",
        "fiv": "Fault isolation vector fiv (1: AFS2; 2: MFS1; 3: MFP)",
        "said": "Likelihood diagnosis: alarm and verdict",
    }
    figure, panels = _panels(run, list(titles.values()))
    baseline = run.summary["baseline"]
    for panel, name in zip(panels[:5], titles, strict=False):
        panel.plot(run.t, run[name], **RAW)
        panel.plot(run.t, run[name + "_f"], **FILTERED)
        _within(panel, run[name], run[name + "_f"])
        if baseline is not None:
            learnt = baseline[name]
            centre, reach = learnt["mean_f"] - learnt["mean"], run._sigma_factor * learnt["sigma_f"]
            for threshold in (centre - reach, centre + reach):
                panel.axhline(threshold, color=VERMILLION, ls="--", lw=0.9)
    for panel, name in zip(panels[5:7], ("fdv", "fiv"), strict=True):
        panel.plot(run.t, run[name + "_raw"], drawstyle="steps-post", **RAW)
        panel.plot(run.t, run[name], drawstyle="steps-post", **FILTERED)
    _said(run, panels[7])
    return figure


def _within(panel: Any, raw: NDArray[Any], filtered: NDArray[Any]) -> None:
    """Single wild values of a raw residual do not set the scale."""
    known = raw[~np.isnan(raw)]
    if known.size:
        low = min(np.nanmin(filtered), np.quantile(known, 0.002))
        high = max(np.nanmax(filtered), np.quantile(known, 0.998))
        panel.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))


def _said(run: Run, panel: Any) -> None:
    """What the likelihood diagnosis says, on a line for each name, and the sentences below."""
    names = ["quiet", "alarm", *dict.fromkeys(name for name in run["verdict"] if name is not None)]
    places = {name: place for place, name in enumerate(names)}
    alarm = run["alarm"]
    level = [places[name] if name is not None else alarm[k] for k, name in enumerate(run["verdict"])]
    panel.plot(run.t, np.asarray(level, dtype=float), drawstyle="steps-post", **FILTERED)
    panel.set_yticks(range(len(names)), names, fontsize=7)
    said = _last_sentences(run)
    if said:
        panel.set_xlabel("time (s)\n" + "\n".join(said), fontsize=8)


def _last_sentences(run: Run) -> list[str]:
    """The last sentence about each fault; of a recording, whose faults nobody knows, under each name, of those that stood longest."""
    if run.faults:
        return [f"{fault['name']}: {fault['likelihood_sentence'] or 'not named'}" for fault in run.faults]
    by_name: dict[str, tuple[float, str]] = {}
    for event in run.events:
        if event["sentence"]:
            lasted = event["until"] - event["at"]
            if lasted >= by_name.get(event["name"], (0.0, ""))[0]:
                by_name[event["name"]] = (lasted, event["sentence"])
    longest = sorted(by_name.values(), reverse=True)[:4]
    return [sentence for _, sentence in longest]


def diagnosis(found: Diagnosis) -> Any:
    """Temperatures with what was expected, power, and what was said of a recording."""
    figure, (temperatures, power, said) = _panels(
        found, ["Temperatures, and T1 as the model expects it (pale)", "Power", "What is said"], [2, 1, 1]
    )
    temperatures.plot(found.t, found["t1_expected"], color="#9ccbe6", lw=3, label="expected")
    for column, colour in (("t0_c", "#7f8a96"), ("t2_c", VERMILLION), ("t1_c", BLUE)):
        values = found[column]
        if not np.isnan(values).all():
            temperatures.plot(found.t, values, color=colour, lw=0.9, label=column[:2].upper())
    temperatures.legend(fontsize=7, loc="center right", ncols=4)
    power.plot(found.t, found["pa_pct"], **FILTERED)
    for panel in (temperatures, power, said):
        panel.axvspan(found.t[0], found.watched_from, color="#b4bbc4", alpha=0.25, lw=0)
    _said(found, said)
    return figure


def tuning(of: Tuning) -> Any:
    """T1 and the power of the experiment that tunes."""
    figure = pyplot.figure(figsize=(10, 4), layout="constrained")
    temperature, power = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    temperature.plot(of.t, of.t1, color=BLUE, lw=0.9)
    power.plot(of.t, of.power, drawstyle="steps-post", **FILTERED)
    for panel, title in ((temperature, "T1 (°C)"), (power, "Power (%)")):
        panel.set_title(title, loc="left", fontsize=9)
        panel.tick_params(labelsize=8)
        panel.grid(alpha=0.3)
    power.set_xlabel("time (s)")
    return figure


def evaluation(of: Evaluation) -> Any:
    """A detector beside both of ours."""
    cells = list(dict.fromkeys(row["cell"] for row in of.rows))
    by = list(dict.fromkeys(row["by"] for row in of.rows))
    panels = (
        ("detected_pct", "Detected (%)"), ("isolated_pct", "Rightly named (%)"),
        ("delay_s", "Delay of the detection, median (s)"), ("alarms_per_hour", "False alarms an hour"),
    )  # fmt: skip
    figure = pyplot.figure(figsize=(12, 0.28 * len(cells) * 3 / 2 + 1.4), layout="constrained")
    for axes, (key, title) in zip(figure.subplots(1, len(panels), sharey=True), panels, strict=True):
        for which, (name, colour) in enumerate(zip(by, (VERMILLION, BLUE, "#7f8a96"), strict=True)):
            rows = {row["cell"]: row[key] for row in of.rows if row["by"] == name}
            values = [np.nan if rows[cell] is None else rows[cell] for cell in cells]
            axes.barh(np.arange(len(cells)) + 0.27 * (which - 1), values, 0.25, color=colour, label=name)
        axes.set_title(title, loc="left", fontsize=9)
        axes.tick_params(labelsize=8)
        axes.grid(axis="x", alpha=0.3)
    first = figure.axes[0]
    first.set_yticks(range(len(cells)), cells)
    first.invert_yaxis()
    figure.legend(*first.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
    return figure
