"""STEP files, by build123d in a process of its own: what its native reader makes of garbage is an error message."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from foldfab.errors import MissingLibraryError
from foldfab.intake.limits import LONGEST_SECONDS, content, fail
from foldfab.intake.meshes import body
from foldfab.intake.model import Shapes
from foldfab.intake.step_process import MISSING, REFUSED

_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""Threads of numpy's libraries take memory of their own, and do nothing here."""
_PACKAGES = Path(__file__).resolve().parents[2]


def read(path: Path) -> Shapes:
    """The solids of a STEP file in millimetres (which it is converted to), Z up.

    Raises:
        RecipeError: it is no STEP file, is damaged, holds no solids, or takes too long or too much memory.
        MissingLibraryError: build123d, or a system library that it needs, is absent.
    """
    head = content(path)[:4096]
    if b"ISO-10303-21" not in head:
        fail(path, "is no STEP file: it does not begin with ISO-10303-21")
    command = [sys.executable, "-m", "foldfab.intake.step_process", str(path.absolute())]
    paths = os.pathsep.join([str(_PACKAGES), *filter(None, [os.environ.get("PYTHONPATH")])])
    try:
        run = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=LONGEST_SECONDS, check=False,
            env=os.environ | {"PYTHONPATH": paths} | _ONE_THREAD,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        fail(path, f"takes longer than {LONGEST_SECONDS:.0f} s to read; export only the furniture, or a coarser mesh")
    arrays = {} if run.returncode else _unpacked(run.stdout)
    if MISSING in arrays:
        raise MissingLibraryError(str(arrays[MISSING]))
    if REFUSED in arrays:
        fail(path, str(arrays[REFUSED]))
    if "names" not in arrays:
        fail(path, "the STEP reader broke down over it; the file is damaged, export it again")
    return _shapes(path, arrays)


def _unpacked(data: bytes) -> dict[str, Any]:
    """What the process wrote; nothing where it did not come to that."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
            return dict(arrays)
    except (ValueError, EOFError, OSError, zipfile.BadZipFile):
        return {}


def _shapes(path: Path, arrays: dict[str, Any]) -> Shapes:
    names = [str(name) for name in arrays["names"]]
    meshes = [(arrays[f"v{i}"], arrays[f"f{i}"]) for i in range(len(names))]
    found = (body(path, name, vertices, faces) for name, (vertices, faces) in zip(names, meshes, strict=True))
    return Shapes(tuple(found), millimetres=1.0)
