"""Good solutions are valid, and each way to spoil one is found and told."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import foldfab
from foldfab.folding.model import Chain, FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, grown, overlaps
from foldfab.recipe.model import Part
from foldfab.validity import pockets, thick
from foldfab.validity.model import Body, Folding, Hinge, Linkage
from foldfab.validity.verify import judged, verdict, violations

RECIPES = sorted((Path(__file__).resolve().parents[2] / "recipes").glob("*.json"))
NAMED = ["slanted_h", "same_way", "two_ways", "corner", "passage", "three_walls", "box_with_table", "shelf", "tower"]
Solutions = Callable[..., FoldSolution]


@pytest.mark.parametrize("path", RECIPES, ids=[path.stem for path in RECIPES])
def test_shipped_recipes_are_valid(path: Path) -> None:
    found = verdict(foldfab.foldabilize(foldfab.load(str(path))))
    assert [v.text for v in found.violations] == []
    assert found.moments > 50


@pytest.mark.parametrize("path", RECIPES, ids=[path.stem for path in RECIPES])
def test_shipped_recipes_are_valid_along_every_axis(path: Path) -> None:
    """With thickness and without; where an axis is refused, nothing is claimed."""
    for axis in ("-x", "-y", "-z"):
        recipe = foldfab.load(str(path), direction=axis, ordering="greedy")
        try:
            solution = foldfab.foldabilize(recipe)
        except foldfab.FoldfabError:
            continue
        assert [v.text for v in violations(solution)] == []


@pytest.mark.parametrize("name", NAMED)
def test_small_furniture_is_valid(name: str, solution: Solutions) -> None:
    assert [v.text for v in violations(solution(name))] == []


def test_it_shares_nothing_with_the_search() -> None:
    code = "import sys, foldfab.validity.verify; print(*(m for m in sys.modules if m.startswith('foldfab.folding.')))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, encoding="utf-8", check=True)
    assert set(run.stdout.split()) == {"foldfab.folding.model", "foldfab.folding.mechanism"}


def with_chain(solution: FoldSolution, patch: str, **changes: Any) -> FoldSolution:
    """The solution with a chain that is made otherwise."""
    return replace(solution, chains=tuple(replace(c, **changes) if c.patch == patch else c for c in solution.chains))


def with_modification(solution: FoldSolution, patch: str, **changes: Any) -> FoldSolution:
    """The solution with another statement about a patch."""
    made = tuple(replace(m, **changes) if m.patch == patch else m for m in solution.modifications)
    return replace(solution, modifications=made)


def with_step(solution: FoldSolution, number: int, **changes: Any) -> FoldSolution:
    """The solution with a step that is made otherwise."""
    steps = tuple(replace(s, **changes) if i == number else s for i, s in enumerate(solution.steps))
    return replace(solution, steps=steps)


def turned(chain: Chain) -> dict[str, Any]:
    """What makes an upright chain fold to its other side."""
    return {"turn": -chain.turn, "offsets": -chain.offsets}


def kinds(solution: FoldSolution) -> set[str]:
    """The kinds of violations of a solution."""
    return {v.kind for v in violations(solution)}


def test_a_side_that_is_stated_otherwise(solution: Solutions) -> None:
    good = solution("h_scaffold")
    other: dict[str | None, Any] = {"l": "r", "r": "l"}
    (found,) = violations(with_modification(good, "leg", side=other[good.modification("leg").side]))
    assert found.kind == "start" and found.parts == ("leg",)
    assert found.text == "at t = 0: leg folds to another side than is stated"


@pytest.mark.parametrize(
    ("patch", "changes", "words"),
    [
        ("side", {"window": (0.4, 0.6)}, "out of its window"),
        ("side", {"window": (0.0, 1.4)}, "out of its window"),
        ("side", {"hinges": 3}, "is stated in-place with 3 hinges but is in-place with 1"),
        ("side", {"mechanism": "slanted", "hinges": 0}, "is stated slanted"),
        ("side", {"mechanism": "deleted", "hinges": 0, "side": None, "window": (0.0, 0.0)}, "is deleted but has 1"),
    ],
)
def test_modifications_that_do_not_fit(patch: str, changes: dict[str, Any], words: str, solution: Solutions) -> None:
    found = violations(with_modification(solution("corner"), patch, **changes))
    assert {v.kind for v in found} == {"start"}
    assert any(words in v.text for v in found)


def test_a_patch_modified_twice_or_never(solution: Solutions) -> None:
    good = solution("corner")
    twice = replace(good, modifications=(*good.modifications, good.modifications[0]))
    never = replace(good, modifications=good.modifications[1:])
    assert "has 2 modifications" in violations(twice)[0].text
    assert "has 0 modifications" in violations(never)[0].text


@pytest.mark.parametrize(
    "change",
    [
        lambda c: {"root": c.root + 0.01 * c.across},
        lambda c: {"root": c.root + 0.01 * c.rise},
        lambda c: {"lean": c.lean + 0.001},
        lambda c: {"lengths": c.lengths * np.array([1.01, 0.99])},
        lambda c: {"lengths": c.lengths * 1.01},
        lambda c: {"pads": (1.0, 0.0)},
        lambda c: {"far": "ground"},
        lambda c: {"span": c.span + 1.0},
    ],
)
def test_chains_that_are_not_their_patches(change: Callable[[Chain], dict[str, Any]], solution: Solutions) -> None:
    good = solution("h_scaffold", slanting=False)
    assert kinds(with_chain(good, "leg", **change(good.chain("leg")))) == {"start"}


def test_a_part_that_must_not_be_split(solution: Solutions) -> None:
    good = solution("h_scaffold", slanting=False)
    rigid = replace(good.scaffold, patches=tuple(replace(p, hingeable=False) for p in good.scaffold.patches))
    assert "more than it may" in violations(replace(good, scaffold=rigid))[0].text


def test_steps_that_do_not_follow_one_another(solution: Solutions) -> None:
    good = solution("box_with_table")
    assert len(good.steps) == 2
    assert kinds(replace(good, steps=good.steps[:1])) == {"start"}
    assert kinds(with_step(good, 1, start=good.steps[1].start + 0.01)) == {"start"}
    assert kinds(replace(good, steps=good.steps[::-1])) == {"start"}


def test_another_order(solution: Solutions) -> None:
    """The ceiling comes down on the table that is still open."""
    good = solution("box_with_table")
    first, second = good.steps
    assert "top" in first.travel and np.ptp(first.travel["top"]) > 0
    cut = 1 - first.end
    swapped = replace(good, steps=(replace(second, start=0.0, end=cut), replace(first, start=cut, end=1.0)))
    found = violations(swapped)
    assert {(v.kind, v.model) for v in found} >= {("collision", "with thickness"), ("collision", "without thickness")}
    assert any({"top", "ceiling"} == set(v.parts) for v in found)


def test_a_fold_that_starts_half_folded(solution: Solutions) -> None:
    good = solution("t_scaffold")
    fold = {"leg": np.linspace(0.2, 1.0, len(good.steps[0].samples))}
    found = violations(with_step(good, 0, fold=fold))
    assert [v.kind for v in found] == ["start"]
    assert "is turned by" in found[0].text and "at the start" in found[0].text


def test_a_fold_that_stays_open(solution: Solutions) -> None:
    good = solution("t_scaffold")
    (found,) = violations(with_step(good, 0, fold={"leg": 0.9 * good.steps[0].fold["leg"]}))
    assert (found.kind, found.time, found.parts) == ("flat", 1.0, ("leg",))
    assert found.amount == pytest.approx(0.05 * np.pi)
    assert found.text == "with thickness, at t = 1.000: leg is 9.00° from lying flat"


def test_a_hinge_that_breaks(solution: Solutions) -> None:
    """One wall lags behind the other, so that the ceiling cannot hang on both."""
    good = solution("corner")
    fold = dict(good.steps[0].fold)
    fold["side"] = fold["side"] ** 2
    found = violations(with_step(good, 0, fold=fold))
    broken = [v for v in found if v.kind == "hinge" and "breaks" in v.text]
    assert broken and broken[0].model == "with thickness" and broken[0].amount > 1.0


def test_a_base_that_is_said_to_be_elsewhere(solution: Solutions) -> None:
    good = solution("h_scaffold")
    travel = {base: 1.01 * way for base, way in good.steps[0].travel.items()}
    (found,) = violations(with_step(good, 0, travel=travel))
    assert found.kind == "hinge" and found.parts == ("ceiling",)


def test_a_chain_that_cannot_close(solution: Solutions) -> None:
    good = solution("slanted_h", slanting=False)
    spoilt = with_chain(good, "leg", **turned(good.chain("leg")))
    found = judged(thick.folding(spoilt))
    assert {v.kind for v in found} == {"hinge"}
    assert "no angle closes the hinge of" in found[0].text
    assert kinds(spoilt) == {"start"}


def test_too_much_play(solution: Solutions) -> None:
    good = solution("h_scaffold", slanting=False)
    lifted = np.sin(np.pi * np.linspace(0.0, 1.0, len(good.steps[0].samples)))
    found = violations(with_step(good, 0, play={"leg": lifted}))
    assert any("each hinge of leg has to give 0.333 mm" in v.text for v in found)


def test_walls_that_fold_into_each_other(solution: Solutions, wall_at: Any, board_at: Any) -> None:
    """Both to the same side is valid; towards each other their elbows cross."""
    parts = (board_at("ground", 0), board_at("ceiling", 84), wall_at("left", -15, 0, 84), wall_at("right", 15, 0, 84))
    good = solution(parts, slanting=False)
    assert violations(good) == ()
    spoilt, wanted = good, {"left": 1.0, "right": -1.0}
    for patch, side in wanted.items():
        chain = good.chain(patch)
        if np.sign(chain.turn * chain.across[0]) != side:
            spoilt = with_chain(spoilt, patch, **turned(chain))
            letter: Any = {"l": "r", "r": "l"}[str(good.modification(patch).side)]
            spoilt = with_modification(spoilt, patch, side=letter)
    met = [v for v in violations(spoilt) if v.kind == "collision"]
    assert {v.model for v in met} == {"with thickness", "without thickness"}
    assert {part.split("/")[0] for part in met[0].parts} == {"left", "right"}
    assert any(v.parts == ("ground", "left/1") for v in met), "it lands on the other wall's foot"
    assert {v.kind for v in violations(spoilt)} == {"collision"}


def test_furniture_that_falls_apart(solution: Solutions) -> None:
    good = solution("tower")
    gone = replace(good, chains=tuple(c for c in good.chains if c.patch != "b"))
    gone = with_modification(gone, "b", mechanism="deleted", hinges=0, side=None, window=(0.0, 0.0))
    steps = [replace(s, **{k: without(getattr(s, k), "b") for k in ("fold", "play")}) for s in gone.steps]
    found = violations(replace(gone, steps=tuple(steps)))
    assert ("apart", ("high",)) in {(v.kind, v.parts) for v in found}


def without(values: dict[str, Array], name: str) -> dict[str, Array]:
    """A dictionary without one name."""
    return {key: value for key, value in values.items() if key != name}


def test_any_linkage_is_judged(table: Linkage, folding: Callable[..., Folding]) -> None:
    made = folding(table.bodies, table.hinges, lambda t: np.outer(t, np.full(4, np.pi / 2)))
    assert judged(made) == []
    uneven = folding(table.bodies, table.hinges, lambda t: np.outer(t, np.full(4, np.pi / 2)) * [1, 1, t[-1] / 2, 1])
    assert {v.kind for v in judged(uneven)} >= {"hinge", "flat"}


def test_a_base_that_tips_over(sheet: Callable[..., Body], hinge: Callable[..., Hinge], folding: Any) -> None:
    bodies = [sheet("ground", (0, 0), (60, 0), base=True), sheet("lid", (10, 5), (60, 5), base=True)]
    made = folding(bodies, [hinge("ground", "lid", 10, 5)], lambda t: np.outer(np.sin(np.pi * t), [-0.5]))
    assert [(v.kind, v.parts) for v in judged(made)] == [("flat", ("lid",))]


@pytest.fixture(scope="module")
def sunk(solution: Solutions, pair: Callable[..., tuple[Part, ...]]) -> FoldSolution:
    """Whose chain `three` stands in a pocket of 1.4 mm in each of its bases of 4 mm."""
    return solution(pair(74), slanting=False)


def test_chains_in_pockets_are_valid(sunk: FoldSolution) -> None:
    assert min(sunk.chain("three").pads) < 0 and violations(sunk) == ()


def test_a_pocket_that_is_too_deep(sunk: FoldSolution) -> None:
    """A skin of 1.2 mm has to be left."""
    chain = sunk.chain("three")
    for more, left in ((1.5, "1.10"), (3.0, "0.00")):
        pads = (chain.pads[0] - more, chain.pads[1])
        lengths = chain.lengths + more / len(chain.lengths)
        deeper = with_chain(sunk, "three", root=chain.root - [0, 0, more], pads=pads, lengths=lengths)
        (found,) = violations(deeper)
        assert found.kind == "start" and found.parts == ("three",)
        assert found.text.endswith(f"sinks {1.4 + more:.2f} mm into ground and leaves {left} mm of it")


def test_a_pocket_that_is_not_as_deep_as_the_chain_stands(sunk: FoldSolution) -> None:
    (found, *_) = violations(with_chain(sunk, "three", pads=(-1.0, sunk.chain("three").pads[1])))
    assert found.kind == "start" and found.text.endswith("three ends 0.40 mm off its place over ground")


def test_a_chain_that_sinks_where_there_is_no_pocket(sunk: FoldSolution, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(thick, "pockets_in", lambda solution, base: [])
    found = [v for v in violations(sunk) if v.kind == "collision"]
    assert {v.parts for v in found} == {("ground", "three/1"), ("ceiling", "three/4")}
    assert all(v.amount == pytest.approx(1.1, abs=0.06) for v in found)


def test_a_chain_that_folds_out_of_its_pocket(sunk: FoldSolution) -> None:
    """The pocket is where its panels lie, and nowhere else."""
    chain = sunk.chain("three")
    for base, end in (("ground", 0), ("ceiling", 1)):
        (pocket,) = pockets.pockets_in(sunk, base)
        aside = (pocket.room.center[0] - chain.root) @ chain.across * np.sign(chain.turn)
        assert aside > 0 and pocket.up == (1.0, -1.0)[end] and pocket.depth == pytest.approx(1.4)


@pytest.fixture(scope="module")
def storeys(solution: Solutions, pair: Callable[..., tuple[Part, ...]]) -> FoldSolution:
    """Two such pairs on top of each other: the middle board has pockets in both faces."""
    walls = pair(74)
    upper = [replace(p, name=f"{p.name}-up", center=p.center + np.array([0.0, 0.0, 74.0])) for p in walls[1:]]
    return solution((*walls, *upper), slanting=False)


def test_pockets_in_both_faces_leave_a_skin(storeys: FoldSolution) -> None:
    assert violations(storeys) == () and len(pockets.pockets_in(storeys, "ceiling")) == 2


def test_pockets_that_overlap(storeys: FoldSolution) -> None:
    chain = storeys.chain("three-up")
    deeper = with_chain(
        storeys, "three-up", root=chain.root - [0, 0, 0.5], pads=(chain.pads[0] - 0.5, chain.pads[1]),
        lengths=chain.lengths + 0.5 / len(chain.lengths),
    )  # fmt: skip
    (found,) = violations(deeper)
    assert found.kind == "start" and found.parts == ("three",)
    assert found.text.endswith("three sinks into ceiling below the pocket of three-up, 0.70 mm apart")
    # Where one does not lie over the other, each may be as deep.
    heights = {b.name: (b.bottom - 2.0, b.top + 2.0) for b in storeys.scaffold.bases}
    aside = with_chain(deeper, "three-up", root=deeper.chain("three-up").root - [60, 0, 0])
    assert list(pockets.unsound(deeper, heights)) and not list(pockets.unsound(aside, heights))


def test_a_pocket_in_a_base_of_several_heights(sunk: FoldSolution) -> None:
    ground, ceiling = sunk.scaffold.bases
    outlines = (replace(ground.outlines[0], extent=(-2.0, 2.0)),)
    stepped = replace(sunk.scaffold, bases=(replace(ground, outlines=outlines), ceiling))
    (found,) = violations(replace(sunk, scaffold=stepped))
    assert found.text.endswith("three sinks into ground, whose parts lie at several heights")


def test_a_plate_less_a_pocket_is_all_the_rest(sunk: FoldSolution) -> None:
    (pocket,) = pockets.pockets_in(sunk, "ground")
    plate = Boxes(np.zeros((1, 3)), np.eye(3)[None], np.array([[120.0, 40.0, 2.0]]))
    left = pockets.without(plate, [pocket])
    volumes = [8 * float(boxes.half.prod(axis=1).sum()) for boxes in (plate, left, pocket.room)]
    assert volumes[1] == pytest.approx(volumes[0] - volumes[2])
    i, j = np.triu_indices(len(left), 1)
    assert not overlaps(grown(left[i], -1e-6), left[j]).any()
    assert not overlaps(grown(left, -1e-6), Boxes(*(np.repeat(a, len(left), 0) for a in (
        pocket.room.center, pocket.room.axes, pocket.room.half)))).any()  # fmt: skip
    # One that lies askew stays whole.
    spin = np.array([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    askew = Boxes(plate.center, spin[None], plate.half)
    assert pockets.without(askew, [pocket]) is not None and len(pockets.without(askew, [pocket])) == 1
