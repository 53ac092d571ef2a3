"""What a unit sees: all that it may meet, how far its bases may come down, and the same key for the same view."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding.congruent import repertoire
from foldfab.folding.ordering import after
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import prospects
from foldfab.folding.repertoire import extend
from foldfab.folding.scene import Scene, alone, open_scene
from foldfab.folding.surroundings import Surroundings, depends_on, look
from foldfab.folding.unit_fold import UnitFold, fold_unit
from foldfab.recipe.model import Part

Make = Callable[..., Problem]
Folded = Callable[[Problem], tuple[Scene, list[tuple[Scene, UnitFold]]]]


def seen(made: Problem, scene: Scene, patch: str) -> Surroundings:
    return look(made, scene, repertoire(made, made.unit_of[patch]))


def owners(around: Surroundings) -> set[tuple[str, str]]:
    return {(s.owner, s.state) for s in around.solids}


def after_folding(made: Problem, scene: Scene, patch: str) -> Scene:
    fold = fold_unit(made, scene, made.unit_of[patch])
    assert isinstance(fold, UnitFold)
    return after(made, scene, fold)


@pytest.fixture
def in_box(problem: Make) -> Problem:
    return problem("box_with_table", slanting=False)


@pytest.fixture
def two_tables(board_at: Callable[..., Part], wall_at: Callable[..., Part]) -> tuple[Part, ...]:
    """Two small tables far apart on one board."""
    parts = [board_at("ground", 0, 600, 120)]
    for name, x in (("one", -200.0), ("two", 200.0)):
        parts += [
            board_at(name, 64, 80, 80, x=x),
            wall_at(f"{name}-l", x - 30, 0, 64),
            wall_at(f"{name}-r", x + 30, 0, 64),
        ]
    return tuple(parts)


def test_a_unit_sees_its_own_plates_and_what_stands_beside_its_patches(in_box: Problem) -> None:
    around = seen(in_box, open_scene(in_box), "left")
    assert {("ground", "base"), ("ceiling", "base"), ("top", "base")} <= owners(around)
    assert ("leg-left", "open") in owners(around)
    assert not {"left", "right"} & {s.owner for s in around.solids}


def test_a_unit_does_not_see_what_is_far_away(problem: Make, two_tables: tuple[Part, ...]) -> None:
    made = problem(two_tables)
    around = seen(made, open_scene(made), "one-l")
    assert owners(around) == {("ground", "base"), ("one", "base")}
    assert depends_on(made, made.unit_of["one-l"], around) == set()


def test_boxes_know_the_solid_and_the_cluster_that_they_belong_to(in_box: Problem) -> None:
    around = seen(in_box, open_scene(in_box), "left")
    assert [len(s.boxes) for s in around.solids] == np.bincount(around.owner).tolist()
    cluster = {s.owner: int(g) for s, g in zip((around.solids[i] for i in around.owner), around.group, strict=True)}
    assert cluster["ground"] == cluster["top"] == cluster["leg-left"] == 0 and cluster["ceiling"] == 1
    assert around.cluster.tolist() == [0, 0, 1]


def test_boxes_are_in_the_frame_in_which_the_unit_stands_open(problem: Make) -> None:
    """The upper storey of the tower, once the lower one has brought it down."""
    made = problem("tower")
    scene = open_scene(made)
    before, now = seen(made, scene, "b"), seen(made, after_folding(made, scene, "a"), "b")
    assert not before.offset.any() and now.offset[2] < -40

    def height(around: Surroundings, owner: str) -> float:
        (own,) = [b for b, i in zip(around.boxes.center[:, 2], around.owner, strict=True)
                  if around.solids[i].owner == owner]  # fmt: skip
        return float(own)

    assert height(now, "middle") == pytest.approx(height(before, "middle"))
    assert height(now, "high") == pytest.approx(height(before, "high"))


@pytest.mark.parametrize("name", ["box_with_table", "shelf", "chair", "three_walls", "deep_box", "beside", "tower"])
@pytest.mark.parametrize("slanting", [True, False])
def test_what_a_unit_does_not_see_is_not_in_its_way(problem: Make, folded: Folded, name: str, slanting: bool) -> None:
    """The same pieces are blocked by the same owners where it sees everything there is."""
    for number in range(len(problem(name, slanting=slanting).units)):
        made = problem(name, slanting=slanting)
        unit = made.units[number]
        own = repertoire(made, unit)
        for scene in (open_scene(made), *(s for s, f in folded(made)[1] if f.unit is unit)):
            near = prospects(made, own, look(made, scene, own), in_place=False)
            kept = dict(own.reach)
            own.reach.update({b: (np.full(3, -1e4), np.full(3, 1e4)) for b in unit.bases})
            every = prospects(made, own, look(made, scene, own), in_place=False)
            own.reach.update(kept)
            assert {n: b.tolist() for n, b in near.blocked.items()} == {n: b.tolist() for n, b in every.blocked.items()}
            assert near.obstacles == every.obstacles


def test_an_unfolded_table_keeps_the_ceiling_up(in_box: Problem) -> None:
    scene = open_scene(in_box)
    around = seen(in_box, scene, "left")
    flat, raised, owner = around.limits["ground", "ceiling"]
    # The table's top is as little flat as the legs that hold it up: nothing but the ground lies there.
    assert flat == pytest.approx(100 - 0.3)
    assert around.standing == {"leg-left", "leg-right"} and owner in around.standing
    assert raised == pytest.approx(102 - 46 - 0.3)


def test_a_folded_table_lets_the_ceiling_down_onto_it(in_box: Problem) -> None:
    scene = after_folding(in_box, open_scene(in_box), "leg-left")
    around = seen(in_box, scene, "left")
    flat, raised, _ = around.limits["ground", "ceiling"]
    height = 46 + scene.moved("top")[2]
    assert flat == pytest.approx(102 - height - 0.3) and raised == np.inf
    assert not around.standing


def test_alone_a_unit_has_no_limit_but_its_own_plates(in_box: Problem) -> None:
    around = seen(in_box, alone(open_scene(in_box), in_box.unit_of["left"]), "left")
    assert owners(around) == {("ground", "base"), ("ceiling", "base")}
    flat, raised, owner = around.limits["ground", "ceiling"]
    assert (flat, raised, owner) == (pytest.approx(100.0 - 0.3), np.inf, "")


def test_a_unit_depends_on_what_it_sees_and_on_what_carries_it(in_box: Problem, problem: Make) -> None:
    scene = open_scene(in_box)
    assert depends_on(in_box, in_box.unit_of["left"], seen(in_box, scene, "left")) == {"leg-left"}
    assert depends_on(in_box, in_box.unit_of["leg-left"], seen(in_box, scene, "leg-left")) == set()
    shelf = problem("shelf")
    assert depends_on(shelf, shelf.unit_of["c"], seen(shelf, open_scene(shelf), "c")) == {"a"}


def test_the_same_view_has_the_same_key(problem: Make, two_tables: tuple[Part, ...]) -> None:
    """What another table does far away changes nothing."""
    made = problem(two_tables)
    scene = open_scene(made)
    now = after_folding(made, scene, "two-l")
    one = made.unit_of["one-l"]
    assert seen(made, scene, "one-l").key == seen(made, now, "one-l").key
    assert hash(seen(made, scene, "one-l").key) == hash(seen(made, now, "one-l").key)
    assert fold_unit(made, scene, one) is fold_unit(made, now, one)


def test_another_view_has_another_key(in_box: Problem) -> None:
    scene = open_scene(in_box)
    now = after_folding(in_box, scene, "leg-left")
    keys = {
        seen(in_box, scene, "left").key, seen(in_box, scene, "leg-left").key, seen(in_box, now, "left").key,
        seen(in_box, alone(scene, in_box.unit_of["left"]), "left").key,
    }  # fmt: skip
    assert len(keys) == 4


def test_a_unit_that_must_stay_in_the_box_knows_where_it_is_and_what_it_carries(problem: Make) -> None:
    free, kept = problem("tower"), problem("tower", stay_in_box=True)
    assert not seen(free, open_scene(free), "a").bounds
    around = seen(kept, open_scene(kept), "a")
    low, high = around.bounds["middle"]
    # The middle and the high board with the wall between them.
    assert low == pytest.approx([-100, -40, 62]) and high == pytest.approx([100, 40, 130])
    assert around.bounds["low"][1] == pytest.approx([100, 40, 2])
    before, now = (seen(kept, s, "b") for s in (open_scene(kept), after_folding(kept, open_scene(kept), "a")))
    assert now.offset[2] < -40 and before.key != now.key


def test_a_dragged_base_brushes_what_stands_beside_it(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part], box: Callable[..., Part]
) -> None:
    """A slanted wall drags the board that hangs from the ceiling's end into a flap that nothing comes down on."""
    parts = (
        board_at("ground", 0, 400), board_at("ceiling", 84, 300, x=-50), wall_at("wall", -150, 0, 84),
        box("flap", (130, 0, 30), (4, 40, 56)), box("hanging", (90, 0, 60), (4, 40, 44)),
    )  # fmt: skip
    made, straight = problem(parts), problem(parts, slanting=False)
    assert ("flap", "open") in owners(seen(made, open_scene(made), "wall"))
    assert ("flap", "open") not in owners(seen(straight, open_scene(straight), "wall"))


