"""Hinges as they are made: their layout, their gaps at any angle, and that nothing pulls them apart."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foldfab.fabrication import solids
from foldfab.fabrication.hinges import Knuckles, knuckles, room
from foldfab.fabrication.panels import panels
from foldfab.fabrication.plates import plate
from foldfab.fabrication.printed import printed
from foldfab.fabrication.solids import Solid
from foldfab.folding.mechanism import frames
from foldfab.folding.model import Chain, Thickness
from foldfab.geometry.arrays import Array
from foldfab.recipe.hinges import STYLES, HingeKind
from foldfab.scaffold.model import BasePatch

THICKNESSES = [Thickness(k, g) for k in (2.5, 3.0, 4.0, 6.0) for g in (0.2, 0.3, 0.4)]
NAMES = [f"K={t.panel:g} g={t.gap:g}" for t in THICKNESSES]
PROGRESS = np.array([0.0, 0.02, 0.07, 0.15, 0.3, 0.5, 0.7, 0.85, 0.95, 1.0])
GAP_SHARE = 0.9
ROUNDING = 0.01
"""Shared volume below this is rounding, mm³."""

thicknesses = st.builds(Thickness, st.floats(2.0, 8.0), st.floats(0.15, 0.5))


@given(thicknesses, st.floats(0.0, 200.0), st.floats(-100.0, 100.0))
def test_the_layout(thickness: Thickness, more: float, low: float) -> None:
    width = thickness.hinge_width + more
    marks = in_order(knuckles(np.array([low, low + width]), thickness))
    assert len(marks) % 2 == 1
    assert marks[0][0] == pytest.approx(low)
    assert marks[-1][1] == pytest.approx(low + width)
    assert [b[0] - a[1] for a, b in itertools.pairwise(marks)] == pytest.approx([thickness.gap] * (len(marks) - 1))
    assert min(marks[0][1] - marks[0][0], marks[-1][1] - marks[-1][0]) >= thickness.socket_width - 1e-9
    assert min(b - a for a, b in marks) > 0


@given(thicknesses)
def test_the_least_width_gets_three(thickness: Thickness) -> None:
    found = knuckles(np.array([0.0, thickness.hinge_width]), thickness)
    assert (len(found.carrier), len(found.follower)) == (2, 1)


@given(thicknesses, st.floats(0.0, 200.0))
def test_a_knuckle_with_two_sockets_keeps_a_wall(thickness: Thickness, more: float) -> None:
    found = knuckles(np.array([0.0, thickness.hinge_width + more]), thickness)
    for a, b in found.carrier[1:-1]:
        assert b - a - 2 * thickness.socket_radius >= 0.8


def test_longer_hinges_get_more_knuckles_up_to_nine() -> None:
    counts = [len(in_order(knuckles(np.array([0.0, w]), Thickness(4.0, 0.3)))) for w in (20, 50, 80, 110, 400)]
    assert counts == [3, 5, 7, 9, 9]


@pytest.mark.parametrize("thickness", THICKNESSES, ids=NAMES)
@pytest.mark.parametrize("width", ["least", "wide"])
@pytest.mark.parametrize("pad", [0.0, 3.0])
def test_a_base_hinge(
    thickness: Thickness,
    width: str,
    pad: float,
    make_chain: Callable[..., Chain],
    make_base: Callable[..., BasePatch],
    assert_printable: Callable[[Solid], None],
) -> None:
    wide = thickness.hinge_width if width == "least" else 36.0
    length = thickness.least_length(is_first=True, is_last=True, ends_free=True) + 10
    chain = make_chain(thickness, lengths=(length,), width=wide, pad=pad)
    shape, is_filled = plate(make_base((0, 0, 30, 30)), (chain,), thickness)
    ground, (leg,) = printed(shape), map(printed, panels(chain, thickness))
    assert not is_filled
    assert_printable(solids.tidied(ground))
    assert_printable(solids.tidied(leg))
    assert_works(ground, leg, poses(chain)[0], thickness, in_sheets=False)
    assert_captive(ground, leg, thickness)


@pytest.mark.parametrize("thickness", THICKNESSES, ids=NAMES)
@pytest.mark.parametrize("width", ["least", "wide"])
@pytest.mark.parametrize("turn", [np.pi / 2, -np.pi / 2], ids=["right", "left"])
def test_an_inserted_hinge(
    thickness: Thickness,
    width: str,
    turn: float,
    make_chain: Callable[..., Chain],
    assert_printable: Callable[[Solid], None],
) -> None:
    wide = thickness.hinge_width if width == "least" else 36.0
    least = [
        thickness.least_length(is_first=True, is_last=False, ends_free=True),
        thickness.least_length(is_first=False, is_last=True, ends_free=True),
    ]
    chain = make_chain(thickness, lengths=(max(least), max(least)), width=wide, turn=turn)
    lower, upper = map(printed, panels(chain, thickness))
    assert_printable(solids.tidied(lower))
    assert_printable(solids.tidied(upper))
    moving = poses(chain)
    assert_works(lower, upper, np.linalg.inv(moving[0]) @ moving[1], thickness, in_sheets=True)
    assert_captive(lower, upper, thickness)


@pytest.mark.parametrize("kind", ["filament", "screw-m2", "screw-m3", "clip"])
@pytest.mark.parametrize("width", ["least", "wide"])
@pytest.mark.parametrize("gap", [0.2, 0.3, 0.4])
def test_other_styles(
    kind: HingeKind,
    width: str,
    gap: float,
    make_chain: Callable[..., Chain],
    make_base: Callable[..., BasePatch],
    assert_printable: Callable[[Solid], None],
) -> None:
    thickness = Thickness(STYLES[kind].least_thickness, gap, kind)
    wide = thickness.hinge_width if width == "least" else 60.0
    chain = make_chain(thickness, lengths=(25.0, 25.0), width=wide)
    shape, _ = plate(make_base((0, 0, 40, 40)), (chain,), thickness)
    ground, lower, upper = (printed(s) for s in (shape, *panels(chain, thickness)))
    for body in (ground, lower, upper):
        assert_printable(solids.tidied(body))
    moving = poses(chain)
    assert_works(ground, lower, moving[0], thickness, in_sheets=False)
    assert_works(lower, upper, np.linalg.inv(moving[0]) @ moving[1], thickness, in_sheets=True)
    if kind == "clip":
        assert_captive(ground, lower, thickness)
        assert_captive(lower, upper, thickness)
    for hinge, (fixed, moving_half) in enumerate(((ground, lower), (lower, upper)) if kind != "clip" else ()):
        pin = loose_pin(chain, thickness, hinge)
        assert solids.overlap(pin, solids.union([fixed, moving_half])) <= ROUNDING
        assert_captive(solids.union([fixed, pin]), moving_half, thickness)
        with pytest.raises(AssertionError, match="comes apart"):
            assert_captive(fixed, moving_half, thickness)


def test_wide_screw_hinges_get_a_screw_from_either_end() -> None:
    marks = knuckles(np.array([0.0, 60.0]), Thickness(4.0, 0.3, "screw-m2"))
    assert len(marks.pins) == 2
    (first, last), (other_first, other_last) = marks.pins
    assert first < last < other_last < other_first
    assert marks.mirrored.mirrored == marks
    assert [round(a + b, 9) for a, b in zip(marks.carrier[0], reversed(marks.carrier[-1]), strict=True)] == [60, 60]


@pytest.mark.parametrize("kind", list(STYLES))
def test_the_least_width_keeps_every_style_at_its_minima(kind: HingeKind) -> None:
    style = STYLES[kind]
    thickness = Thickness(style.least_thickness, 0.3, kind)
    marks = knuckles(np.array([0.0, thickness.hinge_width]), thickness)
    assert (len(marks.carrier), len(marks.follower)) == (2, 1)
    assert marks.carrier[0][0] == pytest.approx(style.head)
    assert min(b - a for a, b in marks.carrier) >= style.knuckle - 1e-9
    assert min(b - a for a, b in marks.follower) >= style.pin_knuckle - 1e-9
    assert marks.carrier[-1][1] == pytest.approx(thickness.hinge_width)


@pytest.mark.parametrize("kind", ["cone", "clip"])
def test_a_hinge_that_is_interrupted_works_and_holds(
    kind: HingeKind, make_chain: Callable[..., Chain], make_base: Callable[..., BasePatch],
    assert_printable: Callable[[Solid], None],
) -> None:  # fmt: skip
    thickness = Thickness(4.0, 0.3, kind)
    chain = replace(make_chain(thickness, lengths=(20.0, 20.0), width=60.0), breaks=((-6.0, 10.0),))
    shape, _ = plate(make_base((0, 0, 30, 40)), (chain,), thickness)
    ground, (lower, upper) = printed(shape), map(printed, panels(chain, thickness))
    for body in (ground, lower, upper):
        assert_printable(body)
    motions = poses(chain)
    assert_works(ground, lower, motions[0], thickness, in_sheets=False)
    assert_works(lower, upper, np.linalg.inv(motions[0]) @ motions[1], thickness, in_sheets=True)
    assert_captive(ground, lower, thickness)
    assert_captive(lower, upper, thickness)
    # Above the base, as high as its knuckles, there is nothing.
    free = solids.box((-2.0, -5.9, 2.1), (2.0, 9.9, 2 * thickness.axis_height + 2.0))
    assert solids.overlap(ground, free) == 0
    assert solids.overlap(lower, free) == 0


def test_beside_a_break_there_are_whole_hinges_or_none() -> None:
    thickness, span = Thickness(4.0, 0.3), np.array([0.0, 60.0])
    marks = knuckles(span, thickness, ((20.0, 35.0),))
    assert marks.free == ((20.0, 35.0),)
    assert (marks.carrier[0][0], marks.carrier[-1][1]) == (0.0, pytest.approx(60.0))
    short = knuckles(span, thickness, ((5.0, 20.0),))
    assert short.free == ((0.0, 20.0),)
    assert short.carrier[0][0] == 20.0
    assert knuckles(span, thickness, ((5.0, 55.0),)) == knuckles(span, thickness)
    assert marks.mirrored.mirrored == marks


def test_one_filament_goes_through_all_of_an_interrupted_hinge() -> None:
    marks = knuckles(np.array([0.0, 60.0]), Thickness(4.0, 0.3, "filament"), ((20.0, 35.0),))
    assert marks.pins == ((0.0, pytest.approx(60.0)),)


def test_hinges_that_are_not_held_are_noticed(make_chain: Callable[..., Chain]) -> None:
    thickness = Thickness(4.0, 0.3)
    lower, upper = map(printed, panels(make_chain(thickness, lengths=(20.0, 20.0)), thickness))
    with pytest.raises(AssertionError):
        assert_captive(lower, upper.translate([50.0, 0.0, 0.0]), thickness)


def in_order(hinge: Knuckles) -> list[tuple[float, float]]:
    """All knuckles along the axis, which alternate."""
    marks = sorted([*hinge.carrier, *hinge.follower])
    assert marks[::2] == list(hinge.carrier)
    return marks


def poses(chain: Chain) -> Array:
    """(m, k, 4, 4) motions of the panels from the open posture at `PROGRESS`."""
    origins, axes = frames(chain, PROGRESS)
    found = np.tile(np.eye(4), (len(chain.lengths), len(PROGRESS), 1, 1))
    for i in range(len(chain.lengths)):
        turn = np.einsum("kaj,ai->kji", axes[:, i], axes[0, i])
        found[i, :, :3, :3] = turn
        found[i, :, :3, 3] = origins[:, i] - turn @ origins[0, i]
    return found


def assert_works(fixed: Solid, moving: Solid, relative: Array, thickness: Thickness, *, in_sheets: bool) -> None:
    """All along the turn the two halves stay the clearance apart, and so they do not meet."""
    for progress, pose in zip(PROGRESS, relative, strict=True):
        placed = solids.moved(moving, pose)
        assert solids.overlap(fixed, placed) <= ROUNDING, f"collide at {progress}"
        gap = solids.gap(fixed, placed, 2 * thickness.gap)
        assert gap >= GAP_SHARE * thickness.gap, f"{gap:.3f} mm apart at {progress}"


def assert_captive(a: Solid, b: Solid, thickness: Thickness) -> None:
    """Pulled along the axis or in eight directions across it, one half meets the other on its way out."""
    angles = np.arange(8) * np.pi / 4 + 0.1
    ways = [(0.0, 1.0, 0.0), (0.0, -1.0, 0.0), *((np.cos(w), 0.0, np.sin(w)) for w in angles)]
    far = max(4 * thickness.gap, thickness.panel / 2)
    for way in ways:
        pulled = (b.translate([share * far * step for step in way]) for share in (1.0, 0.75, 0.5))
        assert any(solids.overlap(a, moved) > ROUNDING for moved in pulled), f"comes apart along {np.round(way, 2)}"


def loose_pin(chain: Chain, thickness: Thickness, hinge: int) -> Solid:
    """What is put into a hinge after printing, as far as it reaches: filament, or the shanks of screws."""
    radius = {"filament": 0.875, "screw-m2": 0.8, "screw-m3": 1.2}[thickness.hinge]
    place = chain.root + np.array([chain.offsets[hinge], 0.0, chain.lengths[:hinge].sum()])
    short = 1.0
    ends = [sorted(pin) for pin in knuckles(chain.hinge_spans[hinge], thickness).pins]
    return solids.union([solids.rod(radius, a + short, b - short, place[0], place[2]) for a, b in ends])


def test_no_wall_thinner_than_a_line_is_left_beyond_a_hinge() -> None:
    thickness = Thickness(4.0, 0.3)
    marks = ((2.0, 8.0), (12.0, 18.0))
    thin, thick = (room(marks, 2.3, thickness, 0.0, 0.0, span) for span in ((1.4, 18.6), (0.0, 20.0)))
    ends = [[solids.bounds(printed(hole)) for hole in holes] for holes in (thin, thick)]
    assert ends[0][0][0][1] < 1.4 and ends[0][1][1][1] > 18.6
    assert ends[1][0][0][1] == pytest.approx(1.7) and ends[1][1][1][1] == pytest.approx(18.3)
