"""Which options have room: pieces that meet something are pruned, and plinths carry a chain over what lies folded."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding.congruent import repertoire
from foldfab.folding.lanes import Lane
from foldfab.folding.ordering import after
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import THE_BOX, Prospects, blocked_pieces, prospects, unhindered
from foldfab.folding.repertoire import TOUCH, Repertoire, far_shift
from foldfab.folding.scene import Scene, open_scene
from foldfab.folding.surroundings import Surroundings, look
from foldfab.folding.unit_fold import UnitFold, fold_unit
from foldfab.folding.work import LOOKING
from foldfab.geometry.boxes import Boxes, grown, moved, overlaps
from foldfab.recipe.model import Part

from .every import whole

Make = Callable[..., Problem]
Folded = Callable[[Problem], tuple[Scene, list[tuple[Scene, UnitFold]]]]


def seen(made: Problem, scene: Scene, patch: str) -> tuple[Repertoire, Surroundings]:
    own = whole(made, made.unit_of[patch])
    return own, look(made, scene, own)


def found(made: Problem, scene: Scene, patch: str, *, in_place: bool = False) -> Prospects:
    return prospects(made, *seen(made, scene, patch), in_place=in_place)


def pick(many: tuple[Lane, ...], mechanism: str, side: str, hinges: int | None = None) -> list[Lane]:
    """Lanes that fold by a mechanism towards +x ("+") or -x ("-")."""
    towards = 1.0 if side == "+" else -1.0
    return [
        x
        for x in many
        if x.variant.mechanism == mechanism
        and hinges in (None, x.variant.hinges)
        and np.sign(x.chain.turn * x.chain.across[0]) == towards
    ]


def after_folding(made: Problem, patch: str) -> Scene:
    scene = open_scene(made)
    fold = fold_unit(made, scene, made.unit_of[patch])
    assert isinstance(fold, UnitFold)
    return after(made, scene, fold)


def test_a_lane_is_held_against_its_surroundings_once_and_counted_for_it(problem: Make) -> None:
    made = problem("box_with_table")
    own, around = seen(made, open_scene(made), "leg-left")
    lanes, before = list(own.plain["leg-left"]), made.work.spent
    for _ in range(2):
        blocked_pieces(made, own, around, lanes)
        assert made.work.spent - before == pytest.approx(LOOKING * len(lanes))


@pytest.fixture(scope="session")
def beside_a_stick(
    board_at: Callable[..., Part], wall_at: Callable[..., Part], box: Callable[..., Part]
) -> tuple[Part, ...]:
    """A wall 60 mm deep, and beside its back fifth an upright stick."""
    stick = box("stick", (24, 24, 22), (4, 8, 40))
    return (board_at("ground", 0), board_at("ceiling", 84), wall_at("wall", 0, 0, 84), stick)


@pytest.fixture(scope="session")
def beside_a_flap(
    board_at: Callable[..., Part], wall_at: Callable[..., Part], box: Callable[..., Part]
) -> tuple[Part, ...]:
    """Two walls that may slant, and a low flap beside one of them."""
    flap = box("flap", (-30, 0, 14), (4, 40, 24))
    return (board_at("ground", 0), board_at("ceiling", 84), wall_at("a", -50, 0, 84), wall_at("b", 50, 0, 84), flap)


def test_the_pieces_that_meet_something_are_blocked_and_the_others_are_not(
    problem: Make, beside_a_stick: tuple[Part, ...]
) -> None:
    """Figure 15 b: the window beside the stick remains."""
    made = problem(beside_a_stick, slanting=False)
    own, around = seen(made, open_scene(made), "wall")
    room = prospects(made, own, around, in_place=False)
    # An elbow on the side of the stick meets it.
    for x in room.lanes["wall"]:
        is_blocked = room.blocked[x.number]
        assert not is_blocked[:-2].any() and is_blocked.tolist() == brute_force(made, own, around, x)
        assert room.obstacles[x.number] == (("stick",) if is_blocked.any() else ())
    hit = [x for x in room.lanes["wall"] if room.blocked[x.number].any()]
    free = [x for x in room.lanes["wall"] if not room.blocked[x.number].any()]
    assert hit and free
    assert {np.sign(x.chain.turn * x.chain.across[0]) for x in hit if x.variant.hinges == 1} == {1.0}


@pytest.mark.parametrize("name", ["chair", "box_with_table", "three_walls", "tower"])
def test_lanes_that_come_near_nothing_have_room(problem: Make, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As they are found to have where every lane is held against everything."""
    rooms = []
    for few in (8, 0):
        monkeypatch.setattr("foldfab.folding.lanes.FEW_BASES", few)
        made = problem(name)
        scene = open_scene(made)
        found = []
        for unit in made.units:
            own = whole(made, unit)
            seen = prospects(made, own, look(made, scene, own), in_place=False)
            found.append({n: (room.tolist(), sorted(seen.met[n])) for n, room in seen.blocked.items()})
        rooms.append(found)
    assert rooms[0] == rooms[1]


