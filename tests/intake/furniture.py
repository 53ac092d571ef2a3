"""A small piece of furniture of named boxes, and writers of it in every format, by hand."""

from __future__ import annotations

import base64
import json
import struct
import zipfile
from itertools import product
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array, Indices
from foldfab.recipe.model import Mesh

SHELF: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "Side left": ((9, 150, 400), (18, 300, 764)),
    "Side right": ((491, 150, 400), (18, 300, 764)),
    "Top": ((250, 150, 791), (500, 300, 18)),
    "Bottom": ((250, 150, 9), (500, 300, 18)),
    "Shelf": ((250, 150, 400), (464, 300, 18)),
}
"""Middle and size of each part, mm, Z up."""

_CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
FACES: Indices = np.concatenate([_QUADS[:, [0, 1, 2]], _QUADS[:, [0, 2, 3]]]).astype(np.int64)
TO_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


def box(center: tuple[float, ...], size: tuple[float, ...], axes: Array | None = None) -> Mesh:
    """A box as twelve triangles."""
    return Mesh(_CORNERS * size @ (np.eye(3) if axes is None else axes) + center, FACES)


def cylinder(radius: float, height: float, sides: int = 24, turn: float = 0.1) -> Mesh:
    """An upright prism around the origin."""
    angles = turn + 2 * np.pi * np.arange(sides) / sides
    ring = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    vertices = np.concatenate([np.column_stack([ring, np.full(sides, z)]) for z in (0.0, height)])
    around, after = np.arange(sides), (np.arange(sides) + 1) % sides
    walls = [np.stack(face, 1) for face in ((around, after, after + sides), (around, after + sides, around + sides))]
    lids = [np.stack([np.zeros(sides, int), after, around], 1), np.stack([around, after, 0 * after], 1) + sides]
    return Mesh(vertices, np.concatenate([*walls, *lids]))


def meshes() -> dict[str, Mesh]:
    """The parts of the shelf."""
    return {name: box(*where) for name, where in SHELF.items()}


def obj(parts: dict[str, Mesh], word: str = "g") -> str:
    """An OBJ file with a group for each part."""
    lines, start = [], 1
    for name, mesh in parts.items():
        lines.append(f"{word} {name}")
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
        lines += [f"f {a}//1 {b}//1 {c}//1" for a, b, c in (mesh.faces + start).tolist()]
        start += len(mesh.vertices)
    return "\n".join(lines) + "\n"


def stl(mesh: Mesh) -> bytes:
    """A binary STL file."""
    head = b"made by a test".ljust(80, b"\0") + struct.pack("<I", len(mesh.faces))
    corners = mesh.vertices[mesh.faces].astype("<f4")
    return head + b"".join(bytes(12) + triangle.tobytes() + b"\0\0" for triangle in corners)


def text_stl(name: str, mesh: Mesh) -> str:
    """An STL file as text."""
    facets = (
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x} {y} {z}\n" for x, y, z in triangle)
        + "endloop\nendfacet\n"
        for triangle in mesh.vertices[mesh.faces].tolist()
    )
    return f"solid {name}\n{''.join(facets)}endsolid {name}\n"


def gltf(parts: dict[str, Mesh], embed: bool = True) -> tuple[dict[str, object], bytes]:
    """A glTF document in metres, Y up, and its buffer; each node is placed where its part is."""
    document: dict[str, list[dict[str, object]]] = {"nodes": [], "meshes": [], "accessors": [], "bufferViews": []}
    data = b""
    for index, (name, mesh) in enumerate(parts.items()):
        middle = mesh.vertices.mean(0)
        vertices = ((mesh.vertices - middle) @ TO_Y_UP.T / 1000).astype("<f4")
        for values, kind, shape in ((vertices, 5126, "VEC3"), (mesh.faces.astype("<u2").reshape(-1), 5123, "SCALAR")):
            view = len(document["bufferViews"])
            document["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes})
            document["accessors"].append(
                {"bufferView": view, "componentType": kind, "count": len(values), "type": shape}
            )
            data += values.tobytes()
        primitive = {"attributes": {"POSITION": 2 * index}, "indices": 2 * index + 1}
        document["meshes"].append({"primitives": [primitive]})
        place = (TO_Y_UP @ middle / 1000).tolist()
        document["nodes"].append({"name": name, "mesh": index, "translation": place})
    buffer: dict[str, object] = {"byteLength": len(data)}
    if embed:
        buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    scenes = [{"nodes": list(range(len(parts)))}]
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": scenes, "buffers": [buffer], **document}, data


def glb(document: dict[str, object], data: bytes) -> bytes:
    """A GLB file."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def model_xml(parts: dict[str, Mesh], unit: str = "millimeter", more: str = "", build: str | None = None) -> str:
    """The model of a 3MF file: an object and a build item for each part."""
    objects = ""
    for index, (name, mesh) in enumerate(parts.items(), 1):
        vertices = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in mesh.vertices.tolist())
        faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in mesh.faces.tolist())
        inner = f"<mesh><vertices>{vertices}</vertices><triangles>{faces}</triangles></mesh>"
        objects += f'<object id="{index}" name="{name}" type="model">{inner}</object>'
    items = "".join(f'<item objectid="{index}"/>' for index in range(1, len(parts) + 1)) if build is None else build
    return (
        f'<?xml version="1.0"?><model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" unit="{unit}">'
        f"<resources>{objects}{more}</resources><build>{items}</build></model>"
    )


def threemf(file: Path, xml: str | bytes, **others: str) -> Path:
    """A 3MF file with that model."""
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", xml)
        for name, content in others.items():
            archive.writestr(f"3D/{name}.model", content)
    return file


def urdf(parts: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = SHELF) -> str:
    """A URDF file in metres: a link for each part, all hung on the first by fixed joints."""
    first, *rest = parts
    text = ""
    for name, (_, size) in parts.items():
        sides = " ".join(str(side / 1000) for side in size)
        text += f'<link name="{name}"><visual><geometry><box size="{sides}"/></geometry></visual></link>'
    for name in rest:
        way = " ".join(str((a - b) / 1000) for a, b in zip(parts[name][0], parts[first][0], strict=True))
        ends = f'<parent link="{first}"/><child link="{name}"/>'
        text += f'<joint name="to {name}" type="fixed"><origin xyz="{way}"/>{ends}</joint>'
    return f'<robot name="shelf">{text}</robot>'


def mjcf(parts: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = SHELF) -> str:
    """An MJCF file in metres: a body for each part, each with one box."""
    text = ""
    for name, (center, size) in parts.items():
        place = " ".join(str(value / 1000) for value in center)
        half = " ".join(str(side / 2000) for side in size)
        text += f'<body name="{name}" pos="{place}"><freejoint/><geom type="box" size="{half}"/></body>'
    return f'<mujoco><worldbody><geom type="plane" size="9 9 1"/>{text}</worldbody></mujoco>'
