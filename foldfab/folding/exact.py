"""The MWISP of section 5.4 by constraint programming, for units that are too tangled for plain branch and bound.

One Boolean for each option, exactly one true in each group; an option and all options of another group that it
excludes are at most one. CP-SAT runs with one worker, a fixed seed and a limit in work and not in time, so that the
same unit always gets the same answer.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from foldfab.folding.work import ENGINE, STARTING
from foldfab.geometry.arrays import Array, Bools, Indices

UNITS_PER_COST = 1e8
"""Costs are rounded to integers of this resolution."""
WORK = 1.0
"""Deterministic time after which the best choice so far is taken."""


def proven(
    alive: Mapping[int, Bools], costs: list[Array], table: list[dict[int, Bools]],
    forbidden: list[tuple[tuple[int, tuple[int, ...]], ...]], known: Mapping[int, int] | None, limit: float = WORK,
) -> tuple[dict[int, int] | None, float, float]:  # fmt: skip
    """The cheapest option for each group, or None where there is no choice without conflicts; by how much it may be
    dearer than the cheapest where the work did not suffice to tell, infinite where it found none; and the charge, s.

    Args:
        alive: by group, which of its options (n,) may be taken.
        costs: for each group, the costs (n,) of its options.
        table: for each group, by other group, which of their options (n_g, n_h) exclude each other.
        forbidden: groups that must not all take one of some options of theirs.
        known: the best choice known, to start from.
        limit: deterministic time after which the best choice so far is taken.
    """
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    options = {g: np.nonzero(left)[0].tolist() for g, left in alive.items()}
    on = {(g, o): model.new_bool_var(f"{g}/{o}") for g, own in options.items() for o in own}
    for g, own in options.items():
        model.add_exactly_one(on[g, o] for o in own)
    _exclude(model, {g: np.array([on[g, o].index for o in own]) for g, own in options.items()}, options, table)
    for combination in forbidden:
        taken = [sum(on[g, o] for o in options if (g, o) in on) for g, options in combination]
        model.add(sum(taken) <= len(taken) - 1)
    prices = [round(float(costs[g][o]) * UNITS_PER_COST) for g, o in on]
    model.minimize(cp_model.LinearExpr.weighted_sum(list(on.values()), prices))
    for key in (known or {}).items():
        model.add_hint(on[key], True)
    return (*_solved(model, solver := _engine(limit), on, costs, known), _charge(solver))


def _exclude(
    model: Any, number: Mapping[int, Indices], options: Mapping[int, list[int]], table: list[dict[int, Bools]]
) -> None:  # fmt: skip
    """Says which options of different groups exclude each other; `number` (n,) are their variables.

    Straight to the program: through the door for single constraints this would take longer than to solve it.
    """
    constraints = model.proto.constraints
    for g, own in options.items():
        for h in sorted(h for h in table[g] if g < h and h in options):
            excluded = table[g][h][np.ix_(own, options[h])]
            for first, row in zip(number[g].tolist(), excluded, strict=True):
                others = number[h][row].tolist()
                if others:
                    constraints.add().at_most_one.literals.extend([first, *others])


def _engine(limit: float) -> Any:
    from ortools.sat.python import cp_model

    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 0
    # What presolve finds in thousands of options that exclude each other takes longer than all the rest; the relaxation
    # is what helps.
    solver.parameters.cp_model_presolve = False
    solver.parameters.linearization_level = 2
    solver.parameters.max_deterministic_time = limit
    return solver


def _charge(solver: Any) -> float:
    return STARTING + ENGINE * float(solver.response_proto.deterministic_time)


def _solved(
    model: Any, solver: Any, on: Mapping[tuple[int, int], Any], costs: list[Array], known: Mapping[int, int] | None
) -> tuple[dict[int, int] | None, float]:
    from ortools.sat.python import cp_model

    status = solver.solve(model)
    if status == cp_model.INFEASIBLE:
        return None, 0.0
    bound = float(solver.best_objective_bound) / UNITS_PER_COST
    best = {key[0]: key[1] for key, var in on.items() if solver.value(var)} if status != cp_model.UNKNOWN else known
    if best is None:
        return None, np.inf
    spent = sum(float(costs[g][o]) for g, o in best.items())
    return dict(best), 0.0 if status == cp_model.OPTIMAL else max(spent - bound, 0.0)
