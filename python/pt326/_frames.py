"""Columns as data frames, and progress bars, where the packages for them are there."""

from __future__ import annotations

import csv
import importlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

Progress = Callable[[int, "int | None"], object]


def needed(package: str, what: str) -> Any:
    """A package that not everybody has who has this one; where it is missing, the error says who needs it and how to get it."""
    try:
        return importlib.import_module(package)
    except ModuleNotFoundError as missing:
        if missing.name != package.partition(".")[0]:
            raise
        raise ImportError(f"{what} needs {missing.name}: pip install {missing.name}", name=missing.name) from None


def plots() -> Any:
    """What draws."""
    needed("matplotlib", "plot")
    from . import _plot

    return _plot


def to_pandas(columns: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> Any:
    """Columns, or rows, as a pandas.DataFrame."""
    return needed("pandas", "to_pandas").DataFrame(columns)


def to_polars(columns: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> Any:
    """Columns, or rows, as a polars.DataFrame."""
    polars = needed("polars", "to_polars")
    if isinstance(columns, Mapping):
        # An array of words is an array of objects, of which Polars knows nothing.
        columns = {name: list(column) if column.dtype == object else column for name, column in columns.items()}
    return polars.DataFrame(columns)


def rows_of(text: str) -> list[dict[str, Any]]:
    """The rows of a CSV, with numbers as numbers and None where nothing stands."""
    return [{name: _value(cell) for name, cell in row.items()} for row in csv.DictReader(text.splitlines())]


def _value(cell: str) -> object:
    if cell == "":
        return None
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            pass
    return cell


@contextmanager
def shown(what: str, progress: bool | Progress) -> Iterator[Progress | None]:
    """Who is told of the progress: a callable of (done, of); a bar of tqdm, where that is there; nobody."""
    if not isinstance(progress, bool):
        yield progress
        return
    try:
        tqdm = importlib.import_module("tqdm") if progress else None
    except ImportError:
        tqdm = None
    if tqdm is None:
        yield None
        return
    with tqdm.tqdm(unit=what, leave=False) as bar:

        def tell(done: int, of: int | None) -> None:
            bar.total = of
            bar.update(done - bar.n)

        yield tell
