"""A fold played through shows what meets: panels, what stands around, and what the bases carry."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding import press, simulate
from foldfab.folding.congruent import repertoire
from foldfab.folding.model import Chain
from foldfab.folding.press import Motion
from foldfab.folding.problem import Problem
from foldfab.folding.scene import Scene, open_scene, shown
from foldfab.folding.simulate import clashes
from foldfab.folding.surroundings import look
from foldfab.folding.unit_fold import UnitFold
from foldfab.folding.units import Unit
from foldfab.recipe.model import Part

from . import every

Make = Callable[..., Problem]
Folded = Callable[[Problem], tuple[Scene, list[tuple[Scene, UnitFold]]]]
NAMES = (
    "three_walls",
    "deep_box",
    "box_with_table",
    "shelf",
    "tower",
    "chair",
    "two_lean",
    "same_way",
    "roof",
    "beside",
)


def met(made: Problem, scene: Scene, unit: Unit, chains: tuple[Chain, ...], motion: Motion) -> set[tuple[str, str]]:
    around = look(made, scene, repertoire(made, unit))
    return {(min(pair), max(pair)) for pair in clashes(unit, made.tree.number, chains, motion, around, made.thickness)}


def widened(chain: Chain, low: float, high: float) -> Chain:
    """The chain with panels and hinges of another extent."""
    return replace(chain, span=np.array([low, high]), hinge_spans=np.tile([low, high], (len(chain.lengths) + 1, 1)))


def whole(made: Problem, patch: str, hinges: int, towards: float, mechanism: str = "in-place") -> Chain:
    """The whole patch folding with its first panel towards one side of the world, +1 or -1."""
    own = every.whole(made, made.unit_of[patch])
    (found,) = (
        x.chain
        for x in own.plain[patch]
        if (x.variant.mechanism, x.variant.hinges) == (mechanism, hinges)
        and np.sign(x.chain.turn * x.chain.across.sum()) == towards
    )
    return found


def played(made: Problem, unit: Unit, chains: tuple[Chain, ...], way: dict[str, float]) -> Motion:
    return press.in_place(unit.bases, way, chains, made.thickness.gap)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("slanting", [True, False])
def test_valid_folds_have_no_clash(problem: Make, folded: Folded, name: str, slanting: bool) -> None:
    made = problem(name, slanting=slanting)
    _, steps = folded(made)
    assert steps
    for scene, fold in steps:
        assert met(made, scene, fold.unit, fold.chains, fold.motion) == set()


def test_panels_that_fold_into_each_other_are_found(problem: Make, folded: Folded) -> None:
    """The back of the three walls, as wide as it was before it had to shrink."""
    made = problem("three_walls")
    _, ((scene, fold),) = folded(made)
    chains = tuple(widened(c, -100.0, 100.0) if c.patch == "back" else c for c in fold.chains)
    found = met(made, scene, fold.unit, chains, fold.motion)
    assert found and found <= {("back", "left"), ("back", "right")}


def test_what_stands_in_the_way_is_found(problem: Make) -> None:
    made = problem("beside", slanting=False)
    unit = made.unit_of["wall"]
    way = {"ground": 0.0, "ceiling": 80.0 - 8.9}
    into, away = (whole(made, "wall", 1, towards) for towards in (-1.0, 1.0))
    found = [met(made, open_scene(made), unit, (c,), played(made, unit, (c,), way)) for c in (into, away)]
    # A flap 6 mm to the right, under the ceiling that comes down.
    assert all(("ceiling", "flap") in pairs for pairs in found)
    assert [("flap", "wall") in pairs for pairs in found].count(True) >= 1


def test_bases_that_come_down_on_each_other_are_found(problem: Make, folded: Folded) -> None:
    made = problem("h_scaffold", slanting=False)
    _, ((scene, fold),) = folded(made)
    sunk = replace(fold.motion, shift={b: 1.2 * way for b, way in fold.motion.shift.items()})
    assert ("ceiling", "ground") in met(made, scene, fold.unit, (), sunk)
    assert met(made, scene, fold.unit, (), fold.motion) == set()


def test_a_clash_between_what_two_bases_carry_is_found(problem: Make) -> None:
    """The ceiling of the box comes down on the table that still stands in it."""
    made = problem("box_with_table", slanting=False)
    scene, unit = open_scene(made), made.unit_of["left"]
    chains = tuple(whole(made, p, 1, towards) for p, towards in (("left", 1.0), ("right", -1.0)))
    found = met(made, scene, unit, chains, played(made, unit, chains, {"ground": 0.0, "ceiling": 100.0 - 8.9}))
    assert {("ceiling", "top"), ("ceiling", "leg-left"), ("ceiling", "leg-right")} <= found


def test_a_clash_is_found_wherever_it_is_in_time(
    problem: Make, folded: Folded, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The fold is looked at in scenes; each of them hands its last frame on to the next."""
    made = problem("h_scaffold", slanting=False)
    _, ((scene, fold),) = folded(made)
    monkeypatch.setattr(simulate, "STRIDE", 1)
    count = len(fold.motion.samples)
    for scene_length in (1, 7, 40):
        monkeypatch.setattr(simulate, "SCENE", scene_length)
        for when in (0, 6, 7, 8, count // 2, count - 1):
            way = np.zeros((count, 3))
            way[when, 2] = -80.5
            motion = replace(fold.motion, shift={"ground": np.zeros((count, 3)), "ceiling": way})
            assert met(made, scene, fold.unit, (), motion) == {("ceiling", "ground")}, (scene_length, when)


def test_in_a_unit_of_several_levels_clashes_are_found_at_each_level(
    problem: Make, folded: Folded, levels: tuple[Part, ...]
) -> None:
    made = problem(levels, slanting=False)
    _, ((scene, fold),) = folded(made)
    assert met(made, scene, fold.unit, fold.chains, fold.motion) == set()
    # The middle board goes too low, or does not move at all.
    for change, expected in ((1.3, ("low", "middle")), (0.0, ("high", "middle"))):
        shift = {**fold.motion.shift, "middle": change * fold.motion.shift["middle"]}
        assert expected in met(made, scene, fold.unit, (), replace(fold.motion, shift=shift))


def test_a_chain_that_rests_while_another_folds_is_in_its_way(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    """The upper wall folds first; the tall one, folding meanwhile, meets it and the lower one, which still stands."""
    parts = (
        board_at("low", 0), board_at("middle", 64, 60, x=-50), board_at("high", 128),
        wall_at("lower", -40, 0, 64), wall_at("upper", -40, 64, 128), wall_at("side", 0, 0, 128),
    )  # fmt: skip
    made = problem(parts, slanting=False)
    unit = made.unit_of["side"]
    way = {"low": 0.0, "middle": 60.0 - 8.9, "high": 124.0 - 8.9 - 4 - 8.9}
    for towards in itertools.product((1.0, -1.0), repeat=3):
        chains = tuple(whole(made, p, 1, t) for p, t in zip(("lower", "upper", "side"), towards, strict=True))
        motion = played(made, unit, chains, way)
        inwards = towards[-1] < 0
        expected = {("lower", "side"), ("side", "upper"), ("middle", "side")} if inwards else set()
        assert met(made, open_scene(made), unit, chains, motion) == expected
        # While the lower wall stands still, before the middle board starts.
        until = int(np.argmax(motion.fold["lower"] > 0))
        assert until > simulate.STRIDE
        first = replace(
            motion, samples=motion.samples[:until], shift={b: w[:until] for b, w in motion.shift.items()},
            fold={p: f[:until] for p, f in motion.fold.items()},
        )  # fmt: skip
        assert (("lower", "side") in met(made, open_scene(made), unit, chains, first)) == inwards


def test_a_chain_shown_with_its_hinges_is_seen_by_others(problem: Make, folded: Folded) -> None:
    """What stands around a fold takes part as it is shown, knuckles and all."""
    made = problem("box_with_table", slanting=False)
    _, ((scene, fold), _) = folded(made)
    later = made.unit_of["left"]
    wall = whole(made, "left", 1, 1.0)
    # Moved so that it stands in the table's leg.
    inside = replace(wall, root=wall.root + np.array([110.0, 0.0, 0.0]))
    crowded = shown(scene, later.patches, (inside,), is_folded=False)
    found = met(made, crowded, fold.unit, fold.chains, fold.motion)
    assert ("left", "leg-left") in found


def test_a_slanted_fold_is_carried_into_what_its_base_carries(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part], box: Callable[..., Part]
) -> None:
    """A wall drags the ceiling, and the board that hangs from its end goes through a flap."""
    parts = (
        board_at("ground", 0, 400), board_at("ceiling", 84, 300, x=-50), wall_at("wall", -150, 0, 84),
        box("flap", (130, 0, 30), (4, 40, 56)), box("hanging", (90, 0, 60), (4, 40, 44)),
    )  # fmt: skip
    made = problem(parts)
    unit, scene = made.unit_of["wall"], open_scene(made)
    found = []
    for towards in (1.0, -1.0):
        chain = whole(made, "wall", 0, towards, "slanted")
        found.append(met(made, scene, unit, (chain,), press.slanted(unit.bases, (chain,))))
    assert ("flap", "hanging") in found[0] and ("flap", "hanging") not in found[1]


def test_chains_that_rest_are_found_in_what_stands_around_and_in_each_other(problem: Make, folded: Folded) -> None:
    made = problem("box_with_table", slanting=False)
    unit = made.unit_of["left"]
    wall = whole(made, "left", 1, 1.0)
    inside = replace(wall, root=wall.root + np.array([110.0, 0.0, 0.0]))
    motion = played(made, unit, (wall,), {"ground": 0.0, "ceiling": 91.1})
    still = replace(
        motion, fold={"left": np.zeros(len(motion.samples))}, shift={b: 0 * w for b, w in motion.shift.items()}
    )
    assert met(made, open_scene(made), unit, (inside,), still) == {("left", "leg-left"), ("left", "top")}
    assert met(made, open_scene(made), unit, (wall,), still) == set()
    made = problem("three_walls")
    _, ((scene, fold),) = folded(made)
    # The back stands between the side walls and reaches through both; only the right one moves.
    chains = tuple(
        replace(widened(c, -115.0, 115.0), root=c.root * [1, 0, 1]) if c.patch == "back" else c for c in fold.chains
    )
    moving = {p: f if p == "right" else 0 * f for p, f in fold.motion.fold.items()}
    fixed = replace(fold.motion, fold=moving, shift={b: 0 * w for b, w in fold.motion.shift.items()})
    assert ("back", "left") in met(made, scene, fold.unit, chains, fixed)
    assert ("back", "left") not in met(made, scene, fold.unit, fold.chains, fixed)
