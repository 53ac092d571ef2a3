"""How long files of shapes take to be read and understood, and how much memory; a report for people, never a test.

python benchmarks/intake_benchmark.py [--triangles 200000 2000000] [--formats obj glb 3mf stl step]

A rack of 40 parts, no two of them boxes: round posts, and boards that swell to the middle, with about so many
triangles together. It is written in each format, and `foldfab recipe` reads it in a process of its own.

seconds   of the clock, from start to end, imports and all
CPU       seconds that the processor worked for it, which other work on the machine changes less
peak      most resident memory of that process or of one that it started, MB

STEP has faces and no triangles: it is the same rack with true cylinders and rounded edges, at whatever fineness.
"""

from __future__ import annotations

import argparse
import json
import resource
import struct
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
from measuring import Column, Table
from numpy.typing import NDArray
from print_benchmark import KILOBYTE

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]
"""Vertices (n, 3), mm, and faces (m, 3)."""

READING = """
import resource, sys
from foldfab.cli import main
status = main(["recipe", "-q", "--units", "mm", "--up", "z", sys.argv[1]])
lines = [line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM")]
print(*lines, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=sys.stderr)
sys.exit(status)
"""
"""`ru_maxrss` of a process counts what it was forked from as well; so Linux is asked for what it took itself."""
COLUMNS, SHELVES, BOARDS = 4, 8, 4
"""Eight posts in two rows of four, and eight shelves of four boards: 40 parts."""
TABLE = Table(
    (
        Column("format", 6), Column("triangles", 9), Column("file MB", 7, ".1f"), Column("parts", 5),
        Column("seconds", 7, ".2f"), Column("CPU", 7, ".2f"), Column("peak MB", 7, ".0f"),
    )
)  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--triangles", nargs="+", type=int, default=[200_000, 2_000_000], metavar="N")
    parser.add_argument("--formats", nargs="+", choices=WRITERS, default=list(WRITERS), metavar="F")
    arguments = parser.parse_args()
    TABLE.head()
    with tempfile.TemporaryDirectory() as folder:
        for count, name in product(arguments.triangles, arguments.formats):
            rack = parts(count)
            path = WRITERS[name](Path(folder), rack)
            size = sum(f.stat().st_size for f in (path.iterdir() if path.is_dir() else [path])) / 1e6
            triangles = None if name == "step" else sum(len(faces) for _, faces in rack.values())
            TABLE.row(name, triangles, size, *read(path))
    return 0


def read(path: Path) -> tuple[int | None, float, float, float]:
    """How many parts the file is understood as, seconds of the clock and of the processor, and peak memory, MB."""
    before, start = worked(), time.perf_counter()
    child = subprocess.run([sys.executable, "-c", READING, str(path)], capture_output=True, text=True, encoding="utf-8")
    seconds = time.perf_counter() - start
    found = len(json.loads(child.stdout)["parts"]) if child.returncode == 0 else None
    return found, seconds, worked() - before, max(map(int, child.stderr.split())) * KILOBYTE / 1e6


