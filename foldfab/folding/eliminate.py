"""The MWISP of section 5.4 by elimination of one patch after another, for conflict graphs that hang together loosely.

A table says for each combination of options of a few patches what those eliminated so far cost at least. The patch
whose elimination makes the smallest table goes next. Linear in the patches where they conflict with few neighbours
each, like the cells of a honeycomb; exponential in the width of the graph: it gives up where a table gets large.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from foldfab.geometry.arrays import Array, Bools, Indices

LARGEST = 30_000
"""Entries of a table beyond which nothing is eliminated."""

Factor = tuple[tuple[int, ...], Array]
"""Groups, and by their options what is to be paid; infinite where they exclude each other."""


def eliminated(alive: Mapping[int, Bools], costs: list[Array], table: list[dict[int, Bools]]) -> dict[int, int] | None:
    """The cheapest option for each group, or None where the graph is too wide or nothing is free of conflicts.

    Args:
        alive: by group, which of its options (n,) may be taken.
        costs: for each group, the costs (n,) of its options.
        table: for each group, by other group, which of their options (n, m) exclude each other.
    """
    kept = {g: np.nonzero(left)[0] for g, left in alive.items()}
    factors: list[Factor] = [((g,), costs[g][own]) for g, own in kept.items()]
    for g, own in kept.items():
        for h, excluded in table[g].items():
            if g < h and h in kept and excluded[np.ix_(own, kept[h])].any():
                factors.append(((g, h), np.where(excluded[np.ix_(own, kept[h])], np.inf, 0.0)))
    size = {g: len(own) for g, own in kept.items()}
    steps: list[tuple[int, tuple[int, ...], Indices]] = []
    rest = set(kept)
    while rest:
        group, scope = min(((g, _scope(factors, g)) for g in sorted(rest)), key=lambda f: _entries(f[1], size))
        if _entries(scope, size) * size[group] > LARGEST:
            return None
        joint = _sum([f for f in factors if group in f[0]], (*scope, group), size)
        steps.append((group, scope, joint.argmin(axis=-1)))
        factors = [f for f in factors if group not in f[0]] + [(scope, joint.min(axis=-1))]
        rest.discard(group)
    if not np.isfinite(sum(float(values) for scope, values in factors if not scope)):
        return None
    taken: dict[int, int] = {}
    for group, scope, best in reversed(steps):
        taken[group] = int(best[tuple(taken[g] for g in scope)])
    return {g: int(kept[g][i]) for g, i in taken.items()}


def _scope(factors: list[Factor], group: int) -> tuple[int, ...]:
    """The other groups that share a table with one."""
    return tuple(sorted({g for scope, _ in factors if group in scope for g in scope} - {group}))


def _entries(scope: tuple[int, ...], size: Mapping[int, int]) -> int:
    return math.prod(size[g] for g in scope)


def _sum(factors: list[Factor], scope: tuple[int, ...], size: Mapping[int, int]) -> Array:
    """The sum of tables over all groups of a scope."""
    total = np.zeros([size[g] for g in scope])
    for own, values in factors:
        order = [own.index(g) for g in scope if g in own]
        shape = [size[g] if g in own else 1 for g in scope]
        total = total + values.transpose(order).reshape(shape)
    return total
