"""The fold as one glTF 2.0 animation in a binary GLB.

A root node turns the sheet frame (mm, Z up) into glTF's (m, Y up); under it stands a node for each body, named after
it. A body's mesh is kept relative to the middle of its hinge axes: turning about a point on the axis, the straight
line between two keys is the true motion, and for a panel with two hinges the error is the least.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foldfab.export import quaternion
from foldfab.export.colours import COLOURS, NAMES, materials
from foldfab.export.frames import moved, sheet_poses, to_sheet
from foldfab.export.shell import GRID_DIGITS, Shell
from foldfab.export.version import foldfab_version
from foldfab.fabrication.model import Assembly
from foldfab.geometry.arrays import Array, Bools, Indices

SECONDS = 8.0
"""How long the fold plays."""
KEY_DIGITS = 7
"""Key values are rounded so far; what differs by less is at rest."""
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
FLOAT, UNSIGNED_INT = 5126, 5125
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}


class _Binary:
    """Collects accessors, their views and the one buffer behind them; equal data is stored once."""

    def __init__(self) -> None:
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, Any]] = []
        self.data = bytearray()
        self._known: dict[tuple[bytes, str, int | None], int] = {}

    def add(self, values: NDArray[Any], target: int | None = None) -> int:
        """Index of an accessor for (n, width) values of 4 bytes each."""
        kind, blob = TYPES[values.shape[1]], values.tobytes()
        key = (blob, f"{kind}{values.dtype}", target)
        if key not in self._known:
            view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(blob)}
            self.views.append(view | ({"target": target} if target else {}))
            self.data += blob
            self.accessors.append(self._accessor(values, kind))
            self._known[key] = len(self.accessors) - 1
        return self._known[key]

    def _accessor(self, values: NDArray[Any], kind: str) -> dict[str, Any]:
        component = FLOAT if values.dtype == np.float32 else UNSIGNED_INT
        return {
            "bufferView": len(self.views) - 1,
            "componentType": component,
            "count": len(values),
            "type": kind,
            "min": values.min(axis=0).tolist(),
            "max": values.max(axis=0).tolist(),
        }


def glb_bytes(assembly: Assembly, shells: tuple[Shell, ...]) -> bytes:
    """The animation of (sheet frame, open posture) shells as a GLB."""
    binary = _Binary()
    nodes: list[dict[str, Any]] = [_root(assembly, len(shells))]
    meshes: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    samplers: list[dict[str, Any]] = []
    for shell in shells:
        pivot = _pivot(assembly, shell)
        meshes.append(_mesh(binary, shell, pivot))
        tracks = _tracks(assembly, shell.name, pivot)
        rest = {path: values[0].tolist() for path, values in tracks.items()}
        nodes.append({"name": shell.name, "mesh": len(meshes) - 1} | rest)
        for path, values in tracks.items():
            if (is_key := _keys(values)).any():
                channels.append({"sampler": len(samplers), "target": {"node": len(nodes) - 1, "path": path}})
                samplers.append(_sampler(binary, assembly.times, values, is_key))
    document = _document(binary, nodes, meshes, channels, samplers)
    return _container(document, bytes(binary.data))


def _root(assembly: Assembly, count: int) -> dict[str, Any]:
    half = float(np.sqrt(0.5))
    return {
        "name": f"{assembly.solution.scaffold.recipe.name} (sheet)",
        "rotation": [-half, 0.0, 0.0, half],
        "scale": [0.001, 0.001, 0.001],
        "children": list(range(1, count + 1)),
    }


def _pivot(assembly: Assembly, shell: Shell) -> Array:
    # Pieces of a part turn about the same point, or they would move against each other between two keys.
    mates = next((set(names) for names in assembly.pieces.values() if shell.name in names), {shell.name})
    axes = [joint.axis for joint in assembly.hinges if mates & set(joint.parts)]
    if axes:
        middle = to_sheet(assembly, np.mean(axes, axis=(0, 1)))
    else:
        middle = (shell.vertices.min(axis=0) + shell.vertices.max(axis=0)) / 2
    return np.asarray(np.round(middle, GRID_DIGITS) + 0.0)


def _mesh(binary: _Binary, shell: Shell, pivot: Array) -> dict[str, Any]:
    position = binary.add((shell.vertices - pivot).astype(np.float32) + np.float32(0), ARRAY_BUFFER)
    index = materials(shell)
    primitives = [
        {
            "attributes": {"POSITION": position},
            "indices": binary.add(_scalars(shell.faces[index == material]), ELEMENT_ARRAY_BUFFER),
            "material": material,
        }
        for material in np.unique(index).tolist()
    ]
    return {"name": shell.name, "primitives": primitives}


def _scalars(faces: Indices) -> NDArray[np.uint32]:
    return faces.astype(np.uint32).reshape(-1, 1)


def _tracks(assembly: Assembly, name: str, pivot: Array) -> dict[str, NDArray[np.float32]]:
    poses = sheet_poses(assembly, name)
    places = np.array([moved(pivot[None], pose)[0] for pose in poses])
    turns = quaternion.from_matrices(poses[:, :3, :3])
    return {
        "translation": (np.round(places, KEY_DIGITS) + 0.0).astype(np.float32),
        "rotation": (np.round(turns, KEY_DIGITS) + 0.0).astype(np.float32),
    }


def _keys(values: NDArray[np.float32]) -> Bools:
    """(k,) which keys are needed: the ends and all but the inside of rests; none at all for a body at rest."""
    is_same = np.all(values[1:] == values[:-1], axis=1)
    if is_same.all():
        return np.zeros(len(values), dtype=bool)
    is_inside = np.concatenate([[False], is_same[1:] & is_same[:-1], [False]])
    return ~is_inside


def _sampler(binary: _Binary, times: Array, values: NDArray[np.float32], is_key: Bools) -> dict[str, Any]:
    seconds = (times[is_key] * SECONDS).astype(np.float32).reshape(-1, 1)
    return {"input": binary.add(seconds), "output": binary.add(values[is_key]), "interpolation": "LINEAR"}


def _document(
    binary: _Binary,
    nodes: list[dict[str, Any]],
    meshes: list[dict[str, Any]],
    channels: list[dict[str, Any]],
    samplers: list[dict[str, Any]],
) -> dict[str, Any]:
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": f"foldfab {foldfab_version()}"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [_material(name, rgb) for name, rgb in zip(NAMES, COLOURS, strict=True)],
        "accessors": binary.accessors,
        "bufferViews": binary.views,
        "buffers": [{"byteLength": len(binary.data)}],
    }
    # glTF forbids an animation without channels: furniture of bases alone does not move.
    if channels:
        document["animations"] = [{"name": "fold", "channels": channels, "samplers": samplers}]
    return document


def _material(name: str, rgb: tuple[int, int, int]) -> dict[str, Any]:
    # glTF colours are linear, those of the other files are sRGB.
    linear = [round((value / 255) ** 2.2, 4) for value in rgb]
    return {
        "name": name,
        "pbrMetallicRoughness": {"baseColorFactor": [*linear, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8},
    }


def _container(document: dict[str, Any], data: bytes) -> bytes:
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=True).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks
