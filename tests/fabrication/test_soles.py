"""The first layer: drawn in on every body that stands on the bed, and nothing lost by it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from foldfab import pipeline
from foldfab.export.bed import on_bed, print_files
from foldfab.export.shell import Shell
from foldfab.fabrication import soles, solids
from foldfab.fabrication.analytic import analytic
from foldfab.fabrication.coupon import coupon
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, box, cone, cut, placed, rod, union
from foldfab.fabrication.soles import DRAWN_IN, UNEVEN, bevel, bevelled
from foldfab.fabrication.solids import Outline, Solid
from foldfab.recipe.model import Posture, Printer

LAYER = 0.2
GRID = 1e-3
"""mm."""
CORNERS = 0.1
"""What of a layer may be left where an edge that leans ends, mm²."""


def stood(shape: Shape, layer: float = LAYER) -> Solid:
    """A body on the bed as it is printed."""
    made, shapes = bevelled({"it": printed(shape)}, {"it": shape}, {"it": np.eye(4)}, layer)
    assert shapes["it"] is shape or made["it"].volume() == pytest.approx(printed(shapes["it"]).volume(), rel=1e-4)
    return made["it"]


def is_within(one: Outline, other: Outline) -> bool:
    return (one - solids.grown(other, GRID)).area() < GRID


@pytest.mark.parametrize("layer", [0.1, 0.2, 0.3])
def test_the_first_layer_is_drawn_in_and_no_other(layer: float) -> None:
    made = stood(box((0, 0, 0), (20, 10, 4)), layer)
    first = np.array(made.slice(layer / 2).bounds())
    assert np.allclose(first, [DRAWN_IN, DRAWN_IN, 20 - DRAWN_IN, 10 - DRAWN_IN], atol=3 * UNEVEN)
    assert made.slice(max(1.5 * layer, bevel(layer)) + 3 * UNEVEN).area() == pytest.approx(200.0)


@pytest.mark.parametrize("turn", [0.0, 17.0, 90.0])
def test_corners_both_ways_holes_and_rounds_are_drawn_in_alike(turn: float) -> None:
    standing = placed(rod(3, 0, 5, 0, 0), np.array([30.0, 8, 5]), np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]))
    ell = union([box((0, 0, 0), (30, 10, 5)), box((0, 0, 0), (10, 30, 5)), standing])
    hole = placed(rod(2, -1, 6, 0, 0), np.array([5.0, 20, 5]), np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]))
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    shape = placed(cut(ell, [hole]), np.array([7.0, 3, 0]), np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
    made, plain = stood(shape), printed(shape)
    first, whole = made.slice(LAYER / 2), plain.slice(LAYER / 2)
    assert is_within(first, solids.grown(whole, -DRAWN_IN + GRID))
    # No more is lost than that, but for a little where edges meet.
    assert is_within(solids.grown(whole, -DRAWN_IN - 0.05), first)
    assert (plain.slice(0.35) - made.slice(0.35)).area() < 0.01
    assert solids.pieces(made) == 1 and solids.stays_closed(made)


@pytest.mark.parametrize("width", [0.5, 0.9, 1.2])
def test_what_would_be_less_than_two_lines_wide_keeps_its_edges(width: float) -> None:
    narrow = stood(box((0, 0, 0), (width, 10, 4)))
    bounds = narrow.slice(LAYER / 2).bounds()
    assert bounds[2] - bounds[0] == pytest.approx(width)
    rib = union([box((0, 0, 0), (10, 10, 4)), box((9, 4, 0), (20, 4 + width, 4))])
    first = stood(rib).slice(LAYER / 2)
    assert first.area() > 0.85 * printed(rib).slice(LAYER / 2).area()
    beside = first ^ solids.rectangle(np.array([15.0, 4 + width / 2]), np.array([4.0, 4.0]))
    assert beside.area() == pytest.approx(4 * width)


def test_bodies_for_cad_have_the_same_bevels() -> None:
    shape = union([box((0, 0, 0), (30, 10, 5)), box((0, 0, 0), (10, 30, 5))])
    made, shapes = bevelled({"it": printed(shape)}, {"it": shape}, {"it": np.eye(4)}, LAYER)
    cad = analytic(shapes["it"])
    assert made["it"].volume() < 2500 - 4
    assert cad.volume == pytest.approx(made["it"].volume(), rel=1e-5)


def test_what_does_not_stand_on_the_bed_stays_as_it_is() -> None:
    high = box((0, 0, 0.5), (20, 10, 4))
    assert stood(high).volume() == pytest.approx(20 * 10 * 3.5)


def test_walls_that_lean_are_no_more_than_drawn_in() -> None:
    """A barrel on the bed and a cone with its mouth there lose a little, and fall into no pieces."""
    barrel = placed(rod(2, 0, 10, 0, 2), np.zeros(3), np.eye(3))
    wide = placed(cone(4, 0, 4, 0, 0), np.zeros(3), np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]))
    for shape in (barrel, wide):
        made, plain = stood(shape), printed(shape)
        assert solids.pieces(made) == 1 and solids.stays_closed(made)
        first, whole = made.slice(LAYER / 2), plain.slice(LAYER / 2)
        assert is_within(solids.grown(whole, -DRAWN_IN - 0.05), first)
    ends = stood(barrel).slice(LAYER / 2).bounds()
    assert np.allclose([ends[1], ends[3]], [DRAWN_IN, 10 - DRAWN_IN], atol=3 * UNEVEN)


def sections(shells: tuple[Shell, ...], z: float) -> dict[str, Outline]:
    cuts = {shell.name: solids.from_mesh(shell.vertices, shell.faces).slice(z) for shell in shells}
    return {name: cut for name, cut in cuts.items() if not cut.is_empty()}


def not_drawn_in(made: Assembly, plain: Assembly) -> list[str]:
    """The bodies on the bed whose first layer is not within all that was around it, less what is drawn in."""
    found = []
    for name, shells in print_files(made).items():
        for shell, was in zip(shells, print_files(plain)[name], strict=True):
            first = sections((shell,), 0.5 * LAYER).get(shell.name, solids.nothing())
            around = solids.silhouette(solids.between(solids.from_mesh(was.vertices, was.faces), 0.0, 2 * LAYER))
            left = (first - solids.grown(around, -DRAWN_IN + 0.01)).area()
            found += [shell.name] if left > CORNERS else []
    return found


def least(cuts: dict[str, Outline], most: float) -> float:
    """The least distance between bodies, in steps of 0.01, mm."""
    reach = [m for m in np.arange(0.0, most, 0.01) if any(meet(a, b, m) for a, b in combinations(cuts.values(), 2))]
    return min(reach, default=most)


def meet(one: Outline, other: Outline, margin: float) -> bool:
    return not (solids.grown(one, margin) ^ other).is_empty()


def on_edge() -> Assembly:
    """Legs and a seat that all stand on the bed."""
    return pipeline.fabricate(pipeline.foldabilize(pipeline.load("bench-legs", posture="edge")))


def test_on_edge_bodies_are_further_apart_on_the_bed_than_above() -> None:
    made = on_edge()
    gap, shells = made.solution.thickness.gap, on_bed(made)
    above = least(sections(shells, 3.5 * LAYER), 1.0)
    assert gap - 0.02 <= above < gap + DRAWN_IN
    assert least(sections(shells, 0.5 * LAYER), 1.0) >= above + 2 * DRAWN_IN - 0.02


def test_without_bevels_they_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(soles, "_wedges", lambda *_: iter(()))
    made = on_edge()
    assert least(sections(on_bed(made), 0.5 * LAYER), 1.0) < made.solution.thickness.gap + DRAWN_IN


SMALL = Printer("small", (150.0, 150.0, 150.0))
STANDING: dict[str, tuple[Posture, dict[str, Any]]] = {
    "open": ("open", {}),
    "folded": ("folded", {}),
    "loose": ("plate", {"hinge": "filament"}),
    "cut in pieces": ("plate", {"hinge": "filament", "printer": SMALL}),
}


@pytest.mark.parametrize(("posture", "options"), STANDING.values(), ids=STANDING)
def test_all_that_stands_on_the_bed_is_drawn_in(
    posture: Posture,
    options: dict[str, Any],
    assembled: Callable[..., Assembly],
    assert_printable: Callable[[object], None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = assembled("table", posture, **options)
    assert bool(made.pieces) == ("printer" in options)
    monkeypatch.setattr(soles, "_wedges", lambda *_: iter(()))
    plain = assembled.__wrapped__("table", posture, **options)  # type: ignore[attr-defined]
    assert not_drawn_in(made, plain) == []
    assert not_drawn_in(plain, plain) != []
    for body in made.bodies:
        assert_printable(body)


def test_the_coupon_is_drawn_in() -> None:
    made = coupon(4.0, "open")
    plate = next(solids.from_mesh(b.vertices, b.faces) for b in made.bodies if b.name == "plate")
    assert is_within(plate.slice(0.1), solids.grown(plate.slice(0.5), -DRAWN_IN + 0.01))


@pytest.mark.parametrize("broken", [0, 1, len(soles.TRIED)])
def test_a_bevel_that_would_leave_a_body_unsound_is_tried_a_little_wider(
    broken: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A body that none of them leaves sound keeps its edges."""
    shape, judged = box((0, 0, 0), (20, 10, 4)), solids.pieces
    plain, usual = printed(shape).volume(), stood(shape).volume()
    bevels: list[Solid] = []

    def pieces(solid: Solid) -> int:
        if solid.volume() < plain - 1e-6:
            bevels.append(solid)
            return 2 if len(bevels) <= broken else judged(solid)
        return judged(solid)

    monkeypatch.setattr(solids, "pieces", pieces)
    made = stood(shape).volume()
    assert len(bevels) == min(broken + 1, len(soles.TRIED))
    assert (made == usual, made == plain) == (broken == 0, broken == len(soles.TRIED))
