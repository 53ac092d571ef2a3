"""How the solver scales on the composites of section 6 (Figure 20); a report for people, never a test.

python benchmarks/scaling_benchmark.py [--largest 32] [--kinds bench building hexagon shelf] [--budget SECONDS]

units, patches   of the scaffold (Table 1)
abstract, solve  process time of either, and both together, ms; the furniture is made before
cost, bound      eq. 1, and what any solution costs at least

Last, the exponent b of time ~ patches^b by least squares of the logarithms, over all sizes and those from 4 x 4 on.
A size that would take longer than the budget, going by the two before it, is left out, and with it all larger ones.
"""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import dataclass

import numpy as np
from measuring import Column, Table, forget, ready, timed, told

from foldfab.folding.solve import solve
from foldfab.folding.units import decompose
from foldfab.pipeline import compose
from foldfab.recipe.compose import KINDS
from foldfab.recipe.edit import override
from foldfab.scaffold.abstract import abstract

SIZES = (1, 2, 4, 8, 16, 32)
"""Columns and rows of the grids."""
LARGE = 4
"""From this size on what every solve takes at least no longer counts."""
QUADRATIC = 2.0
"""The exponent in patches that is feared where two sizes are not yet known: that of the paper's greedy order."""
TABLE = Table(
    (
        Column("composite", 14), Column("units", 5), Column("patches", 7), Column("abstract", 8, ".0f"),
        Column("solve", 8, ".0f"), Column("in all", 8, ".0f"), Column("cost", 7, ".4f"), Column("bound", 7, ".4f"),
    )
)  # fmt: skip


@dataclass(frozen=True)
class Point:
    """One size of one kind."""

    size: int
    patches: int
    ms: float


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--largest", type=int, default=SIZES[-1], metavar="N", help="columns and rows at most (32)")
    parser.add_argument("--kinds", nargs="+", choices=sorted(KINDS), default=sorted(KINDS), metavar="KIND")
    parser.add_argument("--budget", type=float, default=120.0, metavar="SECONDS", help="for one size (120)")
    parser.add_argument("--ordering", choices=("greedy", "optimal"), default="greedy")
    arguments = parser.parse_args()
    ready()
    TABLE.head()
    measured = {kind: grown(kind, arguments) for kind in arguments.kinds}
    print(f"\n{'time ~ patches^b':<16}  {'b':>5}  {f'from {LARGE}x{LARGE}':>8}")
    for kind, points in measured.items():
        large = [point for point in points if point.size >= LARGE]
        print(f"{kind:<16}  {exponent(points):>5}  {exponent(large):>8}")
    return 0


def grown(kind: str, arguments: argparse.Namespace) -> list[Point]:
    """Measures a kind of furniture in larger and larger grids, and prints each as it is done."""
    points: list[Point] = []
    for size in (size for size in SIZES if size <= arguments.largest):
        name = f"{kind}-{size}x{size}"
        expected = forecast(points, size)
        if expected > 1000 * arguments.budget:
            print(f"{name:<14}  left out: about {expected / 1000:.0f} s, over the budget of {arguments.budget:g} s")
            break
        point = measure(kind, size, arguments.ordering, name)
        if point is None:
            break
        points.append(point)
    return points


def measure(kind: str, size: int, ordering: str, name: str) -> Point | None:
    """One row; None where the composite does not fold."""
    recipe = override(compose(kind, f"{size}x{size}"), ordering=ordering)
    forget()
    scaffold, abstracting = timed(lambda: abstract(recipe, recipe.direction, recipe.print.scale))
    if isinstance(scaffold, Exception):
        TABLE.row(name, None, None, abstracting, note=told(scaffold))
        return None
    units, patches = len(decompose(scaffold)), len(scaffold.patches)
    solution, solving = timed(lambda: solve(scaffold))
    both = abstracting + solving
    if isinstance(solution, Exception):
        TABLE.row(name, units, patches, abstracting, solving, both, note=told(solution))
        return None
    TABLE.row(name, units, patches, abstracting, solving, both, float(solution.cost), float(solution.lower_bound))
    return Point(size, patches, both)


def forecast(points: list[Point], size: int) -> float:
    """What a size is expected to take, ms: patches grow like cells, and time as between the last two sizes."""
    if not points:
        return 0.0
    growth = QUADRATIC
    if len(points) > 1:
        before, last = points[-2:]
        growth = max(1.0, math.log(last.ms / before.ms) / math.log(last.patches / before.patches))
    return points[-1].ms * (size / points[-1].size) ** (2 * growth)


def exponent(points: list[Point]) -> str:
    """How time grows with patches; nothing where there is no growth to see."""
    if len(points) < 2:
        return "-"
    patches, ms = np.log([(point.patches, point.ms) for point in points]).T
    return f"{np.polyfit(patches, ms, 1)[0]:.2f}"


if __name__ == "__main__":
    sys.exit(main())
