"""What the recipe pins or forbids of a part holds in the solution, in either ordering, or the error names it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from foldfab.errors import FoldingError
from foldfab.folding.model import FoldSolution, Modification
from foldfab.recipe.model import Part, Pattern
from foldfab.validity.verify import violations

Solve = Callable[..., FoldSolution]
Parts = tuple[Part, ...]
BOTH = pytest.mark.parametrize("ordering", ["greedy", "optimal"])


def pinned(parts: Parts, **pins: Pattern) -> Parts:
    return tuple(replace(p, pin=pins.get(p.name, p.pin)) for p in parts)


def forbidden(parts: Parts, name: str, *forbid: Pattern) -> Parts:
    return tuple(replace(p, forbid=forbid) if p.name == name else p for p in parts)


def is_like(m: Modification, pattern: Pattern) -> bool:
    """Whether a modification is one that the pattern asks for."""
    asked = {name: getattr(pattern, name) for name in Pattern.__slots__}
    return all(said is None or getattr(m, name) == said for name, said in asked.items())


@BOTH
@pytest.mark.parametrize(
    "pin",
    [
        Pattern(hinges=3), Pattern(mechanism="in-place"), Pattern(side="l"), Pattern(side="r"),
        Pattern(window=(0.2, 0.6)), Pattern(mechanism="slanted"), Pattern(mechanism="in-place", hinges=1, side="r"),
    ],
)  # fmt: skip
def test_a_pin_is_kept_at_its_price(solution: Solve, furniture: dict[str, Parts], pin: Pattern, ordering: str) -> None:
    for name, part in (("shelf", "a"), ("box_with_table", "leg-left")):
        made = solution(pinned(furniture[name], **{part: pin}), ordering=ordering)
        assert is_like(made.modification(part), pin)
        assert made.cost >= solution(name, ordering=ordering).cost - 1e-9
        assert violations(made) == ()


@BOTH
def test_a_deletion_that_is_pinned_is_made_and_no_other(
    solution: Solve, furniture: dict[str, Parts], ordering: str
) -> None:
    made = solution(pinned(furniture["shelf"], b=Pattern(mechanism="deleted")), ordering=ordering)
    assert [m.patch for m in made.modifications if m.is_deleted] == ["b"]


@BOTH
def test_what_the_best_fold_does_can_be_forbidden(solution: Solve, furniture: dict[str, Parts], ordering: str) -> None:
    """Ruled out one after another, the modifications of a wall get dearer until nothing is left."""
    forbid: tuple[Pattern, ...] = (Pattern(mechanism="deleted"),)
    costs = []
    for _ in range(3):
        made = solution(forbidden(furniture["h_scaffold"], "leg", *forbid), ordering=ordering, max_hinges=3)
        m = made.modification("leg")
        assert not any(is_like(m, pattern) for pattern in forbid)
        costs.append(made.cost)
        forbid = (*forbid, Pattern(mechanism=m.mechanism, hinges=m.hinges))
    assert costs == sorted(costs) and costs[0] < costs[1] < costs[2]
    with pytest.raises(FoldingError, match="pinned or forbidden for leg leaves leg nothing"):
        solution(forbidden(furniture["h_scaffold"], "leg", *forbid), ordering=ordering, max_hinges=3)


@BOTH
@pytest.mark.parametrize(
    "pin", [Pattern(hinges=5), Pattern(mechanism="slanted", hinges=1), Pattern(window=(0.0, 0.1)), Pattern(hinges=2)]
)
def test_a_pin_that_leaves_nothing_is_named_with_what_the_part_can_do(
    solution: Solve, furniture: dict[str, Parts], pin: Pattern, ordering: str
) -> None:
    with pytest.raises(FoldingError) as caught:
        solution(pinned(furniture["box_with_table"], left=pin), ordering=ordering)
    told = str(caught.value)
    assert "pinned or forbidden for left leaves left nothing" in told
    assert "slanted" in told and "in-place with 1 hinge" in told


def test_what_cannot_be_done_is_not_told_as_something_that_can(solution: Solve, furniture: dict[str, Parts]) -> None:
    """The back of the deep box sticks out of it with one hinge: that is why it cannot be pinned to it."""
    with pytest.raises(FoldingError) as caught:
        solution(pinned(furniture["deep_box"], back=Pattern(mechanism="in-place", hinges=1)))
    assert "it can fold in-place with 1 hinge," not in str(caught.value)


@pytest.mark.parametrize("name", ["corner", "two_ways"])
def test_pins_that_exclude_each_other_are_named(solution: Solve, furniture: dict[str, Parts], name: str) -> None:
    slanted = Pattern(mechanism="slanted")
    walls = {p.name: slanted for p in furniture[name] if p.name not in ("ground", "ceiling")}
    with pytest.raises(FoldingError, match="pinned"):
        solution(pinned(furniture[name], **walls), ordering="greedy")


@BOTH
def test_a_rigid_part_is_never_split(solution: Solve, furniture: dict[str, Parts], ordering: str) -> None:
    """Each of the parts in turn: slanted, narrowed, or disconnected at its top; or there is no fold."""
    folded = 0
    for name in ("shelf", "box_with_table", "three_walls", "table"):
        for part in furniture[name]:
            if part.size[2] == 4:
                continue
            rigid = tuple(replace(p, hingeable=p.name != part.name) for p in furniture[name])
            made = solution(rigid, ordering=ordering)
            folded += 1
            m = made.modification(part.name)
            assert m.hinges == 0 and m.mechanism != "in-place"
            assert violations(made) == ()
    assert folded == 13


@pytest.mark.parametrize(("near", "far"), [(3, 3), (1, 3), (5, 5)])
def test_leaning_walls_pinned_to_more_hinges_close_between_samples(
    solution: Solve, furniture: dict[str, Parts], near: int, far: int
) -> None:
    parts = pinned(furniture["two_ways"], near=Pattern(hinges=near), far=Pattern(hinges=far))
    made = solution(parts, slanting=False, max_hinges=5)
    assert violations(made) == ()
