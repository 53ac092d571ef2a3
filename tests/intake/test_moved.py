"""Furniture that stands elsewhere, askew and in another size in its file is the same furniture, and folds the same."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import foldfab
from foldfab.folding.model import FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.intake.meshes import joined
from foldfab.intake.model import Body, Shapes, Wishes
from foldfab.intake.understand import Grouping, named, parts
from foldfab.recipe.model import Recipe

from .furniture import box, cylinder, obj
from .moved import moved, turn, write

MOVES = [
    *((name, seed, factor) for name in ("bench", "table-slanted", "chair-along", "tower", "shelf-slanted")
      for seed, factor in ((1, 0.37), (2, 1.0), (3, 2.54))),
    ("hexagon-shelf", 4, 1.7),
]  # fmt: skip
"""Shipped recipes with parts between bases, on one base, that lean, and in rings; each turned by odd angles."""
SCALE = 0.2
seeds = st.integers(0, 2**32 - 1)
factors = st.sampled_from([1.0, 0.37, 2.54])


def from_file(file: Path, like: Recipe, way: Array, factor: float) -> Recipe:
    """The furniture in a file that is `factor` as large, folded and printed as another recipe along `way` (3,)."""
    found = foldfab.load(file, units="mm", smallest=0)
    return replace(found, direction=way, fold=like.fold, print=replace(like.print, scale=SCALE / factor))


def facts(solution: FoldSolution) -> list[tuple[object, ...]]:
    """What no motion may change: how each patch folds and to which side, and the window that is kept of it."""
    changed = solution.modifications
    return [(m.patch, m.mechanism, m.hinges, m.side, *(round(end, 9) for end in m.window)) for m in changed]


@pytest.mark.parametrize(("name", "seed", "factor"), MOVES)
def test_a_moved_copy_gives_the_same_solution(tmp_path: Path, name: str, seed: int, factor: float) -> None:
    recipe, rotation = foldfab.load(name), turn(seed)
    assert recipe.direction is not None
    shift = np.random.default_rng(seed).uniform(-3000, 3000, 3)
    still = write(tmp_path / "still.obj", recipe, np.eye(3), np.zeros(3), 1.0)
    askew = write(tmp_path / "askew.obj", recipe, rotation, shift, factor)
    first = foldfab.foldabilize(from_file(still, recipe, recipe.direction, 1.0))
    second = foldfab.foldabilize(from_file(askew, recipe, rotation @ recipe.direction, factor))
    assert facts(first) == facts(second)
    assert first.cost == pytest.approx(second.cost, abs=1e-5)


@given(seed=seeds, factor=factors)
@settings(deadline=None, derandomize=True, max_examples=5)
def test_contacts_are_the_same_wherever_it_stands(seed: int, factor: float) -> None:
    angle = joined([box((0, 0, 10), (600, 400, 20)), box((-290, 0, 210), (20, 400, 380))])
    bodies = {
        "angle": angle, "inside": box((200, 0, 343), (100, 390, 186)), "leg": cylinder(60, 400),
        "top": box((0, 0, 445), (900, 500, 20)), "spacer": box((0, 0, 417.5), (30, 30, 35)),
    }  # fmt: skip
    rotation, shift = turn(seed), np.random.default_rng(seed).uniform(-3000, 3000, 3)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "askew.obj"
        file.write_text(obj({n: moved(mesh, rotation, shift, factor) for n, mesh in bodies.items()}), encoding="utf-8")
        recipe = foldfab.load(file, units="mm", smallest=60 * factor)
        guessed = foldfab.load(file, units="mm")
    assert recipe.touching == (("leg", "top"),)
    assert recipe.apart == (("angle", "inside"),)
    assert [part.name for part in guessed.parts] == ["angle", "inside", "leg", "top", "spacer"]


@given(seed=seeds)
@settings(deadline=None, derandomize=True, max_examples=10)
def test_the_same_bodies_are_hardware_wherever_it_stands(seed: int) -> None:
    bodies = {
        "board": box((0, 0, 0), (1000, 400, 20)), "side": box((-490, 0, 210), (20, 400, 400)),
        "glide": box((400, 0, -15), (11, 11, 10)), "foot": box((-400, 0, -15), (13, 13, 10)),
    }  # fmt: skip
    shapes = Shapes(tuple(Body(name, moved(mesh, turn(seed), np.ones(3), 1.0)) for name, mesh in bodies.items()))
    wishes = Wishes(units="mm")
    found = parts("a.obj", named("a.obj", shapes, wishes)[0], wishes, Grouping())
    assert [part.name for part in found.parts] == ["board", "side", "foot"]
    assert "no longer than 20 mm, left out as hardware (--smallest): glide" in found.notes
