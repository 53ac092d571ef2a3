"""Loose parts: an object each, flat on the bed, a file a plate; and the check that sees where they are not."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from foldfab.export.bed import on_plates
from foldfab.export.check import inspect_folder
from foldfab.export.read_files import read_threemf
from foldfab.export.threemf import threemf_bytes
from foldfab.export.write import write
from foldfab.fabrication.model import Assembly


@pytest.fixture
def loose(make: Callable[..., Assembly]) -> Assembly:
    return make(posture="plate")


@pytest.fixture
def folder(loose: Assembly, tmp_path: Path) -> Path:
    write(loose, tmp_path / "stool")
    return tmp_path / "stool"


def test_every_part_lies_on_the_bed_under_its_own_name(loose: Assembly, folder: Path) -> None:
    made = read_threemf(folder / "stool-1.3mf", is_loose=True)
    assert sorted(name for name, _, _ in made.volumes) == [body.name for body in loose.bodies]
    assert made.warnings == 0
    assert made.is_sound
    for _, first, last in made.volumes:
        assert made.vertices[np.unique(made.faces[first : last + 1])][:, 2].min() == 0.0


def test_the_sheet_names_its_files_and_the_check_holds(folder: Path) -> None:
    assert json.loads((folder / "sheet.json").read_text())["print_files"] == ["stool-1.3mf"]
    assert _row(folder, "3mf")


def test_a_part_in_the_air_is_noticed(loose: Assembly, folder: Path) -> None:
    (shells,) = on_plates(loose)
    raised = (replace(shells[0], vertices=np.add(shells[0].vertices, [0, 0, 1])), *shells[1:])
    (folder / "stool-1.3mf").write_bytes(threemf_bytes("stool-1", raised, is_loose=True))
    assert not _row(folder, "3mf")


def test_parts_that_lie_on_each_other_are_noticed(loose: Assembly, folder: Path) -> None:
    (shells,) = on_plates(loose)
    middle = [shell.vertices - [*shell.vertices.mean(axis=0)[:2], 0] for shell in shells]
    heaped = tuple(replace(s, vertices=np.round(v, 3)) for s, v in zip(shells, middle, strict=True))
    (folder / "stool-1.3mf").write_bytes(threemf_bytes("stool-1", heaped, is_loose=True))
    assert not _row(folder, "gap")


def test_loose_parts_are_refused_where_one_mesh_is_promised(folder: Path) -> None:
    with pytest.raises(ValueError, match="take it apart"):
        read_threemf(folder / "stool-1.3mf")


def _row(folder: Path, code: str) -> bool:
    return next(row.ok for row in inspect_folder(folder).rows if row.code == code)
