"""Why a patch has to be changed, and why a unit cannot fold, in a few words."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from foldfab.folding.basic import Option
from foldfab.folding.conflict import drag_alike, meet_across
from foldfab.folding.lanes import Lane
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import Prospects
from foldfab.folding.repertoire import Repertoire, pieces_met

NAMED = 3
"""How many things a reason names."""


def reasons_of(problem: Problem, own: Repertoire, found: Prospects, chosen: Mapping[str, Option]) -> dict[str, str]:
    """Why each changed patch had to be changed, one clause that follows what was done to it."""
    lanes = {p: _lane(found, p, o) for p, o in chosen.items()}
    instead = {p: _instead(found, p, o) for p, o in chosen.items()}
    kept = [x for x in lanes.values() if x is not None]
    across = meet_across(problem, own, [x for many in instead.values() for x in many], kept)
    reasons = {}
    for patch, option in chosen.items():
        if option.variant is not None and option.cost == 0.0:
            continue
        told = []
        if option.variant is None or option.window != (0, problem.options.shrink_steps):
            told.append(_narrowed(own, found, lanes, instead[patch], across, patch, option))
        if option.variant is not None and option.variant.hinges:
            told.append(_split(own, found, lanes, instead[patch], across, patch))
        reasons[patch] = "; ".join(dict.fromkeys(text for text in told if text))
    return reasons


def reason_against(problem: Problem, own: Repertoire, found: Prospects, why: list[str]) -> str:
    """Why a unit cannot fold, from what its surroundings leave and what its simulations have shown."""
    told = []
    for patch in own.unit.patches:
        many = found.lanes[patch]
        if not many:
            told.append(f"{patch} is too short or too steep for hinges at this scale, print larger or thinner")
        elif all(found.blocked[x.number].all() for x in many):
            met = sorted({name for x in many for name in found.obstacles[x.number]})
            told.append(
                f"{patch} has no room: whichever way it folds it meets {', '.join(met[:NAMED]) or 'its own unit'}"
            )
    told = told[:NAMED] or [text for text in why if "fall apart" not in text][:NAMED]
    return "; ".join(told or why[:1] or ["whatever its parts do, two of them meet"])


def _lane(found: Prospects, patch: str, option: Option) -> Lane | None:
    return next((x for x in found.lanes[patch] if x.variant == option.variant), None)


def _instead(found: Prospects, patch: str, option: Option) -> list[Lane]:
    """The lanes that would leave more of a patch: all where it is deleted, or those with fewer hinges."""
    most = option.variant.hinges if option.variant is not None else np.inf
    return [x for x in found.lanes[patch] if x.variant.hinges < most]


def _narrowed(
    own: Repertoire, found: Prospects, lanes: Mapping[str, Lane | None], instead: list[Lane],
    across: set[tuple[int, int]], patch: str, option: Option,
) -> str:  # fmt: skip
    """What the part of the patch that is gone would meet."""
    lane = lanes[patch]
    if lane is None:
        met = {name for x in instead for name in found.obstacles[x.number]}
        met |= _met_by(own, instead, lanes, across)
        return _because(met, "it would meet")
    gone = [s for s in range(len(lane.cuts) - 1) if not option.window[0] <= s < option.window[1]]
    folding = _conflicting(own, lane, lanes, gone)
    if folding:
        return _because(folding, "it would fold through")
    if found.blocked[lane.number][gone].any():
        return _because(set(found.obstacles[lane.number]), "it would meet")
    return "because there is no room for all of it"


def _split(
    own: Repertoire, found: Prospects, lanes: Mapping[str, Lane | None], fewer: list[Lane],
    across: set[tuple[int, int]], patch: str,
) -> str:  # fmt: skip
    """What it would meet in one piece, or with fewer hinges."""
    met = {name for x in fewer if found.blocked[x.number].any() for name in found.obstacles[x.number]}
    met |= _met_by(own, fewer, lanes, across)
    if met:
        return _because(met, "with fewer hinges it would meet")
    return _because(_not_along(own, patch), "it can slant only without") or "to come straight down"


def _not_along(own: Repertoire, patch: str) -> set[str]:
    """The patches that cannot slant the way of one whose slanted lanes were set aside."""
    ways = own.aside.get(patch, ())
    others = {p: any(drag_alike(x, y) for x in ways for y in many) for p, many in own.aside.items() if p != patch}
    return {p for p, goes in others.items() if not goes} if ways else set()


def _met_by(
    own: Repertoire, many: list[Lane], lanes: Mapping[str, Lane | None], across: set[tuple[int, int]]
) -> set[str]:  # fmt: skip
    """The patches whose lanes meet any of some lanes of another patch, whether or not they could go `across`."""
    numbers = {x.number for x in many}
    met = {own.lanes[b].patch for a, b in across if a in numbers}
    return met.union(*(_conflicting(own, x, lanes, range(len(x.cuts) - 1)) for x in many))


def _conflicting(own: Repertoire, lane: Lane, lanes: Mapping[str, Lane | None], pieces: range | list[int]) -> set[str]:
    """The patches whose lanes meet some pieces of a lane."""
    found = set()
    for patch, other in lanes.items():
        if other is None or patch == lane.patch:
            continue
        table = pieces_met(own.pieces, lane.number, other.number)
        if table is not None and table[list(pieces)].any():
            found.add(patch)
    return found


def _because(met: set[str], how: str) -> str:
    return f"because {how} {', '.join(sorted(met)[:NAMED])}" if met else ""