def worked() -> float:
    """Seconds that the processor worked for processes that this one started and that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def places() -> dict[str, tuple[tuple[float, ...], tuple[float, ...], bool]]:
    """Middle, size, and whether it is round, of each part, mm."""
    posts = {
        f"post {x}{y}": ((400.0 * x, 400.0 * y, 800.0), (40.0, 40.0, 1600.0), True)
        for x in range(COLUMNS) for y in range(2)
    }  # fmt: skip
    boards = {
        f"board {z}{y}": ((600.0, 80.0 + 80 * y, 50.0 + 200 * z), (1160.0, 80.0, 24.0), False)
        for z in range(SHELVES) for y in range(BOARDS)
    }  # fmt: skip
    return posts | boards


def parts(triangles: int) -> dict[str, Mesh]:
    """The rack as meshes with about so many triangles together."""
    where = places()
    steps = max(2, round((triangles / len(where) / 12) ** 0.5))
    return {name: swollen(center, size, is_round, steps) for name, (center, size, is_round) in where.items()}


def swollen(center: tuple[float, ...], size: tuple[float, ...], is_round: bool, steps: int) -> Mesh:
    """A box with each side in steps², its corners pulled in: all around where it is round, else a little."""
    line = np.linspace(-1, 1, steps + 1)
    u, v = (grid.reshape(-1) for grid in np.meshgrid(line, line, indexing="ij"))
    first = (np.arange(steps)[:, None] * (steps + 1) + np.arange(steps)).reshape(-1)
    quads = np.stack([first, first + steps + 1, first + steps + 2, first + 1], 1)
    side = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    sides = [
        np.insert(np.stack([u, sign * v], 1), axis, sign, axis=1) for axis in range(3) for sign in (-1.0, 1.0)
    ]  # fmt: skip
    faces = np.concatenate([side + k * len(u) for k in range(6)])
    points = np.concatenate(sides)
    if is_round:
        x, y = points[:, 0], points[:, 1]
        points = np.stack([x * np.sqrt(1 - y**2 / 2), y * np.sqrt(1 - x**2 / 2), points[:, 2]], 1)
    else:
        points = points * (1 - 0.04 * (points**2).sum(1, keepdims=True) / 3)
    return points * np.array(size) / 2 + center, faces


def write_obj(folder: Path, rack: dict[str, Mesh]) -> Path:
    path, start = folder / "rack.obj", 1
    with path.open("w", encoding="utf-8") as file:
        for name, (vertices, faces) in rack.items():
            file.write(f"o {name}\n")
            np.savetxt(file, vertices, fmt="v %.6f %.6f %.6f")
            np.savetxt(file, faces + start, fmt="f %d %d %d")
            start += len(vertices)
    return path


def write_glb(folder: Path, rack: dict[str, Mesh]) -> Path:
    views, accessors, data = [], [], bytearray()
    for vertices, faces in rack.values():
        for values, kind, shape in ((vertices.astype("<f4"), 5126, "VEC3"), (faces.astype("<u4"), 5125, "SCALAR")):
            accessors.append({"bufferView": len(views), "componentType": kind, "count": 0, "type": shape})
            accessors[-1]["count"] = len(values) if shape == "VEC3" else values.size
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes})
            data += values.tobytes()
    meshes = [
        {"primitives": [{"attributes": {"POSITION": 2 * k}, "indices": 2 * k + 1}]} for k in range(len(rack))
    ]  # fmt: skip
    nodes = [{"name": name, "mesh": k} for k, name in enumerate(rack)]
    text = json.dumps(
        {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(rack)))}], "nodes": nodes,
            "meshes": meshes, "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(data)}],
        }
    ).encode()  # fmt: skip
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) + struct.pack("<II", len(text), 0x4E4F534A)
    (folder / "rack.glb").write_bytes(head + text + struct.pack("<II", len(data), 0x004E4942) + bytes(data))
    return folder / "rack.glb"


def write_threemf(folder: Path, rack: dict[str, Mesh]) -> Path:
    path = folder / "rack.3mf"
    model = "3D/3dmodel.model"
    name_space = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    items = "".join(f'<item objectid="{key}"/>' for key in range(1, len(rack) + 1))
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open(model, "w", force_zip64=True) as file,
    ):
        file.write(f'<model xmlns="{name_space}" unit="millimeter"><resources>'.encode())
        for key, (name, (vertices, faces)) in enumerate(rack.items(), 1):
            file.write(f'<object id="{key}" name="{name}" type="model"><mesh><vertices>'.encode())
            np.savetxt(file, vertices, fmt='<vertex x="%.6f" y="%.6f" z="%.6f"/>')
            file.write(b"</vertices><triangles>")
            np.savetxt(file, faces, fmt='<triangle v1="%d" v2="%d" v3="%d"/>')
            file.write(b"</triangles></mesh></object>")
        file.write(f"</resources><build>{items}</build></model>".encode())
    return path


def write_stl(folder: Path, rack: dict[str, Mesh]) -> Path:
    (folder / "rack").mkdir(exist_ok=True)
    facet = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    for name, (vertices, faces) in rack.items():
        facets = np.zeros(len(faces), facet)
        facets["corners"] = vertices[faces]
        head = b"a rack".ljust(80, b"\0") + struct.pack("<I", len(faces))
        (folder / "rack" / f"{name}.stl").write_bytes(head + facets.tobytes())
    return folder / "rack"


def write_step(folder: Path, rack: dict[str, Mesh]) -> Path:
    import build123d as b3d

    solids = []
    for name, (center, size, is_round) in places().items():
        solid = b3d.Solid.make_cylinder(size[0] / 2, size[2]) if is_round else b3d.Solid.make_box(*size)
        solid = solid.fillet(5, solid.edges())
        corner = np.array(center) - [0 if is_round else size[0] / 2, 0 if is_round else size[1] / 2, size[2] / 2]
        solid = solid.moved(b3d.Location(tuple(corner.tolist())))
        solid.label = name
        solids.append(solid)
    b3d.export_step(b3d.Compound(label="rack", children=solids), folder / "rack.step")
    return folder / "rack.step"


WRITERS: dict[str, Callable[[Path, dict[str, Mesh]], Path]] = {
    "obj": write_obj, "glb": write_glb, "3mf": write_threemf, "stl": write_stl, "step": write_step,
}  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
