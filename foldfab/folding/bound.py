"""A lower bound on the cost of any folding solution.

Each unit is relaxed to the choice of one whole-patch variant or deletion for each of its patches, where the only
conflicts left are those that no order, window or plinth can lift: two chains between the same bases that drag them
different ways (condition ii of section 5.2). The cheapest such choices add up to a bound, because terms of eq. 1 are
never shared by units. At least the sum of each patch's cheapest option.
"""

from __future__ import annotations

import itertools

import numpy as np

from foldfab.folding import basic
from foldfab.folding.basic import Variant
from foldfab.folding.candidates import Problem, is_slantable, variants
from foldfab.folding.choose import cheapest
from foldfab.folding.conflict import go_the_same_way
from foldfab.folding.model import Chain
from foldfab.folding.site import Site
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array, Bools


def lower_bound(problem: Problem, units: tuple[Unit, ...]) -> float:
    """No folding solution over the options of the problem is cheaper than this."""
    return float(sum(_relaxed(problem, unit) for unit in units))


def _relaxed(problem: Problem, unit: Unit) -> float:
    sites = [problem.sites[p] for p in unit.patches]
    forms = [variants(problem, site, may_slant=is_slantable(problem, unit)) for site in sites]
    costs = [_prices(problem, site, many) for site, many in zip(sites, forms, strict=True)]
    chains = [[_chain(problem, site, v) for v in many] for site, many in zip(sites, forms, strict=True)]
    table = {(g, h): _apart(chains[g], chains[h]) for g, h in itertools.combinations(range(len(sites)), 2)}
    picked = cheapest(costs, table)
    # Deleting every patch is always free of conflicts, so there is a choice.
    return sum(float(costs[g][i]) for g, i in enumerate(picked or ()))


def _prices(problem: Problem, site: Site, many: tuple[Variant, ...]) -> Array:
    """Costs of the variants of a whole patch, and of its deletion."""
    kept = [basic.cost(v.hinges, 1.0, problem.options) for v in many]
    return site.importance * np.array([*kept, basic.cost(0, 0.0, problem.options)])


def _chain(problem: Problem, site: Site, variant: Variant) -> Chain | None:
    steps = problem.options.shrink_steps
    span = basic.window_span(site, (0, steps), steps, problem.thickness)
    return basic.chain(site, variant, span, problem.thickness) if span is not None else None


def _apart(first: list[Chain | None], second: list[Chain | None]) -> Bools:
    """Which variants (n + 1, m + 1) of two patches exclude each other; deletion excludes nothing."""
    table = np.zeros((len(first) + 1, len(second) + 1), dtype=bool)
    for (i, a), (j, b) in itertools.product(enumerate(first), enumerate(second)):
        table[i, j] = a is not None and b is not None and not go_the_same_way(a, b)
    return table
