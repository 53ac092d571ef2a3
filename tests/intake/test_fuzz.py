"""Good files with random damage are read or refused, and nothing else."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from foldfab.errors import RecipeError
from foldfab.intake.door import load
from foldfab.intake.model import Wishes

from .furniture import glb, gltf, meshes, mjcf, model_xml, obj, stl, text_stl, threemf, urdf

ROUNDS = 120
NUMBERS = (b"9" * 12, b"-", b"e99", b"nan", b"0")


def good(folder: Path, ending: str) -> bytes:
    """A file of the shelf."""
    if ending == ".3mf":
        return threemf(folder / "good.3mf", model_xml(meshes())).read_bytes()
    document, data = gltf(meshes(), embed=ending == ".gltf")
    some = next(iter(meshes().values()))
    return {
        ".glb": glb(document, data),
        ".gltf": json.dumps(document).encode(),
        ".obj": obj(meshes()).encode(),
        ".stl": stl(some),
        ".STL": text_stl("a", some).encode(),
        ".urdf": urdf().encode(),
        ".mjcf": mjcf().encode(),
    }[ending]


def damaged(content: bytes, chance: random.Random) -> bytes:
    """Cut off, with some bytes changed, with a piece moved, or with other numbers."""
    kind, found = chance.randrange(4), bytearray(content)
    if kind == 0:
        return content[: chance.randrange(len(content))]
    if kind == 2:
        at, source = chance.randrange(len(found)), chance.randrange(len(found))
        found[at : at + 50] = found[source : source + chance.randrange(200)]
    for _ in range(chance.randrange(1, 20)):
        at = chance.randrange(len(found))
        if kind == 1:
            found[at] = chance.randrange(256)
        if kind == 3 and chr(found[at]).isdigit():
            found[at : at + 1] = chance.choice(NUMBERS)
    return bytes(found)


@pytest.mark.parametrize("ending", [".glb", ".gltf", ".obj", ".stl", ".STL", ".3mf", ".urdf", ".mjcf"])
def test_damage_is_refused_or_harmless(tmp_path: Path, ending: str) -> None:
    content, chance = good(tmp_path, ending), random.Random(7)
    file = tmp_path / f"a{ending}"
    refused = 0
    for _ in range(ROUNDS):
        file.write_bytes(damaged(content, chance))
        try:
            load(file, Wishes())
        except RecipeError as error:
            refused += len(error.problems)
    assert 0 < refused < ROUNDS