def brute_force(made: Problem, own: Repertoire, around: Surroundings, x: Lane) -> list[bool]:
    """Whether each piece of a lane meets anything but its own plates, by the exact test, frame by frame."""
    blocked = [False] * (len(x.cuts) - 1)
    plates = {made.tree.number[b] for b in (x.chain.anchor, x.chain.far) if b}
    for section, boxes in own.movers[x.number].items():
        wide = grown(boxes, made.thickness.gap / 2 - TOUCH)
        for frame in range(len(wide)):
            for j, solid in enumerate(around.solids[i] for i in around.owner):
                if solid.state == "base" and solid.base in plates:
                    continue
                base = own.unit.bases[int(around.group[j])]
                other = moved(around.boxes[j], far_shift(own, x, base, section)[frame])
                for k, piece in cut(wide[frame], x):
                    blocked[k] |= bool(overlaps(piece, Boxes(*(
                        np.broadcast_to(v, (len(piece), *v.shape)) for v in (other.center, other.axes, other.half)
                    ))).any())  # fmt: skip
    return blocked


def cut(boxes: Boxes, x: Lane) -> list[tuple[int, Boxes]]:
    """The boxes (n,) of a lane within each of its pieces."""
    along = x.chain.along
    middle = boxes.center @ along
    found = []
    for k in range(len(x.cuts) - 1):
        low = np.maximum(middle - boxes.half[:, 1], x.cuts[k] + 1e-6)
        high = np.minimum(middle + boxes.half[:, 1], x.cuts[k + 1] - 1e-6)
        real = low < high
        center = boxes.center + along * ((low + high) / 2 - middle)[:, None]
        half = np.stack([boxes.half[:, 0], (high - low) / 2, boxes.half[:, 2]], axis=1)
        found.append((k, Boxes(center, boxes.axes, half)[real]))
    return found


@pytest.mark.parametrize(("name", "patch"), [("beside", "wall"), ("tower", "a"), ("box_with_table", "left")])
def test_pieces_are_blocked_exactly_where_the_exact_test_says(problem: Make, name: str, patch: str) -> None:
    made = problem(name)
    scene = open_scene(made)
    own, around = seen(made, scene, patch)
    room = prospects(made, own, around, in_place=False)
    for x in own.plain[patch]:
        expected = brute_force(made, own, around, x)
        assert room.blocked[x.number].tolist() == [b or x.is_out for b in expected]


def test_what_leaves_the_outline_is_out_as_a_whole(problem: Make) -> None:
    made = problem("deep_box")
    room = found(made, open_scene(made), "back")
    out = [x for x in room.lanes["back"] if x.is_out]
    assert out and all(room.blocked[x.number].all() and room.obstacles[x.number] == (THE_BOX,) for x in out)


def test_without_surroundings_only_the_outline_is_in_the_way(problem: Make, beside_a_stick: tuple[Part, ...]) -> None:
    made = problem(beside_a_stick)
    own = repertoire(made, made.unit_of["wall"])
    room = unhindered(made, own)
    assert room.lanes == own.plain and not any(b.any() for b in room.blocked.values())
    deep = problem("deep_box")
    own = whole(deep, deep.unit_of["back"])
    blocked = unhindered(deep, own).blocked
    assert {x.number for x in own.lanes if blocked[x.number].all()} == {x.number for x in own.lanes if x.is_out}


def test_in_place_nothing_drags_its_base(problem: Make) -> None:
    made = problem("h_scaffold")
    room = found(made, open_scene(made), "leg", in_place=True)
    assert {x.variant.mechanism for x in room.lanes["leg"]} == {"in-place"}


def test_a_chain_that_meets_what_lies_folded_is_raised_over_it(problem: Make, beside_a_flap: tuple[Part, ...]) -> None:
    """Figure 15 c."""
    made = problem(beside_a_flap, slanting=False)
    scene = after_folding(made, "flap")
    (flap,) = [s for s in scene.solids if s.owner == "flap" and s.state == "folded"]
    height = flap.high[2] - made.faces["ground"].top
    room = found(made, scene, "a")
    raised = [x for x in room.lanes["a"] if any(x.variant.pads)]
    assert raised
    plain = {(x.variant.hinges, x.variant.side): x for x in room.lanes["a"] if not any(x.variant.pads)}
    for x in raised:
        assert x.variant.pads == (pytest.approx(height), 0.0)
        low = plain[x.variant.hinges, x.variant.side]
        assert "flap" in room.obstacles[low.number] and "flap" not in room.obstacles[x.number]
        assert room.blocked[x.number].sum() < room.blocked[low.number].sum()


def test_nothing_is_raised_over_what_stands_open(problem: Make, beside_a_flap: tuple[Part, ...]) -> None:
    made = problem(beside_a_flap, slanting=False)
    room = found(made, open_scene(made), "a")
    assert any("flap" in room.obstacles[x.number] for x in room.lanes["a"])
    assert not any(any(x.variant.pads) for many in room.lanes.values() for x in many)


