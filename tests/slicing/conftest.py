"""Boxes as STL, with and without faults, and programs that stand in for PrusaSlicer."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from manifold3d import Manifold

from foldfab.geometry.arrays import Array

Boxes = tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...]


@pytest.fixture(scope="session")
def prusa() -> str:
    """PrusaSlicer, where it is installed."""
    found = shutil.which("prusa-slicer")
    if found is None:
        pytest.skip("PrusaSlicer is not installed")
    return found


@pytest.fixture
def box_stl(tmp_path: Path) -> Callable[..., Path]:
    """Writes boxes, each a least corner and a size, as one STL; `drop` leaves out the first triangles."""

    def write(boxes: Boxes, drop: int = 0, flip: bool = False) -> Path:
        corners = np.concatenate([_box(corner, size) for corner, size in boxes])[drop:]
        file = tmp_path / "boxes.stl"
        file.write_bytes(stl(corners[:, ::-1] if flip else corners))
        return file

    return write


@pytest.fixture
def program(tmp_path: Path) -> Callable[[str], str]:
    """Makes an executable of a shell script, and returns its path."""

    def make(script: str) -> str:
        file = tmp_path / "slicer"
        file.write_text(f"#!/bin/sh\n{script}\n")
        file.chmod(0o755)
        return str(file)

    return make


def stl(corners: Array) -> bytes:
    """(m, 3, 3) triangles as a binary STL."""
    record = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    record["corners"] = corners
    return b"boxes".ljust(80) + np.uint32(len(corners)).tobytes() + record.tobytes()


def _box(corner: tuple[float, float, float], size: tuple[float, float, float]) -> Array:
    mesh = Manifold.cube(size).translate(corner).to_mesh()
    triangles: Array = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3][np.asarray(mesh.tri_verts)]
    return triangles
