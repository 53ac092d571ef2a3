"""Every shipped recipe, written in each format by another program and read back, is the same furniture.

trimesh writes GLB and OBJ, lib3mf 3MF, build123d STEP; each places its parts by transforms where its format has them.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import foldfab
from foldfab import pipeline
from foldfab.folding.model import FoldSolution
from foldfab.folding.units import decompose
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Part, Recipe
from foldfab.scaffold.abstract import abstract

NAMES = [path.stem for path in pipeline.shipped()]
FAR = 0.002
"""mm; single precision, which GLB and 3MF hold, at a few metres."""
SAME = 1e-6
"""Of costs, which are shares of areas."""


def place(part: Part, scale: float = 1.0) -> Array:
    """(4, 4) from a box around the origin to where the part stands."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = part.axes.T, scale * part.center
    return matrix


def write_glb(recipe: Recipe, file: Path) -> None:
    _scene(recipe, 1e-3, np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])).export(file)


def write_obj(recipe: Recipe, file: Path) -> None:
    _scene(recipe, 1.0, np.eye(4)).export(file)


def _scene(recipe: Recipe, scale: float, turn: Array) -> Any:
    trimesh = pytest.importorskip("trimesh")
    made = trimesh.Scene()
    for part in recipe.parts:
        box = trimesh.creation.box(extents=scale * part.size)
        made.add_geometry(box, node_name=part.name, geom_name=part.name, transform=turn @ place(part, scale))
    return made


def write_3mf(recipe: Recipe, file: Path) -> None:
    lib3mf = pytest.importorskip("lib3mf")
    trimesh = pytest.importorskip("trimesh")
    model = lib3mf.Wrapper().CreateModel()
    for part in recipe.parts:
        box = trimesh.creation.box(extents=part.size)
        made = model.AddMeshObject()
        made.SetName(part.name)
        corners = [lib3mf.Position(tuple(corner)) for corner in box.vertices.tolist()]
        made.SetGeometry(corners, [lib3mf.Triangle(tuple(face)) for face in box.faces.tolist()])
        transform = lib3mf.Transform()
        for row, values in enumerate(place(part)[:3].T):
            transform.Fields[row][:] = values.tolist()
        model.AddBuildItem(made, transform)
    model.QueryWriter("3mf").WriteToFile(str(file))


def write_step(recipe: Recipe, file: Path) -> None:
    b3d = pytest.importorskip("build123d", reason="needs build123d and libGL", exc_type=ImportError)
    solids = []
    for part in recipe.parts:
        plane = b3d.Plane(tuple(part.center), x_dir=tuple(part.axes[0]), z_dir=tuple(part.axes[2]))
        solid = b3d.Box(*part.size.tolist()).moved(b3d.Location(plane))
        solid.label = part.name
        solids.append(solid)
    assert b3d.export_step(b3d.Compound(label=recipe.name, children=solids), file)


WRITERS: dict[str, Callable[[Recipe, Path], None]] = {
    "step": write_step, "glb": write_glb, "3mf": write_3mf, "obj": write_obj,
}  # fmt: skip


@functools.cache
def original(name: str) -> FoldSolution:
    """The fold of a shipped recipe in the paper's order, which takes less time than the best one."""
    return foldfab.foldabilize(foldfab.load(name, ordering="greedy"))


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("name", NAMES)
def test_what_is_written_and_read_back_folds_the_same(tmp_path: Path, name: str, kind: str) -> None:
    first = original(name)
    recipe, direction, scale = first.scaffold.recipe, first.scaffold.direction, first.scaffold.scale
    file = tmp_path / f"{name}.{kind}"
    WRITERS[kind](recipe, file)
    vector = ",".join(map(repr, direction.tolist()))
    read = foldfab.load(file, units="mm" if kind == "obj" else None, smallest=0.0, direction=vector, ordering="greedy")
    assert {part.name for part in read.parts} == {part.name for part in recipe.parts}
    assert_same_scaffold(first, read, direction, scale)
    again = foldfab.foldabilize(read)
    assert again.cost == pytest.approx(first.cost, abs=SAME)
    assert [m.patch for m in again.modifications] == [m.patch for m in first.modifications]


def assert_same_scaffold(first: FoldSolution, read: Recipe, direction: Array, scale: float) -> None:
    """The same bases, patches and units, as large and in the same places."""
    one, other = abstract(first.scaffold.recipe, direction, scale), abstract(read, direction, scale)
    assert [base.name for base in one.bases] == [base.name for base in other.bases]
    assert [patch.name for patch in one.patches] == [patch.name for patch in other.patches]
    for base, same in zip(one.bases, other.bases, strict=True):
        assert (base.parts, abs(base.top - same.top) < FAR) == (same.parts, True)
    for patch, same_patch in zip(one.patches, other.patches, strict=True):
        assert patch.parts == same_patch.parts and patch.bases == same_patch.bases
        sizes = [(p.width, p.length, *p.center) for p in (patch, same_patch)]
        assert np.allclose(*sizes, atol=FAR)
    units = [[(unit.name, unit.patches) for unit in decompose(scaffold)] for scaffold in (one, other)]
    assert units[0] == units[1]