@pytest.mark.parametrize(("height", "is_raised"), [(102, True), (106, False)])
def test_plinths_do_not_draw_a_chain_back_from_what_stands_open(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part], box: Callable[..., Part],
    height: float, is_raised: bool,
) -> None:  # fmt: skip
    """On a plinth over the folded flap the higher wall would only just swing past the other, by what it takes."""
    walls = (wall_at("a", -50, 0, height, 20, 20), wall_at("b", 50, 0, height))
    made = problem((board_at("ground", 0, 240), *walls, box("flap", (0, 30, 17), (60, 4, 30))))
    options = found(made, after_folding(made, "flap"), "a")
    towards = [x for x in pick(options.lanes["a"], "slanted", "+") if any(x.variant.pads)]
    assert bool(towards) == is_raised
    assert not is_raised or not options.blocked[towards[0].number].any()
    (plain,) = (x for x in pick(options.lanes["a"], "slanted", "+") if not any(x.variant.pads))
    assert options.blocked[plain.number].all() and ("b" in options.obstacles[plain.number]) != is_raised


def test_nothing_is_raised_where_there_is_room(problem: Make, beside_a_flap: tuple[Part, ...]) -> None:
    made = problem(beside_a_flap, slanting=False)
    room = found(made, after_folding(made, "flap"), "b")
    assert not any(any(x.variant.pads) for x in room.lanes["b"])


def test_slanted_partners_are_raised_together(problem: Make, beside_a_flap: tuple[Part, ...]) -> None:
    """Both walls drag the ceiling along one way, so both stand on plinths or neither does."""
    made = problem(beside_a_flap)
    room = found(made, after_folding(made, "flap"), "a")
    pads = {
        p: {x.variant.pads for x in room.lanes[p] if x.variant.mechanism == "slanted" and any(x.variant.pads)}
        for p in ("a", "b")
    }
    assert pads["a"] and pads["a"] == pads["b"]


def test_plinths_take_at_most_their_share_of_the_height(
    problem: Make, beside_a_flap: tuple[Part, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = problem(beside_a_flap)
    scene = after_folding(made, "flap")
    high = max(sum(x.variant.pads) for many in found(made, scene, "a").lanes.values() for x in many)
    share = high / made.sites["a"].clear
    for most, is_raised in ((1.01 * share, True), (0.99 * share, False)):
        monkeypatch.setattr("foldfab.folding.prospects.PAD_SHARE", most)
        room = found(made, scene, "a")
        assert any(any(x.variant.pads) for many in room.lanes.values() for x in many) == is_raised


def test_who_stays_in_the_box_does_not_drag_its_base_out_of_it(problem: Make) -> None:
    made = problem("h_scaffold", stay_in_box=True)
    room = found(made, open_scene(made), "leg")
    for x in room.lanes["leg"]:
        leaves = x.variant.mechanism == "slanted"
        assert room.blocked[x.number].all() == leaves
        assert room.obstacles[x.number] == ((THE_BOX,) if leaves else ())


def test_who_has_room_in_the_box_may_slant(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    """A short ceiling over a long ground, dragged towards its middle."""
    parts = (board_at("ground", 0, 400), board_at("ceiling", 84, 60, x=-150), wall_at("leg", -150, 0, 84))
    made = problem(parts, stay_in_box=True)
    room = found(made, open_scene(made), "leg")
    (inward,), (outward,) = (pick(room.lanes["leg"], "slanted", side) for side in "+-")
    assert not room.blocked[inward.number].any() and room.blocked[outward.number].all()


def test_what_is_carried_along_must_stay_in_the_box_as_well(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    """The same, but the short ceiling carries a wide board on a wall of its own."""
    parts = (
        board_at("ground", 0, 400), board_at("ceiling", 84, 60, x=-150), wall_at("leg", -150, 0, 84),
        board_at("roof", 148, 400), wall_at("post", -150, 84, 148),
    )  # fmt: skip
    made = problem(parts, stay_in_box=True)
    room = found(made, open_scene(made), "leg")
    for side in "+-":
        (x,) = pick(room.lanes["leg"], "slanted", side)
        assert room.blocked[x.number].all() and THE_BOX in room.obstacles[x.number]


def test_what_hangs_comes_up_to_what_stays_in_the_box(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    """The tray is the lowest base of its unit, but it is the one that moves."""
    parts = (
        board_at("floor", -30, 60, 60, x=-120), wall_at("post", -120, -30, 64),
        board_at("tray", 0, 60, 60, x=60), wall_at("hanger", 60, 0, 64), board_at("middle", 64, 320),
    )  # fmt: skip
    made = problem(parts, stay_in_box=True)
    room = found(made, open_scene(made), "hanger", in_place=True)
    assert room.lanes["hanger"] and not any(room.blocked[x.number].any() for x in room.lanes["hanger"])
