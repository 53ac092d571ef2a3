"""OBJ files: a body for each object, or for each group where there are no two objects.

Of our own, because trimesh makes one mesh of all groups, or one for each material; which part a face belongs to is all
that matters here.
"""

from __future__ import annotations

import io
from array import array
from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array, handed
from foldfab.intake.limits import check_bodies, check_triangles, check_vertices, content, fail
from foldfab.intake.meshes import body
from foldfab.intake.model import Shapes

_EVERY = 4096
"""Lines between two counts of what was read."""
_SPREAD = 2
"""A body's vertices stand together, as a rule; where they are spread this much, they are gathered."""
_LONGEST_LINE = 100_000
"""Bytes."""


def read(path: Path) -> Shapes:
    """The bodies of an OBJ file, which states neither its unit nor its up axis; by custom Z.

    Raises:
        RecipeError: it is no OBJ file, is damaged, or too large.
    """
    places: array[float] = array("d")
    found: dict[tuple[bytes, bytes], array[int]] = defaultdict(lambda: array("q"))
    thing, group = b"", b""
    faces = found[thing, group]
    triangles = 0
    for number, line in enumerate(_lines(content(path)), 1):
        word, _, rest = line.strip().partition(b" ")
        try:
            if word == b"v":
                places.extend(_three(rest))
            elif word == b"f":
                triangles += _fan(rest, len(places) // 3, faces)
            elif word in (b"o", b"g"):
                thing, group = (rest.strip(), b"") if word == b"o" else (thing, rest.strip())
                faces = found[thing, group]
        except (ValueError, OverflowError) as error:
            fail(path, f"{error}; the file is damaged", f"line {number}")
        if not number % _EVERY:
            _count(path, len(found), triangles, len(places) // 3)
    _count(path, len(found), triangles, len(places) // 3)
    if not triangles:
        fail(path, "holds no faces; is it an OBJ file?")
    return _shapes(path, np.frombuffer(places).reshape(-1, 3), {key: part for key, part in found.items() if part})


def _lines(data: bytes) -> Iterator[bytes]:
    """One by one, as a list of them would take many times the file."""
    return iter(io.BytesIO(data if b"\n" in data else data.replace(b"\r", b"\n")))


def _count(path: Path, bodies: int, triangles: int, vertices: int) -> None:
    check_bodies(path, bodies)
    check_triangles(path, triangles)
    check_vertices(path, vertices)


def _shapes(path: Path, vertices: Array, found: dict[tuple[bytes, bytes], array[int]]) -> Shapes:
    """Faces by object where there are several, else by group; those of one name belong together."""
    by_object = len({thing for thing, _ in found}) > 1
    parts: dict[bytes, list[array[int]]] = defaultdict(list)
    for (thing, group), faces in found.items():
        parts[thing if by_object else group or thing].append(faces)
    bodies = []
    for name, pieces in parts.items():
        corners = np.concatenate([np.frombuffer(piece, dtype=np.int64) for piece in pieces]).reshape(-1, 3)
        low, high = int(corners.min()), int(corners.max())
        text = name.decode("utf-8", "replace")
        if low < 0 or high >= len(vertices):
            fail(path, f"a face names a vertex beyond the {len(vertices)} there are; the file is damaged", "faces")
        if high - low < _SPREAD * corners.size:
            bodies.append(body(path, text, vertices[low : high + 1], corners - low))
            continue
        used, renumbered = np.unique(corners, return_inverse=True)
        bodies.append(body(path, text, handed(vertices[used]), renumbered.reshape(-1, 3)))
    return Shapes(tuple(bodies))


def _three(rest: bytes) -> tuple[float, float, float]:
    words = rest.split(None, 3)
    if len(words) < 3:
        raise ValueError("a vertex has fewer than three coordinates")
    return float(words[0]), float(words[1]), float(words[2])


def _fan(rest: bytes, count: int, faces: array[int]) -> int:
    """Adds the triangles of a polygon; negative numbers count from the last of `count` vertices."""
    if len(rest) > _LONGEST_LINE:
        raise ValueError("a face has more corners than any face has")
    corners = [int(word.split(b"/", 1)[0]) for word in rest.split()]
    if len(corners) < 3:
        raise ValueError("a face has fewer than three corners")
    if len(corners) == 3 and min(corners) > 0:
        faces.extend((corners[0] - 1, corners[1] - 1, corners[2] - 1))
        return 1
    places = [corner - 1 if corner > 0 else count + corner for corner in corners]
    if 0 in corners or min(places) < 0:
        raise ValueError("a face names a vertex that is not there")
    first = places[0]
    for second, third in pairwise(places[1:]):
        faces.extend((first, second, third))
    return len(places) - 2