def test_what_may_come_down_on_something_is_seen_however_far_it_is_from_the_patches(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part], box: Callable[..., Part]
) -> None:
    parts = (
        board_at("ground", 0, 600), board_at("ceiling", 84, 600), wall_at("wall", -280, 0, 84),
        box("flap", (250, 0, 30), (4, 40, 56)),
    )  # fmt: skip
    made = problem(parts, slanting=False)
    around = seen(made, open_scene(made), "wall")
    assert ("flap", "open") in owners(around)
    assert around.standing == {"flap"}


def test_a_unit_depends_on_what_carries_a_board_near_it(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    """The end of a long tray reaches into the fold; the wall that holds it stands far away."""
    parts = (
        board_at("ground", 0, 600), board_at("tray", 44, 515, x=42.5), wall_at("far", 280, 0, 44),
        board_at("ceiling", 84, 60, x=-250), wall_at("wall", -250, 0, 84),
    )  # fmt: skip
    made = problem(parts, slanting=False)
    around = seen(made, open_scene(made), "wall")
    assert owners(around) == {("ground", "base"), ("ceiling", "base"), ("tray", "base")}
    assert depends_on(made, made.unit_of["wall"], around) == {"far"}


def test_the_key_says_what_is_gone_and_only_in_the_box_where_the_unit_is(problem: Make) -> None:
    for stay_in_box in (True, False):
        made = problem("tower", stay_in_box=stay_in_box)
        scene = open_scene(made)
        key = seen(made, scene, "b").key
        assert seen(made, scene, "b").key == key
        assert seen(made, replace(scene, gone=frozenset({"a"})), "b").key != key
        lower = replace(scene, offset=scene.offset - np.array([0.0, 0.0, 5.0]))
        assert (seen(made, lower, "b").key != key) == stay_in_box


def test_a_scene_is_looked_at_once_until_a_unit_can_do_more(in_box: Problem) -> None:
    own = repertoire(in_box, in_box.units[0])
    scene = open_scene(in_box)
    first = look(in_box, scene, own)
    assert look(in_box, scene, own) is first
    assert look(in_box, replace(scene, offset=scene.offset.copy()), own) is not first
    extend(in_box, own, own.unit.patches[:1])
    assert look(in_box, scene, own) is not first
