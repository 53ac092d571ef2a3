"""Figure 13: the conflict graph of a unit of three patches, and the maximum independent set that is its solution."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import networkx as nx
import pytest

from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

from .builder import sheet

Fold = Callable[..., FoldSolution]
ALPHA, MAX_HINGES = 0.5, 3
SIZES = [(600.0, 400.0, 300.0), (640.0, 500.0, 300.0), (500.0, 500.0, 280.0), (420.0, 300.0, 320.0)]
Rectangle = tuple[float, float, float, float]
"""x0, x1, y0, y1, mm."""


@dataclass(frozen=True)
class Node:
    """A folding solution of a basic scaffold, as section 5.3 lists them: hinges and a window, or deletion."""

    patch: str
    hinges: int
    window: tuple[float, float]
    region: Rectangle
    cost: float


def box(width: float, depth: float, height: float) -> tuple[Part, ...]:
    """Three walls between two bases, open in front."""
    x, y, z = (0, width), (0, depth), (0, height)
    return (
        sheet("ground", x, y, 0), sheet("ceiling", x, y, height),
        sheet("left", 0, y, z), sheet("right", width, y, z), sheet("back", x, depth, z),
    )  # fmt: skip


def nodes(width: float, depth: float, height: float, steps: int) -> list[Node]:
    """All in-place solutions that stay within the box, with the paper's folding regions and costs."""
    found = []
    long = {"left": depth, "right": depth, "back": width}
    for patch, hinges, (a, b) in itertools.product(long, (1, 3), itertools.combinations(range(steps + 1), 2)):
        share = long[patch] / sum(long.values())
        price = share * (ALPHA * hinges / MAX_HINGES + (1 - ALPHA) * (1 - (b - a) / steps) ** 2)
        deep, low, high = height / (hinges + 1), long[patch] * a / steps, long[patch] * b / steps
        regions = {
            "left": (0.0, deep, low, high), "right": (width - deep, width, low, high),
            "back": (low, high, depth - deep, depth),
        }  # fmt: skip
        found.append(Node(patch, hinges, (a / steps, b / steps), regions[patch], price))
    deleted = [Node(p, 0, (0, 0), (0, 0, 0, 0), (1 - ALPHA) * n / sum(long.values())) for p, n in long.items()]
    return found + deleted


def conflict(a: Node, b: Node) -> bool:
    """Definition 5, for patches that fold at the same time."""
    (ax, bx, ay, by), (cx, dx, cy, dy) = a.region, b.region
    return a.patch == b.patch or (max(ax, cx) < min(bx, dx) and max(ay, cy) < min(by, dy))


def conflict_graph(many: list[Node]) -> nx.Graph[int]:
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(len(many)))
    graph.add_edges_from((i, j) for i, j in itertools.combinations(range(len(many)), 2) if conflict(many[i], many[j]))
    return graph


def independent_set(many: list[Node]) -> list[Node]:
    """The MWISP of section 5.4, to the letter: weights max cost - cost + 1, as integers."""
    graph, most = nx.complement(conflict_graph(many)), max(n.cost for n in many)
    for i, node in enumerate(many):
        graph.nodes[i]["weight"] = round(1e9 * (most - node.cost + 1))
    clique, _ = nx.max_weight_clique(graph)
    return [many[i] for i in clique]


def by_brute_force(many: list[Node]) -> float:
    """The cheapest of all choices of one node for each patch that are free of conflicts."""
    groups = [[n for n in many if n.patch == p] for p in ("left", "right", "back")]
    return min(
        sum(n.cost for n in choice)
        for choice in itertools.product(*groups)
        if not any(conflict(a, b) for a, b in itertools.combinations(choice, 2))
    )


def test_figure_13_the_maximum_independent_set_takes_one_option_of_each_patch() -> None:
    many = nodes(*SIZES[0], steps=3)
    chosen = independent_set(many)
    assert sorted(n.patch for n in chosen) == ["back", "left", "right"]
    assert sum(n.cost for n in chosen) == pytest.approx(by_brute_force(many))


@pytest.mark.parametrize("steps", [2, 3, 5])
@pytest.mark.parametrize("size", SIZES)
def test_figure_13_the_unit_is_solved_as_cheaply_as_the_brute_force_over_the_figure(
    fold: Fold, size: tuple[float, float, float], steps: int
) -> None:
    """Deletions aside, which foldfab takes only where nothing else is left (DESIGN.md)."""
    kept = [n for n in nodes(*size, steps=steps) if n.hinges]
    made = fold(*box(*size), slanting=False, stay_in_box=True, shrink_steps=steps)
    assert len(made.steps) == 1
    assert made.cost == pytest.approx(by_brute_force(kept))


def test_figure_13_each_wall_alone_would_be_whole_and_together_they_are_not(fold: Fold) -> None:
    ground, ceiling, *three = box(*SIZES[0])
    for wall in three:
        assert fold(ground, ceiling, wall, slanting=False, stay_in_box=True).cost == pytest.approx(ALPHA / 3)
    assert fold(ground, ceiling, *three, slanting=False, stay_in_box=True).cost > ALPHA / 3
