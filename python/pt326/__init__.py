"""The PT-326 instrument in Python: the code of the board, with its simulated rig.

``run()`` is the paper's experiment; ``Rig`` and ``Instrument`` are the same tick by tick; ``diagnose()`` reads the recording of any heater;
``fit_rig()`` makes a simulated rig of one; ``tune()`` finds PID settings for a rig; ``campaign()`` and ``evaluate()`` score both diagnoses, and
anybody's detector, over many runs. The project's docs/python.md has more.
"""

from typing import Any

from ._campaign import Campaign, Detector, Evaluation, campaign, evaluate
from ._core import VERSION as __version__
from ._core import Board, Codes, Config, Finding, Instrument, Monitor, Report, Setting, scenario
from ._error import Error
from ._identify import Model, identify
from ._recording import Diagnosis, FittedRig, diagnose, fit_rig
from ._rig import Rig
from ._run import Run, isolability, repeat, run
from ._scorer import Scorer
from ._tune import Tuning, tune

__all__ = [
    "Board",
    "Campaign",
    "Codes",
    "Config",
    "Detector",
    "Diagnosis",
    "Error",
    "Evaluation",
    "Finding",
    "FittedRig",
    "Instrument",
    "Model",
    "Monitor",
    "Report",
    "Rig",
    "Run",
    "Scorer",
    "Setting",
    "Tuning",
    "__version__",
    "campaign",
    "diagnose",
    "evaluate",
    "fit_rig",
    "identify",
    "isolability",
    "repeat",
    "run",
    "scenario",
    "tune",
]


def __getattr__(name: str) -> Any:
    if name == "tclab":  # not before somebody asks for it: it needs a package that few have
        import importlib

        return importlib.import_module("pt326.tclab")
    raise AttributeError(f"module 'pt326' has no attribute {name!r}")
