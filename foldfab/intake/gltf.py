"""glTF 2.0, as .glb or .gltf: a body for each node with a mesh, where its ancestors place it.

Of our own, on numpy: every count, index and reference is judged before it is followed, so that a hostile file costs
nothing. What only changes looks (materials, textures, skins, cameras) is passed over.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from foldfab.geometry.arrays import Array, Indices
from foldfab.intake.accessors import Buffers, JsonObject, entry, floats, indices
from foldfab.intake.limits import check_bodies, check_depth, check_nodes, check_triangles, content, fail
from foldfab.intake.meshes import body, joined, placed, product
from foldfab.intake.model import Body, Shapes
from foldfab.recipe.model import Mesh

_MAGIC, _JSON, _BINARY = b"glTF", 0x4E4F534A, 0x004E4942
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_UNDERSTOOD = ("KHR_mesh_quantization", "KHR_materials", "KHR_texture", "KHR_lights", "EXT_texture")
"""Required extensions, by how they begin, that are understood or do not matter for shapes."""
METRE = 1000.0
"""mm: the unit of all glTF."""


def read(path: Path) -> Shapes:
    """The bodies of a glTF file: metres, Y up, as the format states.

    Raises:
        RecipeError: it is no glTF file, is damaged, refers to files outside its folder, or is too large.
    """
    document, binary = _parts(path, content(path))
    version = str(entry(path, document, "asset", dict).get("version", ""))
    if not version.startswith("2."):
        fail(path, f"is glTF {version[:10] or 'of no version'}; export it as glTF 2.0", "asset.version")
    for name in document.get("extensionsRequired", []):
        if not str(name).startswith(_UNDERSTOOD):
            fail(path, f"needs the extension {str(name)[:60]!r}, which is not read; export it without", "extensions")
    buffers = Buffers(path, document, binary)
    meshes: dict[int, Mesh | None] = {}
    found: list[Body] = []
    triangles = 0
    for name, index, matrix in _placements(path, document):
        if index not in meshes:
            meshes[index] = _mesh(path, buffers, index)
        mesh = meshes[index]
        if mesh is not None:
            triangles += len(mesh.faces)
            check_triangles(path, triangles)
            check_bodies(path, len(found) + 1)
            moved = placed(mesh, matrix)
            found.append(body(path, name, moved.vertices, moved.faces))
    if not found:
        fail(path, "holds no triangles that a node places")
    return Shapes(tuple(found), up="y", millimetres=METRE)


def _parts(path: Path, data: bytes) -> tuple[JsonObject, bytes]:
    """The JSON and the binary chunk."""
    if not data.startswith(_MAGIC):
        return _json(path, data), b""
    if len(data) < 20 or int.from_bytes(data[8:12], "little") > len(data):
        fail(path, "is shorter than it says; it is truncated")
    chunks: dict[int, bytes] = {}
    at = 12
    while at + 8 <= len(data):
        size, kind = (int.from_bytes(data[at + shift : at + shift + 4], "little") for shift in (0, 4))
        if at + 8 + size > len(data):
            fail(path, "has a chunk that ends after the file does; it is truncated")
        chunks.setdefault(kind, data[at + 8 : at + 8 + size])
        at += 8 + size
    if _JSON not in chunks:
        fail(path, "has no JSON chunk; the file is damaged")
    return _json(path, chunks[_JSON]), chunks.get(_BINARY, b"")


def _json(path: Path, data: bytes) -> JsonObject:
    try:
        document = json.loads(data.decode("utf-8-sig", "replace"))
    except (ValueError, RecursionError):
        fail(path, "is no glTF file: its JSON cannot be read")
    if not isinstance(document, dict) or "asset" not in document:
        fail(path, "is no glTF file: it has no asset")
    return document


def _placements(path: Path, document: JsonObject) -> list[tuple[str, int, Array]]:
    """Name, mesh and matrix (4, 4) of each node that shows a mesh, in the order of the tree."""
    nodes = entry(path, document, "nodes", list)
    check_nodes(path, len(nodes))
    pending = [(root, np.eye(4), 0, "") for root in reversed(_roots(path, document, nodes))]
    seen: set[int] = set()
    found = []
    while pending:
        index, outer, depth, above = pending.pop()
        check_depth(path, depth)
        if index in seen:
            fail(path, "stands in the tree twice, or within itself; the file is damaged", f"nodes[{index}]")
        seen.add(index)
        node = _at(path, nodes, index, "nodes")
        matrix = product(outer, _matrix(path, node, index))
        name = str(node.get("name") or "")
        if "mesh" in node:
            mesh = node["mesh"]
            if not isinstance(mesh, int):
                fail(path, "should be a number", f"nodes[{index}].mesh")
            found.append((name or _mesh_name(path, document, mesh) or above, mesh, matrix))
        children = node.get("children", [])
        if not isinstance(children, list):
            fail(path, "should be a list", f"nodes[{index}].children")
        pending += [(child, matrix, depth + 1, name or above) for child in reversed(children)]
    return found


def _roots(path: Path, document: JsonObject, nodes: list[Any]) -> list[Any]:
    """The nodes of the scene, or those without a parent where there is no scene."""
    scenes = document.get("scenes")
    if isinstance(scenes, list) and scenes:
        roots = _at(path, scenes, document.get("scene", 0), "scenes").get("nodes", [])
        if isinstance(roots, list):
            return roots
        fail(path, "should be a list", "scenes[].nodes")
    within = {child for node in nodes if isinstance(node, dict) for child in _ints(node.get("children"))}
    return [index for index in range(len(nodes)) if index not in within]


def _ints(values: Any) -> list[int]:
    return [value for value in values if isinstance(value, int)] if isinstance(values, list) else []


def _at(path: Path, values: list[Any], index: Any, what: str) -> JsonObject:
    is_there = isinstance(index, int) and 0 <= index < len(values)
    if not is_there or not isinstance(values[index], dict):
        fail(path, f"there is no {what}[{str(index)[:20]}] that is an object; the file is damaged", what)
    found: JsonObject = values[index]
    return found


def _mesh_name(path: Path, document: JsonObject, index: int) -> str:
    return str(_at(path, entry(path, document, "meshes", list), index, "meshes").get("name") or "")


def _matrix(path: Path, node: JsonObject, index: int) -> Array:
    """(4, 4) of one node."""
    if "matrix" in node:
        return _numbers(path, node["matrix"], 16, f"nodes[{index}].matrix").reshape(4, 4).T
    x, y, z, w = _numbers(path, node.get("rotation", [0, 0, 0, 1]), 4, f"nodes[{index}].rotation")
    scale = _numbers(path, node.get("scale", [1, 1, 1]), 3, f"nodes[{index}].scale")
    matrix = np.eye(4)
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] = np.array(turn) * scale
    matrix[:3, 3] = _numbers(path, node.get("translation", [0, 0, 0]), 3, f"nodes[{index}].translation")
    return matrix


def _numbers(path: Path, values: Any, count: int, where: str) -> Array:
    try:
        found = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        found = np.zeros(0)
    if found.shape != (count,) or not (np.abs(found) < 1e12).all():
        fail(path, f"should be {count} finite numbers", where)
    return found


def _mesh(path: Path, buffers: Buffers, index: int) -> Mesh | None:
    """All triangles of a mesh; None where it has only points and lines."""
    mesh = _at(path, entry(path, buffers.document, "meshes", list), index, "meshes")
    pieces = []
    for primitive in entry(path, mesh, "primitives", list):
        if not isinstance(primitive, dict):
            fail(path, "should be a list of objects", f"meshes[{index}].primitives")
        mode = primitive.get("mode", _TRIANGLES)
        attributes = entry(path, primitive, "attributes", dict)
        if mode not in (_TRIANGLES, _STRIP, _FAN) or "POSITION" not in attributes:
            continue
        vertices = floats(buffers, attributes["POSITION"])
        order = indices(buffers, primitive["indices"]) if "indices" in primitive else np.arange(len(vertices))
        faces = _faces(order, mode)
        check_triangles(path, len(faces))
        # Judged here already: copies are not worth making of what is damaged.
        pieces.append(body(path, str(mesh.get("name") or index), vertices, faces).mesh)
    whole = [piece for piece in pieces if len(piece.faces)]
    return joined(whole) if whole else None


def _faces(order: Indices, mode: int) -> Indices:
    """(m, 3) triangles of a list, a strip or a fan of vertices."""
    if mode == _TRIANGLES:
        return order[: len(order) // 3 * 3].reshape(-1, 3)
    if mode == _FAN:
        return np.stack([np.broadcast_to(order[:1], order[1:-1].shape), order[1:-1], order[2:]], axis=1)
    faces = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
    faces[1::2] = faces[1::2, ::-1]
    return faces
