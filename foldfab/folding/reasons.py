"""Why a patch has to be changed, in a few words."""

from __future__ import annotations

from collections.abc import Mapping

from foldfab.folding.basic import Option
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import Prospects


def reasons_of(problem: Problem, found: Prospects, chosen: Mapping[str, Option]) -> dict[str, str]:
    """Why each changed patch had to be changed: what its whole, unsplit self would meet."""
    reasons = {}
    for patch, option in chosen.items():
        if option.variant is not None and option.cost == 0.0:
            continue
        obstacles = {
            name
            for x in found.lanes[patch]
            if option.variant is None
            or (x.variant.hinges, x.variant.side) == (option.variant.hinges, option.variant.side)
            for name in found.obstacles[x.number]
        }
        if obstacles:
            reasons[patch] = "because of " + ", ".join(sorted(obstacles)[:3])
        elif option.variant is None or option.window != (0, problem.options.shrink_steps):
            others = sorted(p for p in chosen if p != patch and chosen[p].variant is not None)
            reasons[patch] = "to let " + ", ".join(others[:3]) + " fold through it" if others else ""
        else:
            reasons[patch] = "to come straight down"
    return reasons
