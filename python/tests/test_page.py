"""The blocks of docs/python.md, as somebody runs them who has installed ``./python[notebooks]``, one after the other."""

import re
import sys
from pathlib import Path
from typing import Any

import pandas
import pytest

import pt326

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/python.md").read_text(encoding="utf-8")
BLOCKS: list[str] = re.findall(r"^```python\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def recording() -> pandas.DataFrame:
    """What the page calls `frame`: docs/heater.csv under the names that the page uses."""
    frame = pandas.read_csv(ROOT / "docs/heater.csv")
    frame.columns = pandas.Index(["t", "T_box", "PWM"])
    return frame.assign(PWM=frame["PWM"] * 2.55)


def test_the_blocks_of_the_page_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "polars", None)  # `notebooks` does not bring it
    given: dict[str, Any] = {"pt326": pt326, "pandas": pandas, "frame": recording()}
    run = 0
    for block in BLOCKS:
        if "pt326.Board(" in block:
            board = pytest.importorskip("board", reason="there are no pseudo-terminals here")
            block = block.replace("/dev/ttyACM0", board.SimulatedBoard(ticks=300).port).replace("...", "break")
        exec(compile(block, "docs/python.md", "exec"), given)
        run += 1
    assert run > 8
