"""Which parts touch: those whose boxes are close, but for pairs of which the recipe says otherwise.

A recipe may state that parts `touching` do, though their boxes are apart (what holds them together was left out), and
that parts `apart` do not, though their boxes meet (a box says little of a bent part). Names may be patterns.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from foldfab.errors import Problem, RecipeError
from foldfab.geometry.arrays import Array
from foldfab.recipe.fields import MOST_PAIRS
from foldfab.recipe.model import Pair, Part
from foldfab.recipe.names import fits
from foldfab.recipe.problems import shown

TOUCH_SHARE = 0.02
"""Parts touch where they are closer than this share of the parts' median longest side; tied to the parts and not to
the whole, so that a composite is abstracted like its cells."""
MOST_TOLD = 20
"""Contradictions that are listed."""


@dataclass(frozen=True, slots=True)
class Contacts:
    """Pairs of parts of which boxes tell it wrong."""

    touching: frozenset[Pair] = frozenset()
    """They touch, though their boxes do not."""
    apart: frozenset[Pair] = frozenset()
    """They do not, though their boxes do."""

    def among(self, names: set[str]) -> Contacts:
        """The pairs of parts of these names."""
        some, others = ({both for both in pairs if names.issuperset(both)} for pairs in (self.touching, self.apart))
        return Contacts(frozenset(some), frozenset(others))


BY_BOXES = Contacts()
"""Boxes tell all that there is to tell."""


def reach(sizes: Array) -> float:
    """How close parts of full or print sizes (n, 3) have to be to touch, in the same unit."""
    return TOUCH_SHARE * float(np.median(sizes.max(1)))


def pair(one: str, other: str) -> Pair:
    """Two names, sorted."""
    return (one, other) if one < other else (other, one)


def resolved(touching: list[list[str]], apart: list[list[str]], parts: tuple[Part, ...], source: str) -> Contacts:
    """What pairs of names or patterns state about parts.

    Raises:
        RecipeError: one means no two parts, or a pair is stated to touch and not to.
    """
    some, wrong = _pairs(touching, "touching", parts)
    others, more = _pairs(apart, "apart", parts)
    both = [Problem("apart", f"{shown(a)} and {shown(b)} stand in touching, too; keep one") for a, b in some & others]
    if problems := (*wrong, *more, *sorted(both, key=str)[:MOST_TOLD]):
        raise RecipeError(source, problems)
    return Contacts(frozenset(some), frozenset(others))


def beside(stated: Contacts, measured: Contacts) -> Contacts:
    """What is stated, and what was measured where it says nothing else."""
    return Contacts(
        stated.touching | (measured.touching - stated.apart), stated.apart | (measured.apart - stated.touching)
    )


def _pairs(stated: list[list[str]], field: str, parts: tuple[Part, ...]) -> tuple[set[Pair], list[Problem]]:
    """The pairs that are meant, and a problem for each that means none."""
    meant = {part.name.casefold(): [part.name] for part in parts}
    for pattern in {text for patterns in stated for text in patterns if text.casefold() not in meant}:
        meant[pattern.casefold()] = [part.name for part in parts if fits(part.name, pattern)]
    found: set[Pair] = set()
    problems = []
    for index, (first, second) in enumerate(stated):
        one, other = meant[first.casefold()], meant[second.casefold()]
        text = _problem({first: one, second: other})
        if text is None:
            found |= {pair(a, b) for a, b in product(one, other) if a != b}
        else:
            problems.append(Problem(f"{field}[{index}]", text))
    return found, problems


def _problem(meant: dict[str, list[str]]) -> str | None:
    """Why two patterns, with the names that they mean, make no pairs."""
    unknown = [shown(pattern) for pattern, names in meant.items() if not names]
    if unknown:
        return f"{' and '.join(unknown)} fits no part"
    if len({name for names in meant.values() for name in names}) < 2:
        return "means one part alone; give two"
    if math.prod(map(len, meant.values())) > MOST_PAIRS:
        return f"means more than {MOST_PAIRS} pairs; say it of fewer parts"
    return None
