"""Reading back the meshes of a print folder: binary STL, and the 3MF with its names."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from foldfab.export.mesh_files import RECORD
from foldfab.geometry.arrays import Array, Indices

CONFIG = "Metadata/Slic3r_PE_model.config"
LARGEST_CONFIG = 50_000_000
"""Bytes; a print's names take a few kB."""


@dataclass(frozen=True, slots=True, eq=False)
class PrintFile:
    """A 3MF as its strict reader sees it."""

    vertices: Array
    """(n, 3) mm, as they will be printed."""
    faces: Indices
    """(m, 3)"""
    volumes: tuple[tuple[str, int, int], ...]
    """Name, first and last face of each body."""
    warnings: int
    is_sound: bool
    """Whether the whole mesh is closed and oriented."""


def read_stl(path: Path) -> tuple[Array, Indices]:
    """(n, 3) welded vertices and (m, 3) faces of a binary STL.

    Raises:
        ValueError: the file is cut off, or no binary STL.
    """
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    if len(data) < 84 or len(data) != 84 + count * RECORD.itemsize:
        raise ValueError(f"{path.name} is cut off, or no binary STL")
    corners = np.frombuffer(data, RECORD, count, 84)["corners"].reshape(-1, 3).astype(np.float64)
    vertices, index = np.unique(corners, axis=0, return_inverse=True)
    return vertices, index.reshape(-1, 3).astype(np.int64)


def read_threemf(path: Path, *, is_loose: bool = False) -> PrintFile:
    """A print file through lib3mf's strict reader; where it `is_loose`, an object is a body.

    Raises:
        ValueError: it is refused, or not one item of one mesh in millimetres with its bodies named.
    """
    import lib3mf
    from lib3mf import get_wrapper

    model = get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    if model.GetUnit() != lib3mf.ModelUnit.MilliMeter:
        raise ValueError(f"{path.name} is not in millimetres")
    meshes = list(_meshes(model))
    if not is_loose and (len(meshes), model.GetMeshObjects().Count()) != (1, 1):
        count = model.GetMeshObjects().Count()
        raise ValueError(f"{path.name} has {len(meshes)} items of {count} meshes; slicers would take it apart")
    if not meshes:
        raise ValueError(f"{path.name} is empty")
    starts = np.cumsum([0, *(len(vertices) for _, vertices, _, _ in meshes)])
    faces = np.vstack([f + start for (_, _, f, _), start in zip(meshes, starts, strict=False)])
    volumes = _objects(meshes) if is_loose else _volumes(path, len(faces))
    vertices, is_sound = np.vstack([v for _, v, _, _ in meshes]), all(sound for _, _, _, sound in meshes)
    return PrintFile(vertices, faces, volumes, int(reader.GetWarningCount()), is_sound)


def _meshes(model: Any) -> Iterator[tuple[str, Array, Indices, bool]]:
    """Name, vertices, faces and soundness of each build item."""
    items = model.GetBuildItems()
    while items.MoveNext():
        item = items.GetCurrent()
        mesh = model.GetMeshObjectByID(item.GetObjectResourceID())
        vertices = np.array([tuple(vertex.Coordinates) for vertex in mesh.GetVertices()], dtype=np.float64)
        faces = np.array([tuple(triangle.Indices) for triangle in mesh.GetTriangleIndices()], dtype=np.int64)
        yield mesh.GetName(), _placed(item, vertices), faces, bool(mesh.IsManifoldAndOriented())


def _objects(meshes: list[tuple[str, Array, Indices, bool]]) -> tuple[tuple[str, int, int], ...]:
    ends = np.cumsum([len(faces) for _, _, faces, _ in meshes]).tolist()
    return tuple((m[0], end - len(m[2]), end - 1) for m, end in zip(meshes, ends, strict=True))


def _placed(item: Any, vertices: Array) -> Array:
    if not item.HasObjectTransform():
        return vertices
    fields = item.GetObjectTransform().Fields
    matrix = np.array([[fields[row][column] for column in range(3)] for row in range(4)])
    return np.asarray(vertices @ matrix[:3] + matrix[3])


def _volumes(path: Path, count: int) -> tuple[tuple[str, int, int], ...]:
    with zipfile.ZipFile(path) as archive:
        if archive.getinfo(CONFIG).file_size > LARGEST_CONFIG:
            raise ValueError(f"{path.name} has an oversized list of names")
        root = ElementTree.fromstring(archive.read(CONFIG))
    volumes = tuple(_volume(element) for element in root.iter("volume"))
    ends = [0, *(last + 1 for _, _, last in volumes)]
    if [first for _, first, _ in volumes] != ends[:-1] or ends[-1] != count:
        raise ValueError(f"{path.name}: the named ranges do not cover the mesh")
    return volumes


def _volume(element: ElementTree.Element) -> tuple[str, int, int]:
    names = (row.get("value", "") for row in element.iter("metadata") if row.get("key") == "name")
    return next(names, ""), int(element.attrib["firstid"]), int(element.attrib["lastid"])
