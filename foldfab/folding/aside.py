"""Slanted lanes that no choice without a deletion can hold, kept aside until one has to delete anyway.

A slanted chain drags its base sideways, and all chains between the two bases have to go along (figure 12). Where no way
to slant is common to all patches of a unit, none of its whole choices slants: to compare those lanes with all others
would be half of the work for nothing.
"""

from __future__ import annotations

from foldfab.folding.conflict import drag_alike
from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import Repertoire, extend


def set_aside(problem: Problem, own: Repertoire) -> None:
    """Keeps the slanted lanes of a fresh repertoire out of what it offers where all of its patches can do without."""
    slanted = {p: tuple(x for x in many if x.drag is not None) for p, many in own.plain.items()}
    lead, *others = slanted.values()
    if not any(slanted.values()) or any(all(any(drag_alike(x, y) for y in many) for many in others) for x in lead):
        return
    while lacking := [p for p, many in own.plain.items() if len(many) == len(slanted[p])]:
        if not all(own.later[p] for p in lacking):
            return
        extend(problem, own, lacking)
    own.aside.update(slanted)
    own.plain.update({p: tuple(x for x in many if x.drag is None) for p, many in own.plain.items()})


def bring_back(own: Repertoire) -> None:
    """Offers all that was set aside, cheapest first."""
    own.plain.update({p: (*own.aside[p], *many) for p, many in own.plain.items() if p in own.aside})
    own.aside.clear()
