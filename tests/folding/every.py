"""All that a unit can do, and not only what is cheapest."""

from __future__ import annotations

from foldfab.folding.conflict import compare
from foldfab.folding.congruent import repertoire
from foldfab.folding.interruption import touched
from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import Repertoire, extend, interrupt
from foldfab.folding.units import Unit


def whole(made: Problem, unit: Unit) -> Repertoire:
    """The repertoire of a unit with all lanes that are there, and hinges interrupted wherever that may help."""
    own = repertoire(made, unit)
    for patch in unit.patches:
        while own.later[patch]:
            extend(made, own, [patch])
    compare(made, own, [x for p in unit.patches for x in own.plain[p]])
    for x in touched(own):
        interrupt(made, own, x)
    return own
