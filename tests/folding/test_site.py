"""Where patches stand with their thickness: between faces, and a gap apart from their neighbours."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest

from foldfab.folding.model import Thickness
from foldfab.folding.site import Site, plate_boxes, sites, slab
from foldfab.geometry.boxes import bounds, grown, overlaps
from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold

Make = Callable[..., Scaffold]
THICK = Thickness(4.0, 0.3)


def placed(scaffold: Scaffold) -> dict[str, Site]:
    return {site.patch.name: site for site in sites(scaffold, THICK)}


def test_a_panel_reaches_from_face_to_face_but_for_the_gaps(scaffold: Make) -> None:
    leg = placed(scaffold("h_scaffold"))["leg"]
    assert (leg.anchor, leg.far, leg.clear) == ("ground", "ceiling", 80.0)
    low, high = (corner[0, 2] for corner in bounds(slab(leg, THICK)))
    assert (low, high) == pytest.approx((2.3, 81.7))


def test_a_leg_under_a_board_hangs_from_it(scaffold: Make) -> None:
    leg = placed(scaffold("table"))["left"]
    assert (leg.anchor, leg.far) == ("top", None)
    assert leg.rise.tolist() == [0, 0, -1]
    assert leg.foot[2] == pytest.approx(70)
    assert np.cross(leg.across, leg.along) == pytest.approx(leg.rise)


def test_a_leaning_wall_knows_its_lean(scaffold: Make) -> None:
    leg = placed(scaffold("slanted_h"))["leg"]
    assert abs(leg.lean) == pytest.approx(np.arctan2(30, 84))
    top = leg.foot + leg.clear * (leg.rise + np.tan(leg.lean) * leg.across)
    assert top == pytest.approx([15 * 80 / 84, 0, 82])


@pytest.mark.parametrize("name", ["three_walls", "box_with_table", "shelf", "deep_box"])
def test_importances_are_shares_of_the_area_of_all_foldable_patches(scaffold: Make, name: str) -> None:
    found = placed(scaffold(name))
    assert sum(site.importance for site in found.values()) == pytest.approx(1.0)
    areas = [site.patch.area / site.importance for site in found.values()]
    assert areas == pytest.approx([areas[0]] * len(areas))


def test_walls_that_meet_in_a_corner_are_trimmed_to_leave_a_gap(
    scaffold: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part], box: Callable[..., Part]
) -> None:
    boards = (board_at("ground", 0, 240, 160), board_at("ceiling", 84, 240, 160))
    walls = (wall_at("left", -60, 0, 84, 120), wall_at("right", 60, 0, 84, 120), box("back", (0, 62, 42), (116, 4, 80)))
    found = placed(scaffold((*boards, *walls)))
    slabs = [grown(slab(site, THICK), THICK.gap / 2 - 1e-6) for site in found.values()]
    assert not any(overlaps(a, b).any() for a, b in combinations(slabs, 2))
    widths = {name: float(np.ptp(site.span)) for name, site in found.items()}
    assert sum(widths.values()) < 2 * 120 + 116
    assert all(0.9 * site.patch.width < widths[name] <= site.patch.width for name, site in found.items())


def test_walls_far_apart_keep_their_width(scaffold: Make) -> None:
    for site in placed(scaffold("box_with_table")).values():
        assert np.ptp(site.span) == pytest.approx(site.patch.width)


def test_a_plate_reaches_below_a_wall_that_it_meets_with_its_edge(
    scaffold: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    made = scaffold(
        (board_at("ground", 0), board_at("shelf", 40, 70, x=40), board_at("top", 80), wall_at("wall", 2, 0, 80))
    )
    held = placed(made).values()
    ends = np.array([corner[:, 0] for corner in bounds(plate_boxes(made.base("shelf"), held, THICK))])
    # Its own board, and a lip for each of the two panels of the wall; +x may be the other way in the canonical frame.
    low, high = np.sort(ends * made.rotation[0, 0], axis=0)
    assert low == pytest.approx([5, -0.4, -0.4]) and high == pytest.approx([75, 4.4, 4.4])
    assert len(plate_boxes(made.base("ground"), held, THICK)) == 1
