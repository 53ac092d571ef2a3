"""Figure 16: a box with a back and two sides, open in front, whose back must not get a hinge."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

from .builder import changes, sheet, shrunk

Fold = Callable[..., FoldSolution]
Size = tuple[float, float, float]
SIZES: dict[str, Size] = {
    "wide": (600, 400, 300), "narrow": (400, 300, 300), "cube": (400, 400, 400), "square": (400, 400, 300)
}  # fmt: skip
"""Width, depth and height, mm: in each of them the back fits onto the ground between the sides."""


def box(size: Size, *, back: bool) -> tuple[Part, ...]:
    """`back` says whether the back may get a hinge."""
    (width, depth, height), (x, y, z) = size, ((0, side) for side in size)
    return (
        sheet("ground", x, y, 0), sheet("ceiling", x, y, height),
        sheet("left", 0, y, z), sheet("right", width, y, z), sheet("back", x, depth, z, hingeable=back),
    )  # fmt: skip


def hinges(solution: FoldSolution) -> int:
    """Interior hinges in all."""
    return sum(m.hinges for m in solution.modifications)


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES)
def test_figure_16_in_place_the_back_is_disconnected_and_the_sides_get_a_hinge_each(fold: Fold, size: Size) -> None:
    made = fold(*box(size, back=False), slanting=False)
    held = {c.patch for c in made.chains if c.far is not None}
    assert held == {"left", "right"}, "the back holds on to one base only"
    assert changes(made)["back"].mechanism == "slanted"
    assert {changes(made)[side].hinges for side in held} == {1} and hinges(made) == 2
    assert shrunk(made) == set()


@pytest.mark.parametrize(
    "size",
    list(SIZES.values()),
    ids=SIZES,
)
def test_figure_16_with_slanting_there_are_no_interior_hinges(fold: Fold, size: Size) -> None:
    made = fold(*box(size, back=False))
    assert hinges(made) == 0 and {m.mechanism for m in made.modifications} == {"slanted"}
    assert shrunk(made) == set() and made.cost == 0.0


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES)
def test_figure_16_all_hingeable_and_in_place_it_takes_three_hinges_and_shrinking(fold: Fold, size: Size) -> None:
    made = fold(*box(size, back=True), slanting=False)
    assert {m.hinges for m in made.modifications} == {1} and hinges(made) == 3
    assert shrunk(made) and not any(m.is_deleted for m in made.modifications)
    assert len(made.steps) == 1 and all(c.far is not None for c in made.chains)


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES)
def test_figure_16_enforcing_soundness_spares_hinges_and_shrinking(fold: Fold, size: Size) -> None:
    """Slanting and disconnections cost nothing."""
    sound, free = (fold(*box(size, back=back), slanting=False) for back in (False, True))
    assert sound.cost < free.cost and hinges(sound) < hinges(free)


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES)
def test_figure_16_a_hingeable_back_would_have_to_be_deleted_for_the_sides_to_slant(fold: Fold, size: Size) -> None:
    """What may be split is not disconnected, and a back that stands across the sides cannot slant with them."""
    made = changes(fold(*box(size, back=True)))
    slants = {made[side].mechanism == "slanted" for side in ("left", "right")}
    assert slants == {made["back"].is_deleted}
