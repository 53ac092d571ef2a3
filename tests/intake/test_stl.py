"""STL files and folders of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.intake import limits
from foldfab.intake.stl import read, read_folder

from .furniture import SHELF, box, meshes, stl, text_stl

CUBE = box((0, 0, 0), (10, 10, 10))


def written(folder: Path, content: str | bytes, name: str = "a.stl") -> Path:
    file = folder / name
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return file


def test_binary_and_text_are_the_same(tmp_path: Path) -> None:
    first = read(written(tmp_path, stl(CUBE))).bodies[0].mesh
    second = read(written(tmp_path, text_stl("cube", CUBE))).bodies[0].mesh
    assert np.array_equal(first.vertices[first.faces], second.vertices[second.faces])
    assert len(first.vertices) == 8
    assert np.array_equal(first.vertices[first.faces], CUBE.vertices[CUBE.faces])


def test_solids_of_a_text_file_are_bodies(tmp_path: Path) -> None:
    text = "".join(text_stl(name, mesh) for name, mesh in meshes().items())
    assert [body.name for body in read(written(tmp_path, text)).bodies] == list(SHELF)


def test_a_binary_file_that_begins_like_text(tmp_path: Path) -> None:
    content = b"solid facet".ljust(80) + stl(CUBE)[80:]
    assert len(read(written(tmp_path, content)).bodies[0].mesh.faces) == 12


def test_files_of_a_folder_are_parts(tmp_path: Path) -> None:
    for name, mesh in meshes().items():
        written(tmp_path, stl(mesh), f"{name}.STL")
    written(tmp_path, "not looked at", "readme.txt")
    written(tmp_path, "not looked at", ".hidden.stl")
    shapes = read_folder(tmp_path)
    assert [body.name for body in shapes.bodies] == sorted(SHELF)
    assert shapes.millimetres is None


def test_a_link_out_of_the_folder(tmp_path: Path) -> None:
    outside = written(tmp_path, stl(CUBE))
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "leg.stl").symlink_to(outside)
    with pytest.raises(RecipeError, match="leads out"):
        read_folder(tmp_path / "parts")


def test_a_folder_without_stl_files(tmp_path: Path) -> None:
    with pytest.raises(RecipeError, match="without STL files"):
        read_folder(tmp_path)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (b"abc", "no STL file"),
        (stl(CUBE)[:-7], "says it holds 12 triangles, but has room for 11"),
        (stl(CUBE)[:80] + bytes(4), "no triangles"),
        (stl(box((0, 0, 0), (float(np.float32(1e30)), 1, 1))), "no place for furniture"),
        (text_stl("a", CUBE)[:-20], "truncated"),
        (text_stl("a", CUBE).replace("vertex", "vortex", 1), "three vertices"),
        (text_stl("a", CUBE).replace("vertex -5.0", "vertex x", 1), "not three numbers"),
        (text_stl("a", CUBE).replace("vertex -5.0", "vertex nan", 1), "no place for furniture"),
        ("solid a\nfacet\nendsolid", "no triangles"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, content: str | bytes, says: str) -> None:
    with pytest.raises(RecipeError) as caught:
        read(written(tmp_path, content))
    assert says in str(caught.value)


def test_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, mesh in meshes().items():
        written(tmp_path, stl(mesh), f"{name}.stl")
    monkeypatch.setattr(limits, "MOST_TRIANGLES", 50)
    with pytest.raises(RecipeError, match="50 triangles"):
        read_folder(tmp_path)
