"""What a file has left far from its furniture is left out, where it is clear what the furniture is."""

from __future__ import annotations

from pathlib import Path

import pytest

import foldfab
from foldfab.errors import AbstractionError
from foldfab.intake.door import load
from foldfab.intake.model import Wishes
from foldfab.recipe.model import Mesh, Recipe

from .furniture import box, meshes, obj

FAR = box((0, 0, 3000), (700, 300, 18))


def read(folder: Path, bodies: dict[str, Mesh], **wishes: object) -> Recipe:
    (folder / "a.obj").write_text(obj(bodies), encoding="utf-8")
    return load(folder / "a.obj", Wishes(units="mm", **wishes))  # type: ignore[arg-type]


def test_a_part_far_from_the_rest_is_left_out_and_said(tmp_path: Path) -> None:
    whole = read(tmp_path, meshes())
    found = read(tmp_path, {**meshes(), "lid": FAR})
    assert {part.name for part in found.parts} == {part.name for part in whole.parts}
    (note,) = [note for note in found.notes if "LEFT OUT" in note]
    assert "lid (" in note and " mm from " in note
    assert not any("LEFT OUT" in note for note in whole.notes)


def test_parts_that_are_loose_together_are_told_together(tmp_path: Path) -> None:
    beside = {f"shelf{i}": box((400, 0, 100 + 18 * i), (700, 300, 18)) for i in range(6)}
    found = read(tmp_path, {**beside, "lid": FAR, "knob": box((0, 0, 3060), (400, 100, 102))})
    assert {part.name for part in found.parts} == set(beside)
    assert any("lid, knob (" in note for note in found.notes)


def test_where_no_heap_is_the_furniture_nothing_is_left_out(tmp_path: Path) -> None:
    two = {"one": box((0, 0, 0), (700, 300, 18)), "two": box((0, 0, 900), (700, 300, 18))}
    with pytest.raises(AbstractionError, match="does not touch the rest"):
        foldfab.foldabilize(read(tmp_path, two))


def test_what_is_left_out_is_forgotten_by_its_neighbours(tmp_path: Path) -> None:
    """Hardware that held two loose parts together says nothing of the furniture."""
    pair = {"lid": FAR, "knob": box((0, 0, 3200), (700, 100, 18)), "screw": box((0, 0, 3100), (4, 4, 190))}
    found = read(tmp_path, {**{f"b{i}": box((0, 0, 18 * i), (700, 300, 18)) for i in range(6)}, **pair}, smallest=200.0)
    assert {part.name for part in found.parts} == {f"b{i}" for i in range(6)}
    assert found.touching == () and not any("hardware that" in note for note in found.notes)
