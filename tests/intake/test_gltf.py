"""glTF: nodes, transforms, copies, and what files may not do."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.intake import limits
from foldfab.intake.gltf import read

from .furniture import SHELF, TO_Y_UP, box, glb, gltf, meshes

DOCUMENT, DATA = gltf(meshes())


def written(folder: Path, content: Any, name: str = "a.gltf") -> Path:
    file = folder / name
    file.write_bytes(content if isinstance(content, bytes) else json.dumps(content).encode())
    return file


def bounds(body: Any) -> Any:
    return np.array([body.mesh.vertices.min(0), body.mesh.vertices.max(0)])


def assert_is_the_shelf(shapes: Any) -> None:
    assert [body.name for body in shapes.bodies] == list(SHELF)
    assert (shapes.up, shapes.millimetres) == ("y", 1000.0)
    for body, mesh in zip(shapes.bodies, meshes().values(), strict=True):
        turned = mesh.vertices @ TO_Y_UP.T / 1000
        assert np.allclose(bounds(body), [turned.min(0), turned.max(0)], atol=1e-6)


def test_json_with_its_buffer_inside(tmp_path: Path) -> None:
    assert_is_the_shelf(read(written(tmp_path, DOCUMENT)))


def test_binary(tmp_path: Path) -> None:
    document, data = gltf(meshes(), embed=False)
    assert_is_the_shelf(read(written(tmp_path, glb(document, data), "a.glb")))


def test_json_with_its_buffer_beside(tmp_path: Path) -> None:
    (tmp_path / "a b.bin").write_bytes(DATA)
    assert_is_the_shelf(read(written(tmp_path, DOCUMENT | {"buffers": [{"uri": "a%20b.bin"}]})))


def test_nested_nodes_and_copies(tmp_path: Path) -> None:
    document, _ = gltf({"leg": box((0, 0, 0), (100, 100, 1000))})
    half = float(np.sqrt(0.5))
    document["nodes"] = [
        {"name": "table", "children": [1, 2], "translation": [1, 0, 0], "scale": [2, 2, 2]},
        {"name": "upright", "mesh": 0},
        {"children": [3], "rotation": [0, 0, half, half]},
        {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
    ]
    document["scenes"] = [{"nodes": [0]}]
    first, second = read(written(tmp_path, document)).bodies
    assert (first.name, second.name) == ("upright", "table")
    assert np.allclose(bounds(first), [[0.9, -1, -0.1], [1.1, 1, 0.1]])
    assert np.allclose(bounds(second), [[0, -0.1, 9.9], [2, 0.1, 10.1]])


def test_strips_fans_and_meshes_without_triangles(tmp_path: Path) -> None:
    document: Any = copy.deepcopy(DOCUMENT)
    for index, mode in enumerate((5, 6, 0, 1)):
        document["meshes"][index]["primitives"][0] |= {"mode": mode}
    bodies = read(written(tmp_path, document)).bodies
    assert [body.name for body in bodies] == ["Side left", "Side right", "Shelf"]
    assert [len(body.mesh.faces) for body in bodies] == [34, 34, 12]


def test_without_scenes_the_roots_are_shown(tmp_path: Path) -> None:
    document: Any = {key: value for key, value in DOCUMENT.items() if key not in ("scene", "scenes")}
    assert_is_the_shelf(read(written(tmp_path, document)))


def test_quantised_coordinates(tmp_path: Path) -> None:
    values = np.array([[-32767, 0, 0, 0], [32767, 0, 0, 0], [0, 32767, 0, 0]], dtype="<i2")
    document = {
        "asset": {"version": "2.0"},
        "extensionsRequired": ["KHR_mesh_quantization"],
        "nodes": [{"mesh": 0}],
        "meshes": [{"name": "leg", "primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5122, "normalized": True, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 24, "byteStride": 8}],
        "buffers": [{"uri": "a.bin"}],
    }
    (tmp_path / "a.bin").write_bytes(values.tobytes())
    body = read(written(tmp_path, document)).bodies[0]
    assert body.name == "leg"
    assert body.mesh.vertices.tolist() == [[-1, 0, 0], [1, 0, 0], [0, 1, 0]]


def changed(*path: Any) -> Any:
    """The document with the value at the end of a path replaced by the last entry."""
    document: Any = copy.deepcopy(DOCUMENT)
    *steps, last, value = path
    holder = document
    for step in steps:
        holder = holder[step]
    holder[last] = value
    return document


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (b"{", "no glTF file"),
        (b"[" * 100_000, "no glTF file"),
        (b"[]", "no asset"),
        (changed("asset", {"version": "1.0"}), "glTF 1.0"),
        (changed("asset", "version", 7), "glTF 7"),
        (changed("extensionsRequired", ["KHR_draco_mesh_compression"]), "KHR_draco_mesh_compression"),
        (changed("nodes", 0, "children", [0]), "nodes[0]: stands in the tree twice"),
        (changed("nodes", 0, "children", [1]), "nodes[1]: stands in the tree twice"),
        (changed("nodes", 0, "children", [99]), "no nodes[99]"),
        (changed("nodes", 0, "children", "x"), "children: should be a list"),
        (changed("nodes", 0, "mesh", -1), "no meshes[-1]"),
        (changed("nodes", 0, "mesh", "x"), "should be a number"),
        (changed("nodes", 0, "translation", [1, 2]), "should be 3 finite numbers"),
        (changed("nodes", 0, "scale", [1, 2, 1e400]), "should be 3 finite numbers"),
        (changed("nodes", 0, "matrix", list("abcdefghijklmnop")), "should be 16 finite numbers"),
        (changed("nodes", {}), "nodes: should be a list"),
        (changed("nodes", [5]), "no nodes[0]"),
        (changed("scene", 4), "no scenes[4]"),
        (changed("scenes", [{"nodes": []}]), "holds no triangles"),
        (changed("scenes", [{"nodes": 3}]), "should be a list"),
        (changed("meshes", 0, "primitives", [5]), "should be a list of objects"),
        (changed("accessors", 0, "count", 10**9), "more than"),
        (changed("accessors", 0, "count", 10**5), "beyond its buffer"),
        (changed("accessors", 0, "count", -1), "not negative"),
        (changed("accessors", 0, "type", "VEC2"), "should be VEC3"),
        (changed("accessors", 0, "componentType", 77), "known component type"),
        (changed("accessors", 0, "sparse", {}), "is sparse"),
        (changed("accessors", 0, "bufferView", 99), "no bufferViews[99]"),
        (changed("accessors", 1, "componentType", 5122), "unsigned"),
        (changed("bufferViews", 0, "byteOffset", 10**9), "beyond its buffer"),
        (changed("bufferViews", 0, "byteStride", 2), "beyond its buffer"),
        (changed("bufferViews", 1, "byteOffset", 3), "beyond its"),
        (changed("buffers", 0, "uri", "data:;base64,???"), "not base64"),
        (changed("buffers", 0, "uri", 5), "should be text"),
        (changed("buffers", 0, "uri", "../a.bin"), "leads out"),
        (changed("buffers", 0, "uri", "/etc/passwd"), "leads out"),
        (changed("buffers", 0, "uri", "%2e%2e/a.bin"), "leads out"),
        (changed("buffers", 0, "uri", "http://a.b/c.bin"), "same folder"),
        (changed("buffers", 0, "uri", "none.bin"), "no file"),
        (changed("buffers", []), "no buffers[0]"),
        (glb(DOCUMENT, b"")[:50], "truncated"),
        (glb(DOCUMENT, b"")[:12] + bytes(20), "shorter than it says"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, content: Any, says: str) -> None:
    with pytest.raises(RecipeError) as caught:
        read(written(tmp_path, content))
    assert says in str(caught.value)


def test_a_deep_tree(tmp_path: Path) -> None:
    nodes: list[Any] = [{"children": [index + 1]} for index in range(200)] + [{"mesh": 0}]
    with pytest.raises(RecipeError, match="deep"):
        read(written(tmp_path, DOCUMENT | {"nodes": nodes, "scenes": [{"nodes": [0]}]}))


def test_scales_that_grow_beyond_numbers(tmp_path: Path) -> None:
    nodes: list[Any] = [{"children": [index + 1], "scale": [1e11, 1e11, 1e11]} for index in range(40)] + [{"mesh": 0}]
    with pytest.raises(RecipeError, match="no place for furniture"):
        read(written(tmp_path, DOCUMENT | {"nodes": nodes, "scenes": [{"nodes": [0]}]}))


def test_copies_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nodes = [{"mesh": 0} for _ in range(100)]
    file = written(tmp_path, DOCUMENT | {"nodes": nodes, "scenes": [{"nodes": list(range(100))}]})
    assert len(read(file).bodies) == 100
    for name, most, says in (
        ("MOST_TRIANGLES", 500, "triangles"),
        ("MOST_BODIES", 9, "bodies"),
        ("MOST_NODES", 9, "nodes"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(limits, name, most)
            with pytest.raises(RecipeError, match=f"{most} {says}"):
                read(file)
