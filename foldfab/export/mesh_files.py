"""Binary STL, one file a body."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from foldfab.export.shell import Shell

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""One triangle of a binary STL, 50 bytes."""
LONGEST_STEM = 80
"""Characters; file systems stop at 255 bytes and people stop reading well before."""
DEVICE_NAMES = frozenset({"con", "prn", "aux", "nul", *(f"{d}{i}" for d in ("com", "lpt") for i in range(1, 10))})
"""What Windows refuses as a file's stem."""


def stl_bytes(shell: Shell) -> bytes:
    """The shell as a binary STL, millimetres."""
    corners = shell.vertices[shell.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    records = np.zeros(len(corners), dtype=RECORD)
    records["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0) + 0.0
    records["corners"] = corners
    return b"foldfab".ljust(80) + np.uint32(len(corners)).tobytes() + records.tobytes()


def file_stems(names: Iterable[str]) -> dict[str, str]:
    """By body name, a file name without its ending: plain ASCII, and unique even where case does not count."""
    stems: dict[str, str] = {}
    taken: set[str] = set()
    for name in sorted(names):
        stem, number = _plain(name), 1
        while (candidate := stem if number == 1 else f"{stem}-{number}").lower() in taken:
            number += 1
        taken.add(candidate.lower())
        stems[name] = candidate
    return stems


def _plain(name: str) -> str:
    stem = re.sub(r"[^A-Za-z0-9_.]+", "-", name)[:LONGEST_STEM].strip("-.")
    return f"part-{stem}" if stem.lower() in DEVICE_NAMES else stem or "part"
