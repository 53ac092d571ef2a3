"""STL: a file of one or more solids, or a folder of files whose names are the parts'."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array, handed
from foldfab.intake.limits import check_bodies, check_triangles, content, fail
from foldfab.intake.meshes import body, distinct, joined
from foldfab.intake.model import Body, Shapes

_HEAD, _RECORD = 84, 50
"""Bytes of a binary file's head and of each triangle."""
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
_VERTEX = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)")
_SOLID = re.compile(rb"^[ \t]*solid\b[ \t]*([^\r\n]*)", re.MULTILINE)


def read(path: Path) -> Shapes:
    """The solids of an STL file, which states neither its unit nor its up axis; by custom Z.

    Raises:
        RecipeError: it is no STL file, is damaged, or too large.
    """
    return Shapes(_bodies(path))


def read_folder(path: Path) -> Shapes:
    """Each STL file of a folder as one body, in the order of their names.

    Raises:
        RecipeError: it holds none, or one of them cannot be read.
    """
    files = sorted(file for file in path.iterdir() if file.suffix.lower() == ".stl" and not file.name.startswith("."))
    if not files:
        fail(path, "is a folder without STL files; give a recipe or a file of shapes", "folder")
    check_bodies(path, len(files))
    found, triangles = [], 0
    for file in files:
        if not file.resolve().is_relative_to(path.resolve()):
            fail(file, "leads out of its folder; copy it there", "file")
        mesh = joined([solid.mesh for solid in _bodies(file)])
        triangles += len(mesh.faces)
        check_triangles(path, triangles)
        found.append(Body(file.stem.encode("utf-8", "replace").decode(), mesh))
    return Shapes(tuple(found))


def _bodies(path: Path) -> tuple[Body, ...]:
    data = content(path)
    stated = int.from_bytes(data[80:_HEAD], "little") if len(data) >= _HEAD else 0
    if len(data) >= _HEAD and len(data) == _HEAD + _RECORD * stated:
        return _binary(path, data, stated)
    if data.lstrip().startswith(b"solid") and b"facet" in data:
        return _text(path, data)
    there = max(0, (len(data) - _HEAD) // _RECORD)
    return fail(path, f"says it holds {stated} triangles, but has room for {there}; it is truncated, or no STL file")


def _binary(path: Path, data: bytes, count: int) -> tuple[Body, ...]:
    check_triangles(path, count)
    if not count:
        fail(path, "holds no triangles")
    corners = np.frombuffer(data, _TRIANGLE, count, _HEAD)["corners"]
    # A signalling NaN is told of when it is cast; which vertex it is, is said below.
    with np.errstate(invalid="ignore"):
        return (_soup(path, "", corners.reshape(-1, 3)),)


def _text(path: Path, data: bytes) -> tuple[Body, ...]:
    heads = list(_SOLID.finditer(data))
    ends = [head.start() for head in heads[1:]] + [len(data)]
    check_bodies(path, len(heads))
    check_triangles(path, data.count(b"vertex") // 3)
    if data.count(b"endsolid") < len(heads):
        fail(path, "ends before its last solid does; it is truncated")
    found = []
    for head, end in zip(heads, ends, strict=True):
        chunk = data[head.end() : end]
        corners = _VERTEX.findall(chunk)
        if len(corners) != 3 * len(re.findall(rb"\bfacet\s+normal\b", chunk)):
            fail(path, "has a facet that does not have three vertices; the file is damaged")
        if corners:
            name = head[1].strip().decode("utf-8", "replace")
            found.append(_soup(path, name, _numbers(path, corners)))
    if not found:
        fail(path, "holds no triangles")
    return tuple(found)


def _numbers(path: Path, corners: list[tuple[bytes, bytes, bytes]]) -> Array:
    try:
        return np.array(corners, dtype="S32").astype(np.float64)
    except ValueError:
        fail(path, "has a vertex that is not three numbers; the file is damaged")


def _soup(path: Path, name: str, corners: Array) -> Body:
    """Triangles of three vertices each, with those that are the same made one."""
    is_none = np.isnan(corners)
    vertices, index = distinct(np.where(is_none, np.inf, corners) if is_none.any() else corners)
    return body(path, name, handed(vertices.astype(np.float64)), index.reshape(-1, 3))
