import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import matplotlib
import pytest

matplotlib.use("Agg")

Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def command() -> Command:
    """The command line to compare with: its path stands in PT326 (``tools/try-python`` builds it)."""
    path = os.environ.get("PT326")
    if path is None:
        pytest.skip("PT326 names no command to compare with")

    def run(*arguments: str | Path, typed: str | None = None) -> "subprocess.CompletedProcess[str]":
        return subprocess.run([path, *map(str, arguments)], input=typed, capture_output=True, text=True, check=False)

    return run
