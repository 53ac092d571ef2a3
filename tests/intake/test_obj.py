"""OBJ files, their groups and objects."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.intake import limits
from foldfab.intake.obj import read

from .furniture import SHELF, box, meshes, obj

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def written(folder: Path, text: str | bytes) -> Path:
    file = folder / "a.obj"
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    return file


@pytest.mark.parametrize("word", ["g", "o"])
def test_groups_and_objects_are_bodies(tmp_path: Path, word: str) -> None:
    shapes = read(written(tmp_path, obj(meshes(), word)))
    assert [body.name for body in shapes.bodies] == list(SHELF)
    assert (shapes.up, shapes.millimetres) == ("z", None)
    for body, mesh in zip(shapes.bodies, meshes().values(), strict=True):
        assert np.array_equal(body.mesh.vertices[body.mesh.faces], mesh.vertices[mesh.faces])


def test_groups_of_several_objects_do_not_divide_them(tmp_path: Path) -> None:
    text = SQUARE + "o leg\ng front\nf 1 2 3\ng back\nf 1 3 4\no seat\nf 1 2 4\n"
    assert [(body.name, len(body.mesh.faces)) for body in read(written(tmp_path, text)).bodies] == [
        ("leg", 2),
        ("seat", 1),
    ]


def test_a_group_that_comes_again_goes_on(tmp_path: Path) -> None:
    text = SQUARE + "g a\nf 1 2 3\ng b\nf 1 2 4\ng a\nf 1 3 4\n"
    assert [(body.name, len(body.mesh.faces)) for body in read(written(tmp_path, text)).bodies] == [("a", 2), ("b", 1)]


def test_polygons_and_numbers_from_the_end(tmp_path: Path) -> None:
    bodies = read(written(tmp_path, SQUARE + "f -4/1/1 -3/1/1 -2/1/1 -1/1/1\n")).bodies
    assert bodies[0].mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_names_that_are_not_utf8_and_vertices_that_no_face_uses(tmp_path: Path) -> None:
    body = read(written(tmp_path, b"v 9 9 nan\n" + SQUARE.encode() + b"g b\xf6rd\nf 2 3 4\n")).bodies[0]
    assert (body.name, len(body.mesh.vertices)) == ("b\ufffdrd", 3)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is empty"),
        ("hello\n", "no faces"),
        (SQUARE, "no faces"),
        ("v 1 2\n", "line 1: a vertex has fewer"),
        ("v 1 2 x\n", "line 1: could not convert"),
        (SQUARE + "f 1 2\n", "line 5: a face has fewer"),
        (SQUARE + "f 1 2 0\n", "line 5: a face names a vertex"),
        (SQUARE + "f 1 2 -5\n", "line 5: a face names a vertex"),
        (SQUARE + "f 1 2 9\n", "beyond the 4 there are"),
        (SQUARE + "f 1 2 99999999999999999999999\n", "line 5: "),
        ("v 0 0 nan\n" + SQUARE + "f 1 2 3\n", "a vertex at (0, 0, nan)"),
        ("v 0 0 1e30\n" + SQUARE + "f 1 2 3\n", "a vertex at (0, 0, 1e+30)"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(RecipeError) as caught:
        read(written(tmp_path, text))
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("name", "most", "says"),
    [("MOST_TRIANGLES", 30, "30 triangles"), ("MOST_BODIES", 3, "3 bodies"), ("MOST_VERTICES", 20, "20 vertices")],
)
def test_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, most: int, says: str) -> None:
    file = written(tmp_path, obj(meshes()))
    read(file)
    monkeypatch.setattr(limits, name, most)
    with pytest.raises(RecipeError, match=says):
        read(file)


def test_a_file_that_is_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "LARGEST_FILE", 100)
    with pytest.raises(RecipeError, match="larger than"):
        read(written(tmp_path, obj({"a": box((0, 0, 0), (1, 1, 1))})))
