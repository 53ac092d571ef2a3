"""Notes on what reading had to suppose or leave out: a sentence, and the names of what it is about."""

from __future__ import annotations

from collections.abc import Iterable

MOST_TOLD = 12
"""More names than these are counted, not listed."""


def note(notes: list[str], what: str, names: Iterable[str], is_sorted: bool = False) -> None:
    """Adds a note on the parts of these names, where there are any."""
    told = list(names) if is_sorted else sorted(names)
    if told:
        notes.append(f"{what}: {listed(told)}")


def listed(names: list[str]) -> str:
    """The first of some names, and how many more there are."""
    rest = f" and {len(names) - MOST_TOLD} more" if len(names) > MOST_TOLD else ""
    return f"{'; '.join(names[:MOST_TOLD])}{rest}"
