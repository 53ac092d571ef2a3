"""Everything that foldfab raises on purpose.

FoldfabError                 one clear message; `exit_status` is what the command line ends with
├── RecipeError              bad input: every problem at once, each with its place (status 2)
├── AbstractionError         the furniture has no scaffold along this direction (status 1)
├── FoldingError             no valid folding solution (status 1)
│   └── LossError            none that loses as little as was asked for
├── FabricationError         the solids would not work: the findings that say so (status 1)
├── SlicingError             the slicer makes nothing of a print file (status 1)
├── PrintFolderError         a print folder that cannot be read or written (status 2)
└── MissingLibraryError      a library or system package that this step needs is absent (status 2)
"""

from __future__ import annotations

from dataclasses import dataclass


class FoldfabError(Exception):
    """Base of all errors that foldfab raises on purpose."""

    exit_status = 1
    advice: tuple[str, ...] = ()
    """Single changes that would help, where they were looked for."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong with an input, and what would be right."""

    place: str
    """Where: a path into the file such as `parts[2].box.size`."""
    text: str
    """What is wrong and what to try, one sentence."""

    def __str__(self) -> str:
        return f"{self.place}: {self.text}"


class RecipeError(FoldfabError):
    """A recipe that cannot be understood; `problems` lists all that is wrong."""

    exit_status = 2

    def __init__(self, source: str, problems: tuple[Problem, ...]) -> None:
        self.source = source
        self.problems = problems
        lines = "".join(f"\n  {problem}" for problem in problems)
        count = f"{len(problems)} problem{'s' if len(problems) != 1 else ''}"
        super().__init__(f"{source}: {count}{lines}")


class AbstractionError(FoldfabError):
    """Furniture that has no scaffold along its folding direction."""

    def __init__(self, message: str, parts: tuple[str, ...] = ()) -> None:
        self.parts = parts
        super().__init__(message)


class FoldingError(FoldfabError):
    """A scaffold for which no valid folding solution exists; the message says what stands in the way."""


class LossError(FoldingError):
    """More patches would have to go than was asked for."""

    def __init__(self, gone: int) -> None:
        self.gone = gone
        super().__init__(f"no folding solution: at least {gone} parts would have to go")


class FabricationError(FoldfabError):
    """Solids that would not print or not fold; the message lists the findings."""


class SlicingError(FoldfabError):
    """A print file of which the slicer makes no G-code; the message is the slicer's own."""


class PrintFolderError(FoldfabError):
    """A print folder that cannot be read or written."""

    exit_status = 2


class MissingLibraryError(FoldfabError):
    """A library or system package that this step needs is absent; the message says how to install it."""

    exit_status = 2
