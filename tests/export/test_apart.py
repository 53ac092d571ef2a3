"""Outlines against bodies, with paths made by hand and with PrusaSlicer's own."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from foldfab.export.apart import Hinge, outlines
from foldfab.export.mesh_files import stl_bytes
from foldfab.export.shell import Shell
from foldfab.export.solid import Solid, solid
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Printer
from foldfab.slicing.gcode import Layer, layers
from foldfab.slicing.program import run

MINI = Printer("mini", (180.0, 180.0, 180.0))
SIZE = np.array([6.0, 8.0, 4.0])


def box(name: str, corner: tuple[float, float, float]) -> Solid:
    from manifold3d import Manifold

    mesh = Manifold.cube(SIZE).translate(corner).to_mesh()
    return solid(name, np.asarray(mesh.vert_properties, dtype=np.float64), np.asarray(mesh.tri_verts, dtype=np.int64))


def pair(gap: float) -> tuple[Solid, Solid]:
    """Two boxes side by side, `gap` mm apart."""
    return box("left", (50.1, 50.1, 0.0)), box("right", (50.1 + SIZE[0] + gap, 50.1, 0.0))


def hinge() -> Hinge:
    """Along the gap."""
    return Hinge("hinge", ("left", "right"), np.array([[56.2, 50.0, 2.0], [56.2, 58.0, 2.0]]), 2.0)


def ring(low: tuple[float, float], high: tuple[float, float]) -> Array:
    """The path of a rectangle's outline, half a line inside of it."""
    (a, b), (c, d) = np.array(low) + 0.2, np.array(high) - 0.2
    return np.array([[a, b], [c, b], [c, d], [a, d], [a, b + 0.05]])


LEFT, RIGHT = ring((50.1, 50.1), (56.1, 58.1)), ring((56.4, 50.1), (62.4, 58.1))
BOTH = ring((50.1, 50.1), (62.4, 58.1))


def test_each_body_has_its_outline() -> None:
    found = outlines(pair(0.3), [hinge()], [Layer(2.0, 0.2, (LEFT, RIGHT)), Layer(9.0, 0.2, ())])
    assert (found.layers, found.hinges, found.expected, found.found, found.clashes) == (1, 1, 2, 2, ())


def test_an_outline_around_both_is_noticed() -> None:
    (clash,) = outlines(pair(0.3), [hinge()], [Layer(2.0, 0.2, (BOTH,))]).clashes
    assert (clash.kind, clash.bodies, clash.z) == ("fused", ("left", "right"), pytest.approx(1.9))


def test_a_body_without_an_outline_is_noticed() -> None:
    found = outlines(pair(0.3), [hinge()], [Layer(2.0, 0.2, (LEFT,))])
    assert [(clash.kind, clash.bodies) for clash in found.clashes] == [("lost", ("right",))]
    assert (found.expected, found.found) == (2, 1)


def test_a_body_laid_onto_another_is_noticed() -> None:
    lower = box("left", (50.1, 50.1, 0.0))
    axis = np.array([[50.0, 54.0, 4.0], [56.0, 54.0, 4.0]])
    ring_of = ring((50.1, 50.1), (56.1, 58.1))
    stack = [Layer(top, 0.2, (ring_of,)) for top in np.arange(3.0, 5.1, 0.2).round(3)]
    for gap, kinds in ((0.05, ["laid"]), (0.3, [])):
        upper = box("right", (50.1, 50.1, 4.0 + gap))
        found = outlines((lower, upper), [Hinge("hinge", ("left", "right"), axis, 0.9)], stack)
        assert [clash.kind for clash in found.clashes] == kinds


@pytest.mark.parametrize("top", [4.0999, 4.1, 4.1001])
def test_a_cut_along_a_level_face_asks_for_no_outline(top: float) -> None:
    """Boxes end at z = 4, the middle of the layer."""
    assert outlines(pair(0.3), [hinge()], [Layer(top, 0.2, ())]).clashes == ()


def test_a_hinge_beyond_the_layers_is_not_counted() -> None:
    assert outlines(pair(0.3), [hinge()], [Layer(9.0, 0.2, ())]).hinges == 0


def test_the_box_of_a_hinge_is_that_of_its_cylinder() -> None:
    low, high = hinge().box()
    assert np.allclose(low, [53.7, 49.5, -0.5]) and np.allclose(high, [58.7, 58.5, 4.5])


@pytest.mark.parametrize(("gap", "is_apart"), [(0.05, False), (0.09, False), (0.15, True), (0.3, True)])
def test_prusaslicer_fuses_what_is_too_close_and_we_notice(tmp_path: Path, gap: float, is_apart: bool) -> None:
    slicer = shutil.which("prusa-slicer")
    if slicer is None:
        pytest.skip("PrusaSlicer is not installed")
    bodies = pair(gap)
    file = tmp_path / "pair.stl"
    file.write_bytes(stl_bytes(joined(bodies)))
    sliced = run(file, MINI, support=False, slicer=slicer)
    assert sliced.report.bodies == 2
    found = outlines(bodies, [hinge()], layers(sliced.gcode))
    # 20 layers of two bodies.
    assert found.layers == 20 and found.expected == 40
    fused = [clash for clash in found.clashes if clash.kind == "fused"]
    assert (found.found, len(fused)) == ((40, 0) if is_apart else (40 - 2 * len(fused), len(fused)))
    assert is_apart or len(fused) >= 19


def joined(bodies: tuple[Solid, ...]) -> Shell:
    """All bodies as one mesh."""
    meshes = [body.manifold.to_mesh() for body in bodies]
    corners = np.concatenate([np.asarray(m.vert_properties)[np.asarray(m.tri_verts)] for m in meshes]).reshape(-1, 3)
    faces = np.arange(len(corners)).reshape(-1, 3)
    return Shell("pair", "base", corners.astype(np.float64), faces, np.zeros(len(faces), dtype=bool))
