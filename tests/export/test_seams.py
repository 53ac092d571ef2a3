"""Parts that were cut: their pieces in the sheet, the print files and the fold; seams that do not hold are seen."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foldfab.export.check import inspect_folder
from foldfab.export.check_motion import FRAMES
from foldfab.export.read_files import read_threemf
from foldfab.export.read_glb import pose, read_glb
from foldfab.export.write import write
from foldfab.fabrication.build import build
from foldfab.folding.solve import solve
from foldfab.recipe.model import FoldOptions, Part, Printer, PrintOptions, Recipe
from foldfab.scaffold.abstract import abstract

DOWN = np.array([0.0, 0.0, -1.0])
PARTS = (
    Part("ground", np.array([0, 0, 0]), np.array([60, 140, 4]), np.eye(3)),
    Part("wall", np.array([0, 0, 42]), np.array([4, 130, 80]), np.eye(3)),
)


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("prints") / "shelter"
    printing = PrintOptions(printer=Printer("small", (100.0, 90.0, 90.0)), scale=1.0, posture="plate", hinge="filament")
    recipe = Recipe("shelter", DOWN, PARTS, FoldOptions(), printing)
    write(build(solve(abstract(recipe, DOWN, 1.0)), "plate"), folder)
    return folder


@pytest.fixture
def folder(original: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(original, tmp_path / "shelter"))


def sheet(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "sheet.json").read_text())
    return found


def test_the_sheet_tells_the_pieces_and_what_joins_them(folder: Path) -> None:
    facts = sheet(folder)
    assert facts["pieces"] == {"ground": ["ground:1", "ground:2"], "wall": ["wall:1", "wall:2"]}
    assert [part["name"] for part in facts["parts"]] == ["ground:1", "ground:2", "wall:1", "wall:2"]
    seams = {joint["name"]: joint["seam"] for joint in facts["joints"] if "seam" in joint}
    assert len(seams) == 2
    assert {seam["kind"] for seam in seams.values()} == {"dovetail"}
    assert {seam["fit_mm"] for seam in seams.values()} == {0.15}
    assert facts["components"] == 1


def test_every_piece_is_on_a_plate_and_all_checks_hold(folder: Path) -> None:
    report = inspect_folder(folder)
    assert report.ok, [row for row in report.rows if not row.ok]
    assert "seams" in [row.code for row in report.rows]
    plates = [read_threemf(folder / name, is_loose=True) for name in sheet(folder)["print_files"]]
    assert sorted(name for one in plates for name, _, _ in one.volumes) == ["ground:1", "ground:2", "wall:1", "wall:2"]


def test_pieces_never_move_against_each_other_in_the_animation(folder: Path) -> None:
    fold = read_glb(folder / "shelter.glb")
    poses = [np.array([pose(fold, name, k / FRAMES) for k in range(FRAMES + 1)]) for name in ("wall:1", "wall:2")]
    relative = np.linalg.inv(poses[0]) @ poses[1]
    assert np.abs(relative - relative[0]).max() < 1e-3


LIES: dict[str, Callable[[dict[str, Any]], None]] = {
    "a fit": lambda seam: seam.update(fit_mm=0.3),
    "a pull through the plate": lambda seam: seam.update(pull=[1.0, 0.0, 0.0]),
    "no unit vector": lambda seam: seam.update(pull=[1.0, 1.0, 0.0]),
}


@pytest.mark.parametrize("change", LIES.values(), ids=LIES.keys())
def test_a_seam_that_is_not_as_told_is_caught(folder: Path, change: Callable[[dict[str, Any]], None]) -> None:
    facts = sheet(folder)
    change(next(joint["seam"] for joint in facts["joints"] if "seam" in joint and "wall" in joint["name"]))
    (folder / "sheet.json").write_text(json.dumps(facts))
    failing = {row.code for row in inspect_folder(folder).rows if not row.ok}
    assert failing & {"seams", "sheet"}
