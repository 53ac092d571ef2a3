"""What is asked of a fold has to be possible: pinned and forbidden modifications, parts that must not be split.

Each check says at once which parts ask for too much, before any order is looked for.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np

from foldfab.errors import FoldingError
from foldfab.folding.aside import bring_back
from foldfab.folding.conflict import snap_alike
from foldfab.folding.congruent import repertoire
from foldfab.folding.options import Options, options_of
from foldfab.folding.problem import Problem, demanding
from foldfab.folding.prospects import unhindered
from foldfab.folding.repertoire import extend
from foldfab.folding.soundness import hangs_together
from foldfab.folding.unit_fold import Choice
from foldfab.folding.units import Unit


def require_variants(problem: Problem) -> None:
    """Patches without any option of their own have to go; where the furniture needs them, say so at once."""
    lost = [p for unit in problem.units for p in unit.patches if not repertoire(problem, unit).plain[p]]
    if not lost or hangs_together(problem.scaffold, set(lost)):
        return
    rigid = [p for p in lost if not problem.sites[p].patch.hingeable and problem.sites[p].far is not None]
    if rigid:
        raise FoldingError(
            f"{', '.join(rigid[:4])} must not be split, cannot slant here and cannot be disconnected without cutting "
            "the furniture in two; allow slanting or a hinge"
        )
    told = [f"{p} ({problem.sites[p].clear:.1f} mm high)" for p in lost[:4]]
    raise FoldingError(
        f"at scale 1:{1 / problem.scaffold.scale:.3g} {', '.join(told)} cannot carry hinges, and without them the "
        f"furniture falls apart; print larger or with plates thinner than {problem.thickness.panel:g} mm"
    )


def require_allowed(problem: Problem) -> None:
    """What the recipe pins or forbids has to leave every patch something that it can do."""
    for unit in problem.units:
        asked = [p for p in unit.patches if demanding(problem, p)]
        own = repertoire(problem, unit)
        if asked:
            bring_back(own)
        for patch in asked:
            while own.later[patch]:
                extend(problem, own, [patch])
        options = options_of(problem, unhindered(problem, own), np.zeros(3)) if asked else {}
        for patch in asked:
            if not np.isfinite(options[patch].weight).any():
                names = ", ".join(part.name for part in demanding(problem, patch))
                able = sorted({(x.variant.mechanism, x.variant.hinges) for x in own.plain[patch] if not x.is_out})
                told = ", ".join(
                    f"{how} with {count} hinge{'s' * (count > 1)}" if count else how for how, count in able
                )
                raise FoldingError(
                    f"what is pinned or forbidden for {names} leaves {patch} nothing that it can do; "
                    f"it can fold {told or 'not at all'}, or be narrowed or deleted where that is not ruled out"
                )


def require_choices(problem: Problem, choices: Mapping[str, Choice]) -> None:
    """Where a unit is left no choice at all, what was asked of its parts cannot be had together."""
    for unit in problem.units:
        asked = sorted({part.name for p in unit.patches for part in demanding(problem, p)})
        if asked and not np.isfinite(choices[unit.name].weight):
            raise FoldingError(
                f"what is pinned or forbidden for {', '.join(asked)} cannot be had together: they fold in one unit, "
                f"and whatever they may do, two of them exclude each other{_unlike(problem, unit)}"
            )


def _unlike(problem: Problem, unit: Unit) -> str:
    """The accordions of a unit that snap too differently to be covered by the play in their hinges, as a clause."""
    own = repertoire(problem, unit)
    options = options_of(problem, unhindered(problem, own), np.zeros(3))
    lanes = {p: [x for k, x in enumerate(o.lanes) if _is_open(o, k)] for p, o in options.items()}
    for p, q in itertools.combinations(unit.patches, 2):
        pairs = [(a, b) for a in lanes[p] for b in lanes[q]]
        if pairs and not any(snap_alike(problem, own, a, b) for a, b in pairs):
            a, b = min(pairs, key=lambda pair: abs(pair[0].snap - pair[1].snap) - pair[0].give - pair[1].give)
            return (
                f": {p} snaps by {a.snap:.2f} mm and {q} by {b.snap:.2f}, and their play covers {a.give + b.give:.2f}, "
                "be they thicker, on pads or in pockets"
            )
    return ""


def _is_open(options: Options, lane: int) -> bool:
    """Whether any window of a lane is not out of the question."""
    count = len(options.windows)
    return bool(np.isfinite(options.weight[lane * count : (lane + 1) * count]).any())
