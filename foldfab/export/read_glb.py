"""Reading back the fold from a GLB: the node tree, the meshes and the poses at any instant.

Only what foldfab writes: translation, rotation, scale, LINEAR channels, indexed triangles without strides.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from foldfab.export import quaternion
from foldfab.geometry.arrays import Array, Indices

COMPONENTS = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
TO_SHEET = 1000.0 * np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""(3, 3) glTF metres with Y up to millimetres with Z up."""
DEEPEST = 64
"""Levels of the node tree; more is a loop."""


@dataclass(frozen=True, slots=True, eq=False)
class Fold:
    """An animated node tree."""

    nodes: list[dict[str, Any]]
    parents: dict[int, int]
    tracks: dict[tuple[int, str], tuple[Array, Array]]
    """By node and path, (k,) seconds and (k, 3 or 4) values."""
    meshes: dict[str, tuple[Array, Indices]]
    """By node name, (n, 3) vertices in the node's own coordinates and (m, 3) faces."""
    numbers: dict[str, int]
    """By node name, its index."""
    seconds: float
    """How long the fold plays; 0 where nothing moves."""


def read_glb(path: Path) -> Fold:
    """The fold of a GLB.

    Raises:
        ValueError, KeyError, IndexError, TypeError, struct.error: the file is damaged or of another make.
    """
    document, data = _chunks(path)
    nodes = document["nodes"]
    numbers = {node["name"]: i for i, node in enumerate(nodes) if "mesh" in node}
    tracks = _tracks(document, data)
    return Fold(
        nodes=nodes,
        parents={child: i for i, node in enumerate(nodes) for child in node.get("children", [])},
        tracks=tracks,
        meshes={name: _mesh(document, data, nodes[i]["mesh"]) for name, i in numbers.items()},
        numbers=numbers,
        seconds=max((float(times[-1]) for times, _ in tracks.values()), default=0.0),
    )


def pose(fold: Fold, name: str, share: float) -> Array:
    """(4, 4) from a part's own coordinates to the sheet frame (mm, Z up), at a share in [0, 1] of the fold."""
    node, matrix = fold.numbers[name], np.eye(4)
    for _ in range(DEEPEST):
        matrix = _local(fold, node, share * fold.seconds) @ matrix
        if node not in fold.parents:
            turned = np.eye(4)
            turned[:3] = TO_SHEET @ matrix[:3]
            return turned
        node = fold.parents[node]
    raise ValueError("the node tree has a loop")


def _chunks(path: Path) -> tuple[dict[str, Any], bytes]:
    blob = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", blob)
    if magic != b"glTF" or version != 2 or length != len(blob):
        raise ValueError(f"{path.name} is cut off, or no GLB of glTF 2.0")
    size, kind = struct.unpack_from("<I4s", blob, 12)
    extra, other = struct.unpack_from("<I4s", blob, 20 + size)
    if kind != b"JSON" or other != b"BIN\0" or 28 + size + extra != length:
        raise ValueError(f"{path.name} has other chunks than a text and a buffer")
    return json.loads(blob[20 : 20 + size]), blob[28 + size :]


def _accessor(document: dict[str, Any], data: bytes, index: int) -> Any:
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    width = WIDTHS[accessor["type"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    kind = np.dtype(COMPONENTS[accessor["componentType"]])
    if "byteStride" in view or start % kind.itemsize:
        raise ValueError("the GLB has strided or unaligned data")
    values = np.frombuffer(data, kind, accessor["count"] * width, start)
    if not np.isfinite(values).all():
        raise ValueError("the GLB holds NaN or infinity")
    return values.reshape(-1, width)


def _mesh(document: dict[str, Any], data: bytes, index: int) -> tuple[Array, Indices]:
    vertices: list[Array] = []
    faces: list[Indices] = []
    for primitive in document["meshes"][index]["primitives"]:
        vertices.append(_accessor(document, data, primitive["attributes"]["POSITION"]).astype(np.float64))
        own = _accessor(document, data, primitive["indices"]).astype(np.int64).reshape(-1, 3)
        if own.max(initial=0) >= len(vertices[-1]):
            raise ValueError("the GLB refers to vertices that it does not have")
        faces.append(own + sum(len(v) for v in vertices[:-1]))
    points, rename = np.unique(np.vstack(vertices), axis=0, return_inverse=True)
    return points, rename.reshape(-1)[np.vstack(faces)]


def _tracks(document: dict[str, Any], data: bytes) -> dict[tuple[int, str], tuple[Array, Array]]:
    tracks: dict[tuple[int, str], tuple[Array, Array]] = {}
    for animation in document.get("animations", []):
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            times = _accessor(document, data, sampler["input"]).astype(np.float64)[:, 0]
            values = _accessor(document, data, sampler["output"]).astype(np.float64)
            if sampler.get("interpolation", "LINEAR") != "LINEAR" or len(times) != len(values):
                raise ValueError("the GLB's channels are not LINEAR")
            if len(times) == 0 or np.any(np.diff(times) <= 0):
                raise ValueError("the GLB's keys are not in order")
            tracks[channel["target"]["node"], channel["target"]["path"]] = times, values
    return tracks


def _local(fold: Fold, node: int, seconds: float) -> Array:
    if "matrix" in fold.nodes[node]:
        raise ValueError("the GLB has a node placed by a matrix")
    matrix = np.eye(4)
    turn = quaternion.to_matrix(_value(fold, node, "rotation", (0.0, 0.0, 0.0, 1.0), seconds))
    matrix[:3, :3] = turn * _value(fold, node, "scale", (1.0, 1.0, 1.0), seconds)
    matrix[:3, 3] = _value(fold, node, "translation", (0.0, 0.0, 0.0), seconds)
    return matrix


def _value(fold: Fold, node: int, path: str, default: tuple[float, ...], seconds: float) -> Array:
    if (node, path) not in fold.tracks:
        return np.array(fold.nodes[node].get(path, default), dtype=np.float64)
    times, values = fold.tracks[node, path]
    after = int(np.searchsorted(times, seconds, side="right"))
    if after in (0, len(times)):
        return np.asarray(values[min(after, len(times) - 1)])
    first, second = values[after - 1], values[after]
    share = float((seconds - times[after - 1]) / (times[after] - times[after - 1]))
    if path == "rotation":
        return quaternion.slerp(first / np.linalg.norm(first), second / np.linalg.norm(second), share)
    return np.asarray(first + share * (second - first))
