"""What is said about a fold and a print."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from foldfab import report
from foldfab.fabrication.model import LEVEL, Assembly, Body, Finding, Joint
from foldfab.folding.model import FoldSolution, Modification, Step, Thickness
from foldfab.recipe.read import parse
from foldfab.scaffold.model import BasePatch, Outline, Patch, Scaffold

STILL = Modification("back", "slanted", 0, "l", (0.0, 1.0), 0.5, 0.0)
SPLIT = Modification("seat", "in-place", 1, "r", (0.2, 1.0), 0.5, 0.1, "to come straight down")
GONE = Modification("bar", "deleted", 0, None, (0.0, 0.0), 0.1, 0.05, "because of seat")


def step(number: int, *patches: str) -> Step:
    """A step that moves nothing."""
    return Step(patches[0], patches, number / 2, (number + 1) / 2, np.array([0.0, 1.0]), {}, {}, {})


def solution() -> FoldSolution:
    """A chair of nothing much, folded along -x in two steps."""
    box = {"center": [0, 0, 0], "size": [1, 1, 1]}
    recipe = parse({"about": "A chair.", "parts": [{"name": "seat", "box": box}]}, "chair.json", "chair")
    outline = Outline("side", np.zeros(2), np.array([1.0, 0.0]), np.ones(2))
    patches = tuple(
        Patch(name, (name,), np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 0, 1.0]), 10, 20, "side", None)
        for name in ("back", "bar", "seat")
    )
    # Canonical z is the recipe's x.
    rotation = np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]])
    base = BasePatch("side", ("side",), 0.0, 0.0, (outline,))
    scaffold = Scaffold(recipe, np.array([-1.0, 0, 0]), rotation, 0.2, (base,), patches)
    steps = (step(0, "seat", "bar"), step(1, "back"))
    return FoldSolution(scaffold, Thickness(4, 0.3), (), (STILL, GONE, SPLIT), steps, 0.15, 0.1, ("a note",))


def assembly(posture: str = "open") -> Assembly:
    """One cube of 10 mm and one plate that falls from z = 20 onto it, canonical frame."""
    cube = 10.0 * np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    faces = np.array([[0, 1, 2]])
    up = np.array([0.0, 0, 1])
    low = Body("low", "base", cube, faces, up, 1000.0, np.array([], dtype=int))
    high = Body("high", "panel", cube + 20 * up, faces, up, 1000.0, np.array([], dtype=int))
    down = np.eye(4)
    down[2, 3] = -10
    poses = {"low": np.array([np.eye(4), np.eye(4)]), "high": np.array([np.eye(4), down])}
    axis = np.array([[0.0, 0, 0], [1, 0, 0]])
    joints = tuple(Joint(f"hinge-{i}", ("low", "high"), axis, 2.0, (0.0, 90.0), i == 0) for i in range(3))
    findings = (Finding("widened", "the bar was widened to 8 mm"),)
    return Assembly(solution(), (high, low), joints, np.array([0.0, 1.0]), poses, posture, findings)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("modification", "sentence"),
    [
        (STILL, ""),
        (SPLIT, "seat gets 1 hinge and is narrowed to 80 % of its width to come straight down"),
        (GONE, "bar is taken away because of seat"),
        (Modification("a", "in-place", 3, "l", (0, 1), 1, 1), "a gets 3 hinges"),
    ],
)
def test_change(modification: Modification, sentence: str) -> None:
    assert report.change(modification) == sentence


def test_sizes_stand_along_the_recipes_axes() -> None:
    opened, folded = report.sizes(assembly())
    assert opened == pytest.approx([30, 10, 10])
    assert folded == pytest.approx([20, 10, 10])


def test_summary_says_what_a_maker_wants_to_know() -> None:
    text = report.summary(assembly(), Path("prints/chair"))
    for words in (
        "chair: folds flat along -x in 2 steps",
        "A chair.",
        "seat gets 1 hinge",
        "bar is taken away",
        "1 other foldable patch unchanged",
        "30.0 × 10.0 × 10.0 mm",
        "33.3 %",
        "1 inserted, 2 at bases",
        "1:5",
        "prusa-mk4 (250 × 210 × 220 mm)",
        "posture open",
        "layers of 0.2 mm or less",
        "0.3 mm of clearance",
        "seat, bar; then back",
        "the bar was widened to 8 mm",
        "prints/chair",
    ):
        assert words in text


def test_summary_of_a_folded_print() -> None:
    assert "unfold it" in report.summary(assembly("folded"), Path("x"))


def test_summary_says_where_a_print_on_edge_wants_support() -> None:
    made = replace(assembly("edge"), up=np.array([0.0, 1.0, 0.0]))
    assert "it stands on edge: allow no supports" in report.summary(made, Path("x"))
    low, high = made.bodies[1], made.bodies[0]
    lifted = replace(made, bodies=(replace(high, vertices=high.vertices + np.array([0.0, 9.0, 0.0])), low))
    assert "on edge: give supports below high, and nowhere else" in report.summary(lifted, Path("x"))
    assert "on edge: allow no supports" in report.summary(replace(lifted, propped=(lifted.bodies[0],)), Path("x"))
    level = replace(lifted, findings=(Finding(LEVEL, "the undersides of hinge-1 stay flat"),))
    assert "below high and below knuckles with flat undersides" in report.summary(level, Path("x"))


def test_table_is_in_folding_order() -> None:
    lines = report.fold_table(solution(), 12.3).splitlines()
    assert lines[0] == (
        "chair folds along -x: 2 units, 3 foldable patches, cost 0.1500, no less than 0.1000 (gap 33.3 %), "
        "ordering optimal, solved in 12 ms"
    )
    assert [line.split()[:2] for line in lines[3:6]] == [["1", "seat"], ["1", "bar"], ["2", "back"]]
    assert lines[-1] == "note: a note"


def test_facts_are_json() -> None:
    facts = json.loads(json.dumps(report.fold_facts(solution(), 12.3456), allow_nan=False))
    assert (facts["status"], facts["units"], facts["foldable_patches"]) == ("folded", 2, 3)
    assert (facts["cost"], facts["lower_bound"], facts["milliseconds"]) == (0.15, 0.1, 12.346)
    assert facts["modifications"][1]["patch"] == "bar"
    assert (facts["ordering"], facts["gap"], facts["proven"]) == ("optimal", pytest.approx(1 / 3), False)


@pytest.mark.parametrize(
    ("cost", "bound", "gap", "text"),
    [
        (0.2103, 0.19, 0.09653, "0.2103, no less than 0.1900 (gap 9.7 %)"),
        (0.2, 0.0, 1.0, "0.2000, no less than 0.0000 (gap 100.0 %)"),
        (1 / 6, 1 / 6, 0, "0.1667, proven least"),
        (1 / 6, 1 / 6 - 1e-10, 0, "0.1667, proven least"),
        (0.1, 0.1 + 1e-12, 0, "0.1000, proven least"),
        (0.0, 0.0, 0, "0.0000, proven least"),
    ],
)
def test_how_good_a_cost_is(cost: float, bound: float, gap: float, text: str) -> None:
    found = replace(solution(), cost=cost, lower_bound=bound)
    assert report.cost_and_gap(found) == text
    assert report.gap(found) == pytest.approx(gap, abs=1e-4)
    assert f", cost {text}, " in report.fold_table(found, 1)
    assert report.fold_facts(found, 1)["proven"] == (gap == 0)
    assert text in report.summary(replace(assembly(), solution=found), Path("x"))


def test_alternatives() -> None:
    first = solution()
    turned = replace(SPLIT, hinges=3, side="l", window=(0.0, 1.0))
    back = replace(STILL, mechanism="in-place", hinges=1, window=(0.2, 0.6))
    others = (
        replace(first, modifications=(back, GONE, turned), cost=0.2),
        replace(first, modifications=(GONE, replace(GONE, patch="seat"), STILL), lower_bound=0.15),
        replace(first, steps=(step(0, "back"), step(1, "seat", "bar"))),
    )
    lines = report.alternatives_table((first, *others), 12.3).splitlines()
    assert lines[0] == "chair along -x: 4 folds, cost 0.1500, no less than 0.1000 (gap 33.3 %), solved in 12 ms"
    assert [" ".join(line.split()) for line in lines[2:]] == [
        "rank cost no less than hinges narrowed order otherwise than the first",
        "1 0.1500 0.1000 1 1 seat, back",
        "2 0.2000 0.1000 4 1 seat, back back in-place, left, 1 hinge, 20 % to 60 %; seat in-place, left, 3 hinges",
        "3 0.1500 0.1500 0 0 seat, back seat deleted",
        "4 0.1500 0.1000 1 1 back, seat the same in another order",
    ]


def test_facts_of_alternatives_are_json() -> None:
    facts = json.loads(json.dumps(report.alternatives_facts((solution(), solution()), 2.0), allow_nan=False))
    assert facts == {"status": "folded", "alternatives": [report.fold_facts(solution(), 2.0)] * 2}


def test_facts_of_a_refusal() -> None:
    assert report.refused_facts("no base") == {"status": "refused", "reason": "no base", "advice": []}
    told = report.refused_facts("no base", ("along -x", "along -y"))
    assert told == {"status": "refused", "reason": "no base", "advice": ["along -x", "along -y"]}
