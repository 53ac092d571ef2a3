"""All that a unit can do, and not only what is cheapest."""

from __future__ import annotations

from foldfab.folding.aside import bring_back
from foldfab.folding.congruent import repertoire
from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import Repertoire, extend
from foldfab.folding.units import Unit


def whole(made: Problem, unit: Unit) -> Repertoire:
    """The repertoire of a unit with all lanes that are there."""
    own = repertoire(made, unit)
    bring_back(own)
    for patch in unit.patches:
        while own.later[patch]:
            extend(made, own, [patch])
    return own
