"""Figure 7: the units of a scaffold are what the cycles of its hinge graph cluster; bridges go by basic scaffold."""

from __future__ import annotations

from foldfab.folding.units import decompose
from foldfab.recipe.model import Part

from .builder import scaffold, sheet

DEPTH = (0.0, 200.0)
STAIR = (
    sheet("ground", (0, 600), DEPTH, 0), sheet("low", (0, 250), DEPTH, 150), sheet("middle", (0, 600), DEPTH, 400),
    sheet("under", 20, DEPTH, (0, 150)), sheet("over", 20, DEPTH, (150, 400)), sheet("beside", 580, DEPTH, (0, 400)),
)  # fmt: skip
"""Three H-scaffolds in a ring, as the red unit of the figure and figure 3 c."""
CUPBOARD = (
    sheet("roof", (0, 300), DEPTH, 600),
    sheet("side-1", 20, DEPTH, (400, 600)), sheet("side-2", 280, DEPTH, (400, 600)),
)  # fmt: skip
"""Two H-scaffolds that share both bases, on top of the ring."""
TRAY = (sheet("tray", (400, 600), DEPTH, 550), sheet("post", 500, DEPTH, (400, 550)))
FLAP = sheet("flap", 350, DEPTH, (400, 500))


def units(*parts: Part) -> set[frozenset[str]]:
    return {frozenset(unit.patches) for unit in decompose(scaffold(*parts))}


def test_figure_07_cycles_that_share_a_hinge_are_one_unit_and_those_that_share_a_base_are_not() -> None:
    ring, cupboard = frozenset({"under", "over", "beside"}), frozenset({"side-1", "side-2"})
    found = units(*STAIR, *CUPBOARD, *TRAY, FLAP)
    assert found == {ring, cupboard, frozenset({"post"}), frozenset({"flap"})}


def test_figure_07_every_hinge_belongs_to_one_unit() -> None:
    """Six H-scaffolds have two hinges and a T-scaffold one: a bridge's two hinges stay together."""
    made = scaffold(*STAIR, *CUPBOARD, *TRAY, FLAP)
    hinges = [(p, base) for unit in decompose(made) for p in unit.patches for base in made.patch(p).bases]
    assert len(hinges) == len(set(hinges)) == 2 * 6 + 1
    assert all(set(made.patch(p).bases) <= set(u.bases) for u in decompose(made) for p in u.patches)


def test_figure_07_what_is_on_no_cycle_any_more_falls_apart() -> None:
    """Without `beside`, the ring is a chain of bridges; with a second wall, two of its scaffolds are a cycle again."""
    *open_ring, _ = STAIR
    assert units(*open_ring) == {frozenset({"under"}), frozenset({"over"})}
    second = sheet("second", 200, DEPTH, (0, 150))
    assert units(*open_ring, second) == {frozenset({"under", "second"}), frozenset({"over"})}
