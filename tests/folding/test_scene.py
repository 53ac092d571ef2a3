"""A scene keeps what a fold does not touch, and shows the rest as it became."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding import anatomy
from foldfab.folding.ordering import after
from foldfab.folding.problem import Problem
from foldfab.folding.scene import Scene, Solid, advanced, alone, open_scene, shown
from foldfab.folding.site import slab
from foldfab.folding.unit_fold import UnitFold, fold_unit
from foldfab.geometry.boxes import bounds

Make = Callable[..., Problem]


@pytest.fixture
def table_in_box(problem: Make) -> Problem:
    return problem("box_with_table", slanting=False)


@pytest.fixture
def table_fold(table_in_box: Problem) -> UnitFold:
    """How the table in the box folds."""
    fold = fold_unit(table_in_box, open_scene(table_in_box), table_in_box.unit_of["leg-left"])
    assert isinstance(fold, UnitFold)
    return fold


def solids_of(scene: Scene, patch: str) -> list[Solid]:
    return [scene.solids[i] for i in scene.places[patch]]


def present(scene: Scene) -> set[str]:
    """Owners of all that is there."""
    return {s.owner for s, base in zip(scene.solids, scene.base, strict=True) if base >= 0}


def assert_consistent(scene: Scene) -> None:
    """The arrays say of every solid that is there what the solid says itself."""
    assert len(scene.solids) == len(scene.low) == len(scene.high) == len(scene.base)
    for i in np.nonzero(scene.base >= 0)[0]:
        solid = scene.solids[i]
        low, high = bounds(solid.boxes)
        assert scene.base[i] == solid.base
        assert (scene.low[i] == low.min(0)).all() and (scene.high[i] == high.max(0)).all()
    places = {i for patch in scene.places.values() for i in patch}
    plates = {i for i, s in enumerate(scene.solids) if s.state == "base"}
    assert {int(i) for i in np.nonzero(scene.base >= 0)[0]} <= places | plates


def test_the_open_scene_holds_a_plate_for_each_base_and_a_panel_for_each_patch(table_in_box: Problem) -> None:
    scene = open_scene(table_in_box)
    assert_consistent(scene)
    assert [s.owner for s in scene.solids if s.state == "base"] == ["ground", "top", "ceiling"]
    assert sorted(s.owner for s in scene.solids if s.state == "open") == ["left", "leg-left", "leg-right", "right"]
    (leg,) = solids_of(scene, "leg-left")
    site = table_in_box.sites["leg-left"]
    assert leg.base == table_in_box.tree.number[site.anchor]
    assert leg.boxes.center == pytest.approx(slab(site, table_in_box.thickness).center)
    assert not scene.offset.any() and not scene.done and not scene.gone and not scene.chains


def test_a_fold_leaves_the_scene_before_it_as_it_was(table_in_box: Problem, table_fold: UnitFold) -> None:
    before = open_scene(table_in_box)
    low, base, places = before.low.copy(), before.base.copy(), dict(before.places)
    after(table_in_box, before, table_fold)
    assert (before.low == low).all() and (before.base == base).all() and before.places == places
    assert not before.offset.any() and present(before) == {*("ground", "top", "ceiling"), *table_in_box.unit_of}


def test_a_fold_keeps_all_that_does_not_belong_to_its_unit(table_in_box: Problem, table_fold: UnitFold) -> None:
    before = open_scene(table_in_box)
    now = after(table_in_box, before, table_fold)
    for patch in ("left", "right"):
        (old,), (new,) = solids_of(before, patch), solids_of(now, patch)
        assert new is old
    assert now.solids[:3] == before.solids[:3]


def test_after_a_fold_its_patches_lie_folded_on_their_bases(table_in_box: Problem, table_fold: UnitFold) -> None:
    now = after(table_in_box, open_scene(table_in_box), table_fold)
    assert_consistent(now)
    number = table_in_box.tree.number
    for chain in table_fold.chains:
        near, far = solids_of(now, chain.patch)
        assert (near.state, near.base) == ("folded", number["ground"])
        assert (far.state, far.base) == ("folded", number["top"])
        expected = anatomy.resting_boxes(chain, table_in_box.thickness, 1.0)
        assert near.boxes.center == pytest.approx(expected.center)
        assert far.boxes.center == pytest.approx(anatomy.far_feet(chain, table_in_box.thickness).center)
    assert now.done == {"leg-left"} and set(now.chains) == {"leg-left", "leg-right"} and not now.gone


def test_after_a_fold_bases_stand_where_it_took_them(table_in_box: Problem, table_fold: UnitFold) -> None:
    scene = open_scene(table_in_box)
    down = table_fold.motion.shift["top"][-1]
    assert down[2] < -20
    now = after(table_in_box, scene, table_fold)
    assert now.moved("top") == pytest.approx(down)
    assert not now.moved("ground").any() and not now.moved("ceiling").any()
    again = advanced(now, table_in_box.unit_of["left"], {}, (), np.ones((3, 3)))
    assert again.moved("top") == pytest.approx(down + 1) and again.moved("ground") == pytest.approx(np.ones(3))


def test_patches_without_a_chain_are_gone(table_in_box: Problem, table_fold: UnitFold) -> None:
    kept = [c for c in table_fold.chains if c.patch == "leg-left"]
    now = advanced(open_scene(table_in_box), table_fold.unit, table_fold.chosen, kept, np.zeros((3, 3)))
    assert_consistent(now)
    assert now.gone == {"leg-right"} and now.places["leg-right"] == ()
    assert "leg-right" not in present(now) and "leg-left" in present(now)


def test_a_unit_may_be_shown_open_with_its_hinges_without_being_folded(
    table_in_box: Problem, table_fold: UnitFold
) -> None:
    scene = open_scene(table_in_box)
    now = shown(scene, table_fold.unit.patches, table_fold.chains, is_folded=False)
    assert_consistent(now)
    assert present(now) == present(scene)
    assert not now.done and not now.offset.any() and not now.chains
    for chain in table_fold.chains:
        near, far = solids_of(now, chain.patch)
        assert near.state == far.state == "open"
        expected = anatomy.resting_boxes(chain, table_in_box.thickness, 0.0)
        assert near.boxes.center == pytest.approx(expected.center)
    assert len(solids_of(now, "leg-left")[0].boxes) > len(solids_of(scene, "leg-left")[0].boxes)


def test_what_is_shown_anew_takes_the_place_of_what_was_shown_before(
    table_in_box: Problem, table_fold: UnitFold
) -> None:
    once = shown(open_scene(table_in_box), table_fold.unit.patches, table_fold.chains, is_folded=False)
    twice = shown(once, table_fold.unit.patches, table_fold.chains, is_folded=True)
    assert_consistent(twice)
    assert {s.state for p in ("leg-left", "leg-right") for s in solids_of(twice, p)} == {"folded"}
    states = [s.state for s, base in zip(twice.solids, twice.base, strict=True) if base >= 0]
    assert states.count("folded") == 4 and states.count("open") == 2


def test_a_unit_alone_has_its_patches_and_its_bases_where_they_were(
    table_in_box: Problem, table_fold: UnitFold
) -> None:
    scene = open_scene(table_in_box)
    table = table_in_box.unit_of["leg-left"]
    assert present(alone(scene, table)) == {"ground", "top", "leg-left", "leg-right"}
    now = alone(after(table_in_box, scene, table_fold), table_in_box.unit_of["left"])
    assert_consistent(now)
    assert present(now) == {"ground", "ceiling", "left", "right"}
    assert now.done == {"leg-left"}
