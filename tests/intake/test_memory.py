"""How much memory reading takes: a file of furniture that is as large as any may be stays within 1 GB."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from foldfab.intake.limits import LARGEST_DATA, MOST_TRIANGLES, MOST_VERTICES
from foldfab.recipe.model import Mesh

from .furniture import glb, model_xml, obj, stl, threemf

BOUND = 1e9
"""Bytes."""
MANY = 200_000
"""Triangles of which each has corners of its own, as no mesh takes more memory."""
STATUS = Path("/proc/self/status")
"""Where Linux tells what a process took; `ru_maxrss` counts what it was forked from as well."""
READING = """
import sys
from foldfab.intake.door import load
from foldfab.intake.model import Wishes
load(sys.argv[1], Wishes(units="mm", up="z", smallest=0))
print(next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM")))
"""


def soup(count: int) -> Mesh:
    rng = np.random.default_rng(count)
    corners = rng.uniform(-500, 500, (count, 1, 3)) + rng.uniform(-1, 1, (count, 3, 3))
    return Mesh(np.round(corners.reshape(-1, 3), 3), np.arange(3 * count).reshape(-1, 3))


def written(folder: Path, kind: str, mesh: Mesh) -> Path:
    file = folder / f"many.{kind}"
    if kind == "obj":
        file.write_text(obj({"a": mesh}), encoding="utf-8")
    elif kind == "3mf":
        threemf(file, model_xml({"a": mesh}))
    elif kind == "glb":
        file.write_bytes(glb(*binary(mesh)))
    else:
        file.write_bytes(stl(mesh))
    return file


def binary(mesh: Mesh) -> tuple[dict[str, object], bytes]:
    vertices, faces = mesh.vertices.astype("<f4").tobytes(), mesh.faces.astype("<u4").tobytes()
    views = [
        {"buffer": 0, "byteOffset": 0, "byteLength": len(vertices)},
        {"buffer": 0, "byteOffset": len(vertices), "byteLength": len(faces)},
    ]
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": len(mesh.vertices), "type": "VEC3"},
        {"bufferView": 1, "componentType": 5125, "count": mesh.faces.size, "type": "SCALAR"},
    ]
    document: dict[str, object] = {
        "asset": {"version": "2.0"}, "nodes": [{"name": "a", "mesh": 0}], "bufferViews": views,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "accessors": accessors,
        "buffers": [{"byteLength": len(vertices) + len(faces)}],
    }  # fmt: skip
    return document, vertices + faces


def peak(file: Path) -> int:
    """Of a process that reads the file, bytes."""
    if not STATUS.exists():
        pytest.skip("the system does not tell how much memory a process takes")
    run = subprocess.run(
        [sys.executable, "-c", READING, str(file)], capture_output=True, text=True, encoding="utf-8", check=True
    )
    return 1024 * int(run.stdout)


@pytest.mark.parametrize("kind", ["obj", "3mf", "glb", "stl"])
def test_a_file_at_the_limits_is_read_within_the_bound(tmp_path: Path, kind: str) -> None:
    least = peak(written(tmp_path, kind, soup(100)))
    most = peak(written(tmp_path, kind, soup(MANY)))
    for_one = (most - least) / MANY
    assert MOST_VERTICES == 3 * MOST_TRIANGLES
    assert least + for_one * MOST_TRIANGLES < BOUND


def test_the_reader_of_step_files_gets_no_more(tmp_path: Path) -> None:
    pytest.importorskip("resource", reason="the system does not limit processes")
    code = "from foldfab.intake.step_process import _limit; _limit(); bytearray({})"
    for size, fits in ((LARGEST_DATA // 2, True), (LARGEST_DATA, False)):
        run = subprocess.run(
            [sys.executable, "-c", code.format(size)], capture_output=True, text=True, encoding="utf-8", check=False
        )
        assert (run.returncode == 0) == fits
        assert fits or "MemoryError" in run.stderr
