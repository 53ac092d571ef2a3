"""Which reader a file needs, and files that are not what they say."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from foldfab.errors import RecipeError
from foldfab.intake.files import is_shapes, shapes

from .furniture import glb, gltf, meshes, model_xml, obj, stl, text_stl, threemf

SHELF_GLB = glb(*gltf(meshes(), embed=False))
TEXT_STL = text_stl("a", meshes()["Top"])


def test_each_by_its_ending(tmp_path: Path) -> None:
    (tmp_path / "a.OBJ").write_text(obj(meshes()), encoding="utf-8")
    (tmp_path / "a.glb").write_bytes(SHELF_GLB)
    (tmp_path / "a.stl").write_bytes(stl(meshes()["Top"]))
    threemf(tmp_path / "a.3mf", model_xml(meshes()))
    counts = {path.suffix: len(shapes(path).bodies) for path in tmp_path.iterdir()}
    assert counts == {".OBJ": 5, ".glb": 5, ".stl": 1, ".3mf": 5}
    assert all(is_shapes(path) for path in (*tmp_path.iterdir(), tmp_path))
    assert not is_shapes(tmp_path / "a.json")


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.step", SHELF_GLB, "named as STEP, but it is a GLB file by its content; rename it to .glb"),
        ("a.obj", TEXT_STL.encode(), "it is a STL file"),
        ("a.stl", b"ISO-10303-21;\n", "it is a STEP file"),
        ("a.glb", b'{"asset": {}}', "it is a glTF file"),
        ("a.3mf", TEXT_STL.encode(), "it is a STL file"),
        ("a.obj", b"PK\x03\x04", "it is a 3MF file"),
        ("a.fbx", b"x", "not read; export it as one of .step"),
        ("a.glb", b"", "is empty"),
    ],
)
def test_what_is_not_what_it_says(tmp_path: Path, name: str, content: bytes, says: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(RecipeError) as caught:
        shapes(tmp_path / name)
    assert says in str(caught.value)


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.obj")
    with pytest.raises(RecipeError, match="not a plain file"):
        shapes(tmp_path / "a.obj")


def test_what_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(RecipeError, match="no such file"):
        shapes(tmp_path / "a.obj")
