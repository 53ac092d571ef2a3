"""What the benchmarks share: which recipes, a cold solver, process time, plain tables and what is wrong in one line."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import foldfab
from foldfab.errors import RecipeError
from foldfab.pipeline import prepare

ABSENT = "-"
"""What a table shows where there is nothing to show."""


def ready() -> None:
    """Imports all that a solve may need, so that none of it is measured."""
    prepare()
    import ortools.sat.python.cp_model  # noqa: F401


def recipe_files(given: Sequence[str]) -> list[Path]:
    """The recipes that were asked for: files, all in a folder, or shipped ones by name; all shipped where none is."""
    if not given:
        return list(foldfab.shipped())
    shipped = {path.stem: path for path in foldfab.shipped()}
    found: list[Path] = []
    for text in given:
        if Path(text).is_dir():
            found += sorted(Path(text).glob("*.json"))
        else:
            found.append(shipped.get(text, Path(text)))
    return found


def forget() -> None:
    """Empties what foldfab remembers from one solve to the next."""
    for name, module in sorted(sys.modules.items()):
        if name.startswith("foldfab."):
            for value in vars(module).values():
                if hasattr(value, "cache_clear"):
                    value.cache_clear()


def timed(call: Callable[[], Any]) -> tuple[Any, float]:
    """What a call returns, or the exception that it ends with, and its process time in ms."""
    start = time.process_time()
    try:
        result = call()
    except Exception as error:  # a benchmark goes on with the next row
        result = error
    return result, 1000 * (time.process_time() - start)


@dataclass
class Clock:
    """What was measured."""

    ms: float = 0.0


@contextmanager
def clocked(module: ModuleType, name: str) -> Iterator[Clock]:
    """Sums up the process time that is spent in a function of a module meanwhile."""
    clock, function = Clock(), getattr(module, name)

    def measured(*arguments: Any, **options: Any) -> Any:
        start = time.process_time()
        try:
            return function(*arguments, **options)
        finally:
            clock.ms += 1000 * (time.process_time() - start)

    setattr(module, name, measured)
    try:
        yield clock
    finally:
        setattr(module, name, function)


def told(error: Exception) -> str:
    """The first line of what went wrong; where that was not foldfab's own word for it, with its place in the code."""
    if isinstance(error, RecipeError) and error.problems:
        return str(error.problems[0])
    first = (str(error).splitlines() or [""])[0]
    if isinstance(error, foldfab.FoldfabError):
        return first
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    place = f" at {Path(trace.tb_frame.f_code.co_filename).name}:{trace.tb_lineno}" if trace is not None else ""
    return f"{type(error).__name__}: {first}{place}"


@dataclass(frozen=True)
class Column:
    """One column of a table; all but the first are set to the right."""

    title: str
    width: int
    form: str = ""
    """How its values are formatted, as in `format(value, form)`."""

    def cell(self, value: object) -> str:
        """A value as text, without its padding."""
        return ABSENT if value is None else format(value, self.form)


@dataclass(frozen=True)
class Table:
    """Columns of a plain table; each line is printed as soon as it is known."""

    columns: tuple[Column, ...]

    def head(self) -> None:
        """Prints the titles."""
        self._print([column.title for column in self.columns], "")

    def row(self, *values: object, note: str = "") -> None:
        """Prints one line, and a note behind it."""
        self._print([column.cell(value) for column, value in zip(self.columns, values, strict=False)], note)

    def _print(self, cells: list[str], note: str) -> None:
        pairs = list(zip(self.columns, cells, strict=False))
        padded = [cell.rjust(c.width) if i else cell.ljust(c.width) for i, (c, cell) in enumerate(pairs)]
        print("  ".join([*padded, note]).rstrip(), flush=True)
