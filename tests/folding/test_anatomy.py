"""What thick chains and bases are made of: plates, slabs, knuckles and feet."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding import anatomy, mechanism
from foldfab.folding.model import FoldSolution, Thickness
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, bounds
from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold

Make = Callable[..., FoldSolution]
K, GAP = 4.0, 0.3
OPEN, FOLDED = np.zeros(1), np.ones(1)


def corners(boxes: Boxes) -> tuple[Array, Array]:
    low, high = bounds(boxes)
    return low.reshape(-1, 3).min(0), high.reshape(-1, 3).max(0)


def test_a_plate_reaches_half_a_thickness_beyond_its_members(solution: Make) -> None:
    made = solution("h_scaffold")
    ceiling = made.scaffold.base("ceiling")
    face = anatomy.faces(ceiling, made.thickness)
    assert (face.bottom, face.top) == (82.0, 86.0)
    low, high = corners(anatomy.base_boxes(ceiling, made.thickness))
    assert low == pytest.approx([-100, -40, 82]) and high == pytest.approx([100, 40, 86])


def test_a_base_of_edges_is_a_plate_at_least_as_wide_as_thick(scaffold: Callable[..., Scaffold]) -> None:
    made = scaffold("roof", thickness=6.0)
    thick = thickness_of(made)
    plate = anatomy.base_boxes(made.bases[1], thick)
    assert len(plate) == 2 and (2 * plate.half >= 6.0 - 1e-9).all()


def thickness_of(scaffold: Scaffold) -> Thickness:
    return Thickness(scaffold.recipe.print.thickness, scaffold.recipe.print.clearance)


def test_an_open_slab_stands_where_the_patch_stood(solution: Make) -> None:
    made = solution("h_scaffold")
    low, high = corners(anatomy.moving_boxes(made.chain("leg"), made.thickness, OPEN))
    assert low[:2] == pytest.approx([-K / 2, -30]) and high[:2] == pytest.approx([K / 2, 30])
    assert low[2] >= 2 + GAP and high[2] <= 82 - GAP


def test_a_knuckle_sticks_out_beyond_the_face_on_the_side_of_its_axis(solution: Make) -> None:
    made = solution("h_scaffold", slanting=False)
    chain = made.chain("leg")
    low, high = corners(anatomy.moving_boxes(chain, made.thickness, OPEN))
    out = (K + GAP) / 2 + K / 2
    assert sorted([-low[0], high[0]]) == pytest.approx([K / 2, out])
    on_high_side = chain.offsets[1] * chain.across[0] > 0
    assert (high[0] > -low[0]) == on_high_side


def test_the_elbow_goes_away_from_its_axis(solution: Make) -> None:
    made = solution("h_scaffold", slanting=False)
    chain = made.chain("leg")
    low, high = corners(anatomy.moving_boxes(chain, made.thickness, np.array([0.5])))
    assert (high[0] > -low[0]) == (chain.offsets[1] * chain.across[0] < 0)
    assert max(high[0], -low[0]) > 20


@pytest.mark.parametrize("name", ["h_scaffold", "slanted_h", "deep_box", "box_with_table"])
def test_feet_stand_on_the_faces_of_their_bases(solution: Make, name: str) -> None:
    made = solution(name, slanting=False)
    for chain in made.chains:
        assert chain.far is not None
        anchor, far = (anatomy.faces(made.scaffold.base(b), made.thickness) for b in (chain.anchor, chain.far))
        low, high = corners(anatomy.anchor_feet(chain, made.thickness))
        assert low[2] == pytest.approx(anchor.top) and high[2] > anchor.top
        low, high = corners(anatomy.far_feet(chain, made.thickness))
        assert high[2] == pytest.approx(far.bottom) and low[2] < far.bottom


def test_a_tip_has_no_foot(solution: Make) -> None:
    made = solution("t_scaffold")
    assert len(anatomy.far_feet(made.chain("leg"), made.thickness)) == 0
    assert len(anatomy.anchor_feet(made.chain("leg"), made.thickness)) == 1


@pytest.mark.parametrize("name", ["t_scaffold", "h_scaffold", "shelf", "deep_box"])
def test_folded_panels_lie_above_the_face_and_below_the_stack(solution: Make, name: str) -> None:
    made = solution(name, slanting=False)
    for chain in made.chains:
        face = anatomy.faces(made.scaffold.base(chain.anchor), made.thickness).top
        low, high = corners(anatomy.moving_boxes(chain, made.thickness, FOLDED))
        own = made.thickness.of(chain.panel)
        stack = own.stack(len(chain.lengths), has_upper_base=chain.far is not None) + sum(chain.pads)
        assert low[2] >= face + GAP / 2 - 1e-9 and high[2] <= face + stack + K


@pytest.fixture(scope="module")
def sunk(solution: Make, pair: Callable[..., tuple[Part, ...]]) -> FoldSolution:
    """Whose chain `three` stands in pockets of both its bases."""
    return solution(pair(74), slanting=False)


@pytest.mark.parametrize("end", [0, 1])
def test_a_pocket_leaves_the_gap_around_all_that_sinks_into_it(sunk: FoldSolution, end: int) -> None:
    chain = sunk.chain("three")
    room = anatomy.pockets(chain, end, sunk.thickness)[0]
    base = sunk.scaffold.base((chain.anchor, chain.far or "")[end])
    face, out = anatomy.faces(base, sunk.thickness), chain.rise * (1.0 if end == 0 else -1.0)
    top = face.top if end == 0 else -face.bottom
    assert float(room.center @ out + room.half[2]) == pytest.approx(top)
    assert 2 * room.half[2] == pytest.approx(-chain.pads[end])
    progress = np.linspace(0.0, 1.0, 400)
    shift = mechanism.reach(chain, progress)[:, 1]
    down = (shift - shift[0]) if end == 1 else np.zeros(len(progress))
    moving = anatomy.moving_boxes(chain, sunk.thickness, progress)
    signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
    points = moving.center[..., None, :] + np.einsum("cj,knj,knji->knci", signs, moving.half, moving.axes)
    points[..., 2] -= down[:, None, None]
    below = points[points @ out < top + GAP - 1e-6]
    inside = np.abs((below - room.center) @ room.axes.T)
    assert len(below) and (inside[:, :2] <= room.half[:2] - GAP + 1e-6).all()
    assert ((below - room.center) @ out >= -room.half[2] + GAP - 1e-6).all()


def test_feet_in_a_pocket_stand_on_its_floor(sunk: FoldSolution) -> None:
    chain = sunk.chain("three")
    (low, _), (_, high) = (corners(f(chain, sunk.thickness)) for f in (anatomy.anchor_feet, anatomy.far_feet))
    assert (low[2], high[2]) == pytest.approx((2 - 1.4, 72 + 1.4))


def test_who_does_not_sink_has_no_pocket(sunk: FoldSolution) -> None:
    assert not any(len(anatomy.pockets(sunk.chain("one"), end, sunk.thickness)) for end in (0, 1))
