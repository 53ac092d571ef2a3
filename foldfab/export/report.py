"""What a look at a print folder found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Row:
    """One thing that was checked."""

    code: str
    """Short and stable, such as `gap`."""
    ok: bool
    text: str
    """The measured figure, or what is wrong and where."""
    facts: dict[str, Any] = field(default_factory=dict)
    """Figures for programs, where there are several."""


@dataclass(frozen=True, slots=True)
class Report:
    """All that was checked in a print folder."""

    rows: tuple[Row, ...]

    @property
    def ok(self) -> bool:
        """Whether every check holds."""
        return all(row.ok for row in self.rows)


def listed(problems: list[str], limit: int = 3) -> str:
    """The first few problems as one line."""
    more = f" and {len(problems) - limit} more" if len(problems) > limit else ""
    return "; ".join(problems[:limit]) + more
