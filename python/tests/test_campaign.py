import importlib.util
import json
from pathlib import Path
from typing import Any

import pytest

import pt326
from conftest import Command

CELLS: dict[str, Any] = {
    "seeds_from": 1,
    "cell": [
        {
            "name": "offset",
            "runs": 3,
            "phase": 20.0,
            "disturbance": "calm",
            "fault": [{"do": "offset", "sensor": "t2", "size": 3.0, "at": 400.0, "for": 20.0}],
        },
        {"name": "quiet", "runs": 2, "duration": 450.0, "disturbance": "calm", "expect": "silence"},
    ],
}


def test_a_campaign_is_that_of_the_command_line(command: Command, tmp_path: Path) -> None:
    done = command("campaign", "--quick", "--only", "nominal/", "--out", tmp_path / "cli")
    assert done.returncode == 0, done.stderr
    campaign = pt326.campaign("quick", only="nominal/", progress=False)
    assert done.stdout.startswith(str(campaign))
    assert campaign.results == json.loads((tmp_path / "cli" / "campaign.json").read_text())
    campaign.write(tmp_path / "ours")
    for name in ("campaign.json", "cells.csv", "runs.csv", "tables.md"):
        assert (tmp_path / "ours" / name).read_bytes() == (tmp_path / "cli" / name).read_bytes(), name
    assert len(campaign.to_pandas()) == len(campaign.runs) == 30


class Difference:
    """T2 is wrong when it has moved against T1 by 1.5 degC."""

    def __init__(self) -> None:
        self.armed, self.ticks, self.usual = False, 0, 0.0

    def step(self, t0: float, t1: float, t2: float, power: float) -> str | None:
        self.ticks += 1
        self.armed = self.ticks > 2500
        if not self.armed:
            self.usual += (t1 - t2 - self.usual) / self.ticks
            return None
        return "t2_offset" if abs(t1 - t2 - self.usual) > 2.0 else None


def scored(evaluation: pt326.Evaluation) -> dict[tuple[str, str], dict[str, Any]]:
    return {(row["cell"], row["by"]): row for row in evaluation.rows}


def test_a_detector_is_scored_beside_ours() -> None:
    evaluation = pt326.evaluate(Difference, CELLS, progress=False)
    rows = scored(evaluation)
    theirs = rows["offset", "Difference"]
    assert (theirs["runs"], theirs["detected_pct"], theirs["isolated_pct"], theirs["unarmed"]) == (3, 100, 100, 0)
    assert 0.0 <= theirs["delay_s"] < 1.0
    assert rows["offset", "likelihood"]["detected_pct"] == 100
    assert rows["quiet", "Difference"]["detected_pct"] is None
    assert rows["quiet", "Difference"]["hours"] == pytest.approx(2 * (450.0 - 2500 * 0.11) / 3600, rel=0.01)
    assert "Difference" in str(evaluation)
    assert len(evaluation.plot().axes) == 4
    assert len(evaluation.to_pandas()) == 6
    if importlib.util.find_spec("polars"):
        assert evaluation.to_polars().shape == evaluation.to_pandas().shape


def test_who_says_nothing_misses_all_and_who_cries_always_gets_no_credit() -> None:
    class Silent:
        def step(self, t0: float, t1: float, t2: float, power: float) -> str | None:
            return None

    class Crying:
        def step(self, t0: float, t1: float, t2: float, power: float) -> str | None:
            return "fire"

    silent = scored(pt326.evaluate(Silent, CELLS, progress=False))
    crying = scored(pt326.evaluate(Crying(), CELLS, name="crying", progress=False))
    assert silent["offset", "Silent"]["detected_pct"] == 0
    assert silent["quiet", "Silent"]["alarms"] == 0
    assert crying["offset", "crying"]["detected_pct"] == 0
    assert crying["quiet", "crying"]["alarms"] == 2
    assert silent["offset", "likelihood"] == crying["offset", "likelihood"]


def test_what_a_detector_raises_is_raised_and_what_it_says_must_be_a_word() -> None:
    class Broken:
        def step(self, t0: float, t1: float, t2: float, power: float) -> str | None:
            raise ZeroDivisionError

    class Number:
        def step(self, t0: float, t1: float, t2: float, power: float) -> int:
            return 3

    with pytest.raises(ZeroDivisionError):
        pt326.evaluate(Broken, CELLS, progress=False)
    with pytest.raises(TypeError):
        pt326.evaluate(Number, CELLS, progress=False)  # type: ignore[arg-type]


def test_a_cell_that_there_is_not_is_named() -> None:
    with pytest.raises(pt326.Error, match='no cell has "kettle" in its name'):
        pt326.campaign("quick", only="kettle")
