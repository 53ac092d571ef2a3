"""Plates and panels of different thickness: by part, by role, as the furniture's own; and stacks that close flat.

Chains with one and with three hinges on the same two bases fold to different heights. What the lower one lacks is made
up by the thickness of its panels or by a plinth; where neither fits, the numbers are said.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.errors import FoldingError
from foldfab.fabrication.build import build
from foldfab.folding.kinematics import configuration
from foldfab.folding.model import FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.pipeline import load
from foldfab.recipe.model import Part, Pattern, PrintOptions, Recipe
from foldfab.recipe.printers import DEFAULT_PRINTER
from foldfab.scaffold.abstract import abstract
from foldfab.scaffold.model import Scaffold
from foldfab.validity.verify import violations

FLAT = np.radians(0.5)
Solve = Callable[..., FoldSolution]


def box(name: str, center: tuple[float, float, float], size: tuple[float, float, float], **more: object) -> Part:
    return replace(Part(name, np.array(center), np.array(size), np.eye(3)), **more)  # type: ignore[arg-type]


def pair(height: float, one: float | None, three: float | None, hinges: int = 3) -> tuple[Part, ...]:
    """A wall with one hinge beside one with more, under the same board, each of its own thickness."""
    board = (240.0, 80.0, 4.0)
    wall = (4.0, 60.0, height - 4.0)
    return (
        box("ground", (0, 0, 0), board),
        box("ceiling", (0, 0, height), board),
        box("one", (-60, 0, height / 2), wall, pin=Pattern(hinges=1, window=(0, 1)), thickness=one),
        box("three", (60, 0, height / 2), wall, pin=Pattern(hinges=hinges, window=(0, 1)), thickness=three),
    )


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


def test_one_and_three_hinges_close_flat_by_thickness(solution: Solve) -> None:
    """Three hinges fold to 4 (K + g) + g = 17.5 mm; panels of 8.3 mm make that up with one."""
    made = solution(pair(104, 7.0, None), slanting=False)
    chains = {c.patch: c for c in made.chains}
    assert chains["one"].panel == pytest.approx((17.5 - 0.3) / 2 - 0.3)
    assert chains["three"].panel == 4.0
    assert chains["one"].pads == chains["three"].pads == (0.0, 0.0)
    assert max(tilts(made).values()) < FLAT
    assert all(abs(n[2]) > np.cos(FLAT) for n in folded_normals(made).values())
    assert not [v for v in violations(made) if v.model != "without thickness"]


def test_one_and_three_hinges_close_flat_on_a_pad(solution: Solve) -> None:
    """At 4 mm, panels would have to be twice as thick: a plinth of 8.6 mm instead."""
    made = solution(pair(104, None, None), slanting=False)
    chains = {c.patch: c for c in made.chains}
    assert chains["one"].panel == chains["three"].panel == 4.0
    assert sum(chains["one"].pads) == pytest.approx(17.5 - 8.9)
    assert max(tilts(made).values()) < FLAT
    assert all(abs(n[2]) > np.cos(FLAT) for n in folded_normals(made).values())
    assert not [v for v in violations(made) if v.model != "without thickness"]


def test_where_neither_thickness_nor_a_pad_fits_the_numbers_are_said(solution: Solve) -> None:
    with pytest.raises(FoldingError, match=r"snaps by 0\.05 mm and three by 2\.\d\d, and their play covers 1\.08"):
        solution(pair(84, 2.5, 6.0), slanting=False)


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
def test_thickness_of_the_furniture_itself_within_limits(scale: float, wanted: float) -> None:
    recipe = replace(load("bench"), parts=pair(800, None, None))
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
