"""The k best distinct solutions: each is the optimum once the modifications of those before it are excluded.

Two solutions are distinct where the mechanism or the number of hinges of some patch differs, or where its window holds
something that the other's does not: the same with less left of it is no alternative. To which side something folds,
and in which order, makes no other furniture.
"""

from __future__ import annotations

from foldfab.folding.model import FoldSolution, Thickness
from foldfab.folding.optimum import other
from foldfab.folding.options import DELETION
from foldfab.folding.ordering import floors
from foldfab.folding.problem import Problem, kept_clear
from foldfab.folding.rehearsal import first_clash
from foldfab.folding.scene import open_scene
from foldfab.folding.solve import posed, solution, solve
from foldfab.folding.symmetry import Signature
from foldfab.folding.trespass import trespasses
from foldfab.scaffold.model import Scaffold

FIRST_STEP = 0.05
"""How much dearer than the one before a solution is looked for at first, eq. 1."""
STEPS = 5
"""How often that is tripled before there counts to be no other."""


def alternatives(scaffold: Scaffold, count: int) -> tuple[FoldSolution, ...]:
    """The best `count` distinct solutions, or as many as were found, best first.

    Raises:
        FoldingError: there is not even one.
    """
    found = [solve(scaffold)]
    thickness = Thickness.of_print(scaffold.recipe.print)
    problem = posed(found[0].scaffold, thickness)
    excluded = [_signatures(problem, found[0])]
    while len(found) < count:
        following = _following(problem, found[-1], excluded)
        if following is None:
            break
        found.append(following)
    return tuple(found)


def _following(problem: Problem, last: FoldSolution, excluded: list[dict[str, Signature]]) -> FoldSolution | None:
    """The best solution that is not excluded yet; it is excluded from then on."""
    scene, step, tries = open_scene(problem), FIRST_STEP, 0
    while tries < STEPS:
        floor = {name: choice.weight for name, choice in floors(problem).items()}
        most = _weight(last) + step
        ordered, bound = other(problem, scene, floor, tuple(excluded), most, problem.options.time_limit)
        if ordered is None:
            step, tries = 3 * step, tries + 1
            continue
        crossed = trespasses(problem, ordered.folds)
        if crossed:
            problem = kept_clear(problem, crossed)
            scene = open_scene(problem)
            continue
        found = solution(problem, bound, ordered)
        excluded.append(_signatures(problem, found))
        if first_clash(problem, scene, ordered.folds) is None:
            return found
    return None


def _signatures(problem: Problem, found: FoldSolution) -> dict[str, Signature]:
    steps = problem.options.shrink_steps
    return {
        m.patch: ("deleted", 0, (0, 0))
        if m.is_deleted
        else (m.mechanism, m.hinges, (round(m.window[0] * steps), round(m.window[1] * steps)))
        for m in found.modifications
    }


def _weight(found: FoldSolution) -> float:
    return sum(m.cost + DELETION * m.is_deleted for m in found.modifications)
