"""What hangs in the air in an open print is laid over its gap in narrow stripes, and nothing else is lost by it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from foldfab.fabrication import solids, stopping
from foldfab.fabrication.analytic import analytic
from foldfab.fabrication.coupon import coupon
from foldfab.fabrication.hinges import knuckles
from foldfab.fabrication.inspect import is_captive
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.panels import panels
from foldfab.fabrication.plates import plate
from foldfab.fabrication.posture import open_turn
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, box, cut
from foldfab.fabrication.solids import Outline, Solid
from foldfab.fabrication.stopping import stopped
from foldfab.fabrication.trial import Trial
from foldfab.fabrication.undercuts import KEPT, WEB, bevels, roofs
from foldfab.fabrication.walls import thin_sides
from foldfab.folding.mechanism import joints, tilts
from foldfab.folding.model import Chain, Thickness
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Posture
from foldfab.scaffold.model import BasePatch

LAYER = 0.2
CARRIED = 0.25
"""What reaches no further than this beyond the layer below is carried by it, mm: half a line and a bit."""
UP, ASIDE, ALONG = np.eye(3)[[2, 0, 1]]
THICKNESSES = [Thickness(2.0, 0.2), Thickness(3.0, 0.3), Thickness(4.0, 0.2), Thickness(4.0, 0.3), Thickness(8.0, 0.4)]
NAMES = [f"K={t.panel:g} g={t.gap:g}" for t in THICKNESSES]
WAYS = {"upright": UP, "upside down": -UP, "level": ASIDE, "turned over": -ASIDE, "axes upright": ALONG}
Row = Callable[..., list[Shape]]


@pytest.fixture
def row(make_chain: Callable[..., Chain], make_base: Callable[..., BasePatch]) -> Row:
    """A base and the two panels that stand on it, with their hinges along y, as they are; or with all that may be cut.

    `up` (3,) points up in print.
    """

    def made(thickness: Thickness, up: Array | None, length: float = 30.0) -> list[Shape]:
        chain = make_chain(thickness, lengths=(length, length), width=36.0)
        base, _ = plate(make_base((0, 0, 30, 30)), (chain,), thickness)
        found = panels(chain, thickness, up)
        trims = [] if up is None else [*roofs(chain, thickness, 1, up, 1.0), *bevels(chain, thickness, 1, up, ())]
        cut_from = [[hole for name, hole in trims if name == panel] for panel in chain.panels]
        return [base, *(cut(shape, holes) for shape, holes in zip(found, cut_from, strict=True))]

    return made


@pytest.mark.parametrize("thickness", THICKNESSES, ids=NAMES)
@pytest.mark.parametrize("up", WAYS.values(), ids=WAYS)
def test_little_is_laid_over_a_gap_that_it_may_close(thickness: Thickness, up: Array, row: Row) -> None:
    # Of level panels only the hinge between them lies over something.
    first = 1 if up[0] else 0
    before, after = ([printed(shape) for shape in row(thickness, way)][first:] for way in (None, up))
    assert laid(before, up) > 7.0
    # Plates of 2 mm have no room for roofs, and a layer is a tenth of them.
    assert laid(after, up) < (0.25 if thickness.panel > 2 else 0.7) * laid(before, up)


@pytest.mark.parametrize("thickness", THICKNESSES, ids=NAMES)
@pytest.mark.parametrize("up", WAYS.values(), ids=WAYS)
def test_material_is_only_taken_away_and_hinges_hold(
    thickness: Thickness, up: Array, row: Row, make_chain: Callable[..., Chain],
    assert_printable: Callable[[Solid], None],
) -> None:  # fmt: skip
    chain = make_chain(thickness, lengths=(30.0, 30.0), width=36.0)
    before, after = ([printed(shape) for shape in row(thickness, way)] for way in (None, up))
    for plain, eased in zip(before, after, strict=True):
        assert solids.cut(eased, [plain]).volume() < 1e-3
        assert_printable(solids.tidied(eased))
        assert thin_sides(solids.tidied(eased)) <= thin_sides(solids.tidied(plain))
    for j, (below, above) in enumerate(pairwise(after)):
        assert solids.gap(below, above, 1.0) >= 0.97 * thickness.gap
        assert is_captive(below, above, ends(chain, j), thickness.panel / 2, thickness.gap)
        for pin in pins(chain, thickness, j):
            assert solids.cut(pin, [above]).volume() < 1e-3


@pytest.mark.parametrize("thickness", THICKNESSES, ids=NAMES)
@pytest.mark.parametrize("up", WAYS.values(), ids=WAYS)
def test_the_shortest_panels_keep_their_walls(thickness: Thickness, up: Array, row: Row) -> None:
    least = thickness.least_length(is_first=True, is_last=False, ends_free=True)
    for plain, eased in zip(row(thickness, None, least), row(thickness, up, least), strict=True):
        made = solids.tidied(printed(eased))
        assert solids.pieces(made) == 1
        assert thin_sides(made) <= thin_sides(solids.tidied(printed(plain)))


@pytest.mark.parametrize("up", WAYS.values(), ids=WAYS)
def test_bodies_for_cad_are_cut_alike(up: Array, row: Row) -> None:
    for shape in row(THICKNESSES[3], up):
        assert analytic(shape).volume == pytest.approx(printed(shape).volume(), rel=2e-3)


def test_knuckles_are_pointed_towards_what_carries_them_alone(row: Row) -> None:
    thickness = THICKNESSES[3]
    edge, half = np.sqrt(2.0) * (thickness.pin_radius + KEPT), thickness.panel / 2
    plain, above, below = (printed(row(thickness, way)[1]) for way in (None, UP, -UP))
    axis = thickness.panel / 2 + thickness.axis_height
    assert solids.bounds(plain)[0][2] == pytest.approx(axis - half, abs=0.01)
    # On its base, whether that is the upper or the lower one in print.
    for made in (above, below):
        assert solids.bounds(made)[0][2] == pytest.approx(axis - edge, abs=0.01)
        low = solids.section(made, axis - edge + 0.1).bounds()
        assert low[2] - low[0] == pytest.approx(0.2, abs=0.01)
    level = printed(row(thickness, ASIDE)[1])
    assert solids.bounds(level)[0][2] == pytest.approx(axis - half, abs=0.01)


@pytest.mark.parametrize("up", [ASIDE, -ASIDE])
def test_a_roof_leaves_a_wall_across_a_level_panel_or_is_none(up: Array, make_chain: Callable[..., Chain]) -> None:
    for thickness, least in ((Thickness(2.0, 0.3), 0.0), (Thickness(3.0, 0.3), WEB), (Thickness(4.0, 0.3), WEB)):
        chain = make_chain(thickness, lengths=(30.0, 30.0), width=36.0)
        holes = [printed(hole) for _, hole in roofs(chain, thickness, 1, up, 1.0)]
        assert bool(holes) == (least > 0)
        for hole in holes:
            reach = solids.mesh(hole)[0][:, 0] * np.sign(chain.offsets[1])
            assert reach.min() >= least - thickness.panel / 2 - 1e-6
            assert np.isclose(reach.min(), least - thickness.panel / 2, atol=0.1)


@pytest.mark.parametrize("short", [6.2, 7.0, 30.0])
def test_a_roof_leaves_a_wall_along_a_short_panel(short: float, make_chain: Callable[..., Chain]) -> None:
    thickness = THICKNESSES[3]
    chain = make_chain(thickness, lengths=(30.0, short, 30.0), width=36.0)
    bottom = float(chain.root[2]) + 30.0
    tops = [solids.bounds(printed(hole))[1][2] - bottom for _, hole in roofs(chain, thickness, 1, UP, 1.0)]
    wanted = np.sqrt(2.0) * (thickness.knuckle_room - KEPT)
    assert tops == pytest.approx([min(wanted, short - thickness.knuckle_room - WEB)] * len(tops))
    assert len(tops) == 2
    low = [solids.bounds(printed(hole))[1][2] - bottom for _, hole in roofs(chain, thickness, 1, UP, 0.5)]
    assert all(a < b or np.isclose(b, short - thickness.knuckle_room - WEB) for a, b in zip(low, tops, strict=True))


@pytest.mark.parametrize("up", [(0.0, 0.5, 0.8), (0.6, 0.8, 0.0)])
def test_hinges_that_neither_lie_nor_stand_stay_round(up: tuple[float, float, float], row: Row) -> None:
    assert row(THICKNESSES[3], np.array(up) / np.linalg.norm(up)) == row(THICKNESSES[3], None)


@pytest.mark.parametrize("posture", ["open", "folded", "edge"])
@pytest.mark.parametrize("name", ["shelter", "tent"])
def test_only_what_is_printed_open_has_it(posture: Posture, name: str, assembled: Callable[..., Assembly]) -> None:
    made = assembled(name, posture)
    chain, thickness = made.solution.chain("wall"), made.solution.thickness
    up = open_turn(made.solution.scaffold)[2] if posture == "open" else None
    whole = {body.name: solids.from_mesh(body.vertices, body.faces) for body in made.bodies}
    for i, panel in enumerate(chain.panels):
        spared = solids.cut(printed(panels(chain, thickness)[i]), [printed(panels(chain, thickness, up)[i])])
        left = solids.overlap(spared, whole[panel]) if posture == "open" else float(spared.volume())
        # Stops that were added may fill a little of it.
        assert left < (0.2 * spared.volume() if posture == "open" else 1e-6)
        assert posture != "open" or spared.volume() > 10.0


@pytest.mark.parametrize("lean", [0.0, 20.0, -20.0, 40.0])
@pytest.mark.parametrize("up", [UP, -UP], ids=["upright", "upside down"])
def test_the_end_that_looks_down_is_bevelled_beside_stops(
    lean: float, up: Array, make_chain: Callable[..., Chain]
) -> None:
    thickness, taken = THICKNESSES[3], ((-4.0, 3.0),)
    chain = replace(make_chain(thickness, lengths=(30.0, 30.0), width=36.0), lean=np.radians(lean))
    holes = list(bevels(chain, thickness, 1, up, taken))
    assert {name for name, _ in holes} == {chain.panels[1 if up[2] > 0 else 0]}
    for _, hole in holes:
        vertices, faces = solids.mesh(printed(hole))
        corners = vertices[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        slopes = normals @ up / np.linalg.norm(normals, axis=1)
        # What it leaves looks down by 45°, but where the panel's own faces do already.
        assert np.isclose(slopes, np.sqrt(0.5)).any()
        y = vertices[:, 1]
        assert y.max() <= -4.0 - thickness.gap - WEB + 1e-9 or y.min() >= 3.0 + thickness.gap + WEB - 1e-9


def test_a_late_hinge_keeps_the_end_that_stops_it(
    assembled: Callable[..., Assembly], monkeypatch: pytest.MonkeyPatch
) -> None:
    assembly = assembled("shelter")
    chain, thickness = assembly.solution.chain("wall"), assembly.solution.thickness
    up = open_turn(assembly.solution.scaffold)[2]
    described = dict(zip(chain.panels, panels(chain, thickness, up), strict=True))
    draft = replace(assembly, shapes=assembly.shapes | described)
    made = {b.name: solids.from_mesh(b.vertices, b.faces) for b in assembly.bodies}
    made |= {name: solids.tidied(printed(shape)) for name, shape in described.items()}
    bevel = [printed(hole) for _, hole in bevels(chain, thickness, 1, up, ())]
    before = solids.overlap(made["wall/2"], bevel[0])
    assert before > 10.0
    # Beside the lap little is left of it; without a lap, all.
    assert solids.overlap(stopped(draft, made, {}).made["wall/2"], bevel[0]) < 0.4 * before
    monkeypatch.setattr(stopping, "stops", lambda *_, **__: iter(()))
    assert solids.overlap(stopped(draft, made, {}).made["wall/2"], bevel[0]) == pytest.approx(before, abs=1e-3)


def test_a_hole_without_room_is_not_taken(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("shelter")
    made = {b.name: solids.from_mesh(b.vertices, b.faces) for b in assembly.bodies}
    trial = Trial(assembly, made)
    low, high = solids.bounds(made["wall/1"])
    middle = (low + high) / 2
    across = [low - 1.0, high + 1.0]
    through = box((across[0][0], across[0][1], middle[2]), (across[1][0], across[1][1], middle[2] + 2.0))
    skin = box((low[0] - 1.0, middle[1], middle[2]), (1.7, middle[1] + 5.0, middle[2] + 5.0))
    lap = next(joint for joint in assembly.joints if joint.stops == ("lap",))
    end = box((low[0] - 1.0, low[1] - 1.0, high[2] - 9.0), (high[0] + 1.0, high[1] + 1.0, high[2] + 1.0))
    assert "wall/1" in lap.parts
    for hole in (through, skin, end):
        assert not trial.trim("wall/1", [hole])
    assert trial.made == made and trial.changes["wall/1"] == []
    groove = box((low[0] - 1.0, middle[1], middle[2]), (low[0] + 0.5, middle[1] + 5.0, middle[2] + 5.0))
    assert trial.trim("wall/1", [groove])
    assert made["wall/1"].volume() - trial.made["wall/1"].volume() == pytest.approx(12.5, abs=0.01)
    assert printed(trial.shapes["wall/1"]).volume() == pytest.approx(trial.made["wall/1"].volume(), rel=1e-4)
    assert len(trial.changes["wall/1"]) == 1


def test_a_leaning_panel_loses_little_of_its_own_root(make_chain: Callable[..., Chain]) -> None:
    """Its knuckles are pointed straight down, and its plate is cut no higher than they are."""
    thickness = THICKNESSES[3]
    chain = replace(make_chain(thickness, lengths=(30.0,), width=36.0), lean=np.radians(40.0), turn=np.pi / 2)
    plain, eased = (printed(panels(chain, thickness, way)[0]) for way in (None, UP))
    taken = solids.cut(plain, [eased])
    along = np.array([np.sin(chain.lean), 0.0, np.cos(chain.lean)])
    reach = (solids.mesh(taken)[0] - chain.root) @ along
    assert taken.volume() > 1.0
    assert reach.max() <= thickness.panel / 2 - np.sqrt(2.0) * (thickness.pin_radius + KEPT) + 1e-3


def test_the_coupon_has_the_hinges_of_its_posture() -> None:
    def lowest(posture: Posture) -> float:
        parts = {body.name: body for body in coupon(4.0, posture).bodies}
        hinge, base = parts["0.30"], parts["plate"]
        return float(hinge.vertices[:, 2].min() - base.vertices[:, 2].min())

    # The gap, and what the edge of its knuckle is higher than the round one.
    edge = np.sqrt(2.0) * (THICKNESSES[3].pin_radius + KEPT)
    assert lowest("open") == pytest.approx(4.0 + 0.3 + 2.0 - edge, abs=0.01)
    assert lowest("folded") == pytest.approx(4.0 + 0.3, abs=0.01)


def laid(bodies: list[Solid], up: Array) -> float:
    """mm² that no layer of its own body carries, over another body not more than two layers below."""
    side = np.cross(up, np.roll(up, 1))
    turn = np.eye(4)
    turn[:3, :3] = np.stack([np.cross(side, up), side, up])
    standing = [solids.moved(body, turn) for body in bodies]
    low, high = (f(bound[k][2] for bound in map(solids.bounds, standing)) for k, f in enumerate((min, max)))
    heights = np.arange(np.floor(low / LAYER), np.ceil(high / LAYER)) * LAYER + LAYER / 2
    layers = [[solids.section(body, float(z)) for body in standing] for z in heights]
    return sum(
        _over(layers[max(k - 3, 0) : k], layers[k], i) for k in range(1, len(layers)) for i in range(len(bodies))
    )


def _over(below: list[list[Outline]], layer: list[Outline], i: int) -> float:
    """What of the section of body `i` lies over others, with one or two layers of nothing between, mm²."""
    fresh = layer[i] - solids.grown(below[-1][i], CARRIED)
    others = [solids.nothing() for _ in below]
    for k, sections in enumerate(below):
        for j, section in enumerate(sections):
            others[k] = others[k] + section if j != i else others[k]
    found = solids.nothing()
    for other in others[:-1]:
        found = found + (fresh ^ other)
    return float((found - others[-1]).area())


def ends(chain: Chain, j: int) -> Array:
    """(2, 3) those of hinge `j`."""
    middle = chain.root + joints(chain, tilts(chain, np.zeros(1)))[0, j] @ np.stack([chain.across, chain.rise])
    found: Array = middle + chain.hinge_spans[j][:, None] * chain.along
    return found


def pins(chain: Chain, thickness: Thickness, j: int) -> list[Solid]:
    """The cones of hinge `j`."""
    x, _, z = ends(chain, j)[0]
    size = thickness.pin_radius
    marks = knuckles(chain.hinge_spans[j], thickness).follower
    return [
        solids.cone(size, end, end + way * size, float(x), float(z)) for a, b in marks for end, way in ((a, -1), (b, 1))
    ]
