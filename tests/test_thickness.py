"""Plates and panels of different thickness: by part, by role, as the furniture's own; and stacks that close flat.

Chains with one and with three hinges on the same two bases fold to different heights. What the lower one lacks is made
up by the thickness of its panels or by a plinth; else the higher one sinks into its bases; where nothing fits, the
numbers are said.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from foldfab.errors import FoldingError
from foldfab.fabrication.build import build
from foldfab.folding.kinematics import configuration, size_at
from foldfab.folding.model import FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.pipeline import check, load, write
from foldfab.recipe.model import Part, Posture, PrintOptions, Recipe
from foldfab.recipe.printers import DEFAULT_PRINTER
from foldfab.scaffold.abstract import abstract
from foldfab.scaffold.model import Scaffold
from foldfab.validity.verify import violations

FLAT = np.radians(0.5)
Solve = Callable[..., FoldSolution]
Pair = Callable[..., tuple[Part, ...]]


def tilts(made: FoldSolution) -> dict[str, float]:
    """By panel, how far its plate is from lying flat at the end, radians."""
    poses = configuration(made, np.array([1.0]))
    turned = {p: poses[p][0][:3, :3] @ c.across for c in made.chains for p in c.panels}
    return {p: float(np.arccos(min(abs(normal[2]), 1.0))) for p, normal in turned.items()}


def folded_normals(made: FoldSolution) -> dict[str, Array]:
    """The same of the printed solids."""
    assembly = build(made, "folded")
    panels = [b for b in assembly.bodies if b.kind == "panel"]
    return {b.name: assembly.poses[b.name][-1][:3, :3] @ b.normal for b in panels}


def test_one_and_three_hinges_close_flat_by_thickness(solution: Solve, pair: Pair) -> None:
    """Three hinges fold to 4 (K + g) + g = 17.5 mm; panels of 8.3 mm make that up with one."""
    made = solution(pair(104, 7.0), slanting=False)
    chains = {c.patch: c for c in made.chains}
    assert chains["one"].panel == pytest.approx((17.5 - 0.3) / 2 - 0.3)
    assert chains["three"].panel == 4.0
    assert chains["one"].pads == chains["three"].pads == (0.0, 0.0)
    assert max(tilts(made).values()) < FLAT
    assert all(abs(n[2]) > np.cos(FLAT) for n in folded_normals(made).values())
    assert violations(made) == ()


def test_one_and_three_hinges_close_flat_on_a_pad(solution: Solve, pair: Pair) -> None:
    """At 4 mm, panels would have to be twice as thick: a plinth of 8.6 mm instead."""
    made = solution(pair(104), slanting=False)
    chains = {c.patch: c for c in made.chains}
    assert chains["one"].panel == chains["three"].panel == 4.0
    assert sum(chains["one"].pads) == pytest.approx(17.5 - 8.9)
    assert max(tilts(made).values()) < FLAT
    assert all(abs(n[2]) > np.cos(FLAT) for n in folded_normals(made).values())
    assert violations(made) == ()


@pytest.mark.parametrize(("height", "one", "three", "sunk", "raised", "thick"), [
    # Under 76 mm, one with a plinth of 8.6 mm and three snap too differently.
    (74, None, None, (1.4, 1.4), 5.8, 4.0),
    # Three hinges in panels of 3 mm take 13.5 mm; one with 1.5 times its 4 mm takes 12.9.
    (36, 4.0, 3.0, (0.6, 0.0), 0.0, 6.0),
])  # fmt: skip
def test_one_and_three_hinges_close_flat_in_pockets(
    height: float, one: float | None, three: float | None, sunk: tuple[float, float], raised: float, thick: float,
    solution: Solve, pair: Pair,
) -> None:  # fmt: skip
    made = solution(pair(height, one, three), slanting=False)
    chains = {c.patch: c for c in made.chains}
    assert chains["three"].pads == pytest.approx([-depth for depth in sunk])
    assert chains["one"].pads == pytest.approx((0.0, raised)) and chains["one"].panel == pytest.approx(thick)
    assert sum("pocket" in note for note in made.notes) == sum(depth > 0 for depth in sunk)
    assert max(tilts(made).values()) < FLAT
    assert all(abs(n[2]) > np.cos(FLAT) for n in folded_normals(made).values())
    assert violations(made) == ()


@pytest.mark.parametrize("posture", ["open", "folded", "edge"])
def test_what_stands_in_pockets_prints_in_every_posture(
    posture: Posture, solution: Solve, pair: Pair, tmp_path: Path
) -> None:
    made = build(solution(pair(74), slanting=False), posture)
    write(made, tmp_path / "pair")
    report = check(tmp_path / "pair")
    assert report.ok, report
    assert all(finding.code != "stop" for finding in made.findings)
    notes = json.loads((tmp_path / "pair" / "sheet.json").read_text(encoding="utf-8"))["findings"]
    told = "ground has a pocket 1.4 mm deep for three so that the stack closes flat"
    assert told in [note["text"] for note in notes]


def test_what_stands_in_pockets_folds_lower_by_them(solution: Solve, pair: Pair) -> None:
    sunk, not_sunk = (solution(pair(height), slanting=False) for height in (74, 78))
    sizes = [size_at(made, 1.0, np.eye(3))[2] for made in (sunk, not_sunk)]
    assert sizes[1] - sizes[0] == pytest.approx(2 * 1.4)


def test_where_not_even_pockets_fit_the_numbers_are_said(solution: Solve, pair: Pair) -> None:
    with pytest.raises(FoldingError, match=r"snaps by 0\.05 mm and three by 2\.\d\d, and their play covers 1\.08, be "):
        solution(pair(84, 2.5, 6.0), slanting=False)
    with pytest.raises(
        FoldingError, match=r"snaps by 0\.15 mm and three by 1\.30, and their play covers 1\.08, be they"
    ):
        solution(pair(72), slanting=False)


@pytest.fixture(scope="module")
def bench() -> Recipe:
    return load("bench")


def scaffold_of(recipe: Recipe, scale: float, **options: object) -> Scaffold:
    made = PrintOptions(**{"printer": DEFAULT_PRINTER, **options})  # type: ignore[arg-type]
    assert recipe.direction is not None
    return abstract(replace(recipe, print=made), recipe.direction, scale)


def test_thickness_by_role(bench: Recipe) -> None:
    made = scaffold_of(bench, 0.1, thickness=3.0, base_thickness=5.0)
    assert {b.thickness for b in made.bases} == {5.0}
    assert {p.thickness for p in made.patches} == {None}


def test_thickness_of_a_part_comes_before_that_of_its_role(bench: Recipe) -> None:
    name = scaffold_of(bench, 0.1).bases[0].parts[0]
    parts = tuple(replace(p, thickness=7.0) if p.name == name else p for p in bench.parts)
    made = scaffold_of(replace(bench, parts=parts), 0.1, base_thickness=5.0)
    assert {b.thickness for b in made.bases if name in b.parts} == {7.0}
    assert {b.thickness for b in made.bases if name not in b.parts} <= {5.0}


@pytest.mark.parametrize(("scale", "wanted"), [(0.1, 3.0), (0.2, 6.0), (1.0, 20.0)])
def test_thickness_of_the_furniture_itself_within_limits(scale: float, wanted: float, pair: Pair) -> None:
    recipe = replace(load("bench"), parts=pair(800))
    thick = replace(recipe, parts=tuple(replace(p, size=np.maximum(p.size, 30.0)) for p in recipe.parts))
    made = scaffold_of(replace(thick, direction=np.array([0.0, 0.0, -1.0])), scale, thickness=3.0, own_thickness=True)
    assert {x.thickness for x in (*made.bases, *made.patches)} == {wanted}


@pytest.mark.parametrize(("panels", "bases"), [(3.0, 5.0), (5.0, 3.0)])
def test_a_print_with_plates_unlike_its_panels_holds_and_is_valid(panels: float, bases: float) -> None:
    from foldfab.pipeline import fabricate, foldabilize

    made = foldabilize(load("chair-along", thickness=panels, base_thickness=bases))
    assert not violations(made)
    heights = {b.name: np.ptp(b.vertices[:, 2]) for b in fabricate(made).bodies if b.kind == "base"}
    assert all(height >= bases - 1e-6 for height in heights.values())
    assert [c.panel for c in made.chains] == pytest.approx([panels] * len(made.chains))
