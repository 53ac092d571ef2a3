"""Every check holds for a good print folder, and each can fail."""

import json
import shutil
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from foldfab.errors import PrintFolderError
from foldfab.export.check import inspect_folder

CODES = ["files", "stl", "3mf", "gap", "printable", "motion", "rigid", "collide", "joints", "connected", "flat", "cost"]


def failing(folder: Path) -> set[str]:
    return {row.code for row in inspect_folder(folder).rows if not row.ok}


def edit_sheet(folder: Path, change: Callable[[dict[str, Any]], Any]) -> None:
    path = folder / "sheet.json"
    sheet = json.loads(path.read_text())
    change(sheet)
    path.write_text(json.dumps(sheet))


def edit_glb(folder: Path, change: Callable[[dict[str, Any]], Any]) -> None:
    path = folder / "stool.glb"
    blob = path.read_bytes()
    size = struct.unpack_from("<I", blob, 12)[0]
    document = json.loads(blob[20 : 20 + size])
    change(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = blob[20 + size :]
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON")
    path.write_bytes(head + text + rest)


def test_a_good_folder_passes_every_check(written: Path) -> None:
    report = inspect_folder(written)
    assert report.ok and [row.code for row in report.rows] == CODES


@pytest.mark.parametrize("name", ["stool.3mf", "stool.glb", "stl/flap.stl", "recipe.json", "preview.png"])
@pytest.mark.parametrize("how", ["missing", "empty", "cut", "noise"])
def test_a_damaged_file_fails_in_words(written: Path, name: str, how: str) -> None:
    path = written / name
    data = path.read_bytes()
    path.unlink()
    if how != "missing":
        path.write_bytes({"empty": b"", "cut": data[: len(data) // 2], "noise": b"\x07" * len(data)}[how])
    report = inspect_folder(written)
    assert not report.ok
    assert all(row.text and "Traceback" not in row.text for row in report.rows)


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "\xff", "[" * 100_000])
def test_a_sheet_that_cannot_be_read_is_one_error(written: Path, text: str) -> None:
    (written / "sheet.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(PrintFolderError, match=r"sheet\.json"):
        inspect_folder(written)


def test_no_folder_is_one_error(tmp_path: Path) -> None:
    with pytest.raises(PrintFolderError, match="is this a print folder"):
        inspect_folder(tmp_path / "nowhere")


SHEETS: dict[str, Callable[[dict[str, Any]], Any]] = {
    "no parts": lambda sheet: sheet.pop("parts"),
    "parts are a number": lambda sheet: sheet.update(parts=3),
    "direction is short": lambda sheet: sheet.update(direction=[0, 0, -2]),
    "cost is a text": lambda sheet: sheet.update(cost="much"),
    "cost is NaN": lambda sheet: sheet.update(cost=float("nan")),
    "a joint of strangers": lambda sheet: sheet["joints"][0].update(parts=["floor", "ghost"]),
    "an axis of one point": lambda sheet: sheet["joints"][0].update(axis=[[0, 0, 0]]),
    "printer is a text": lambda sheet: sheet.update(printer="big"),
}


@pytest.mark.parametrize("change", SHEETS.values(), ids=SHEETS.keys())
def test_a_malformed_sheet_is_one_row(written: Path, change: Callable[[dict[str, Any]], Any]) -> None:
    edit_sheet(written, change)
    assert failing(written) == {"sheet"}


LIES: dict[str, tuple[Callable[[dict[str, Any]], Any], set[str]]] = {
    "volume": (lambda sheet: sheet["parts"][0].update(volume_mm3=1.0), {"stl", "motion"}),
    "name": (lambda sheet: sheet["parts"][1].update(name="ground"), {"sheet"}),
    "bed": (lambda sheet: sheet["printer"].update(build_volume_mm=[60, 60, 60]), {"3mf"}),
    "clearance": (lambda sheet: sheet.update(clearance_mm=0.5), {"gap"}),
    "axis": (lambda sheet: sheet["joints"][0].update(axis=[[0, 0, 40], [0, 9, 40]]), {"joints"}),
    "range": (lambda sheet: sheet["joints"][1].update(range_deg=[0, 90]), {"joints"}),
    "components": (lambda sheet: sheet.update(components=2), {"connected"}),
    "joints": (lambda sheet: sheet["joints"].pop(0), {"connected"}),
    "saving": (lambda sheet: sheet.update(space_saving=0.9), {"flat"}),
    "normal": (lambda sheet: sheet["parts"][0].update(normal=[0, 0, 1]), {"flat"}),
    "kind": (lambda sheet: sheet["parts"][0].update(kind="base"), {"flat"}),
    "cost": (lambda sheet: sheet.update(cost=0.2), {"cost"}),
    "bound": (lambda sheet: sheet.update(lower_bound=0.2), {"cost"}),
    "importance": (lambda sheet: sheet["cost_terms"][0].update(importance=0.5), {"cost"}),
    "hash": (lambda sheet: sheet["provenance"].update(recipe_sha256="0" * 64), {"files"}),
    "way out": (lambda sheet: sheet["parts"][0].update(stl="../../flap.stl"), {"files", "stl"}),
}


@pytest.mark.parametrize(("change", "codes"), LIES.values(), ids=LIES.keys())
def test_a_sheet_that_lies_is_caught(written: Path, change: Callable[[dict[str, Any]], Any], codes: set[str]) -> None:
    edit_sheet(written, change)
    assert failing(written) == codes


FOLDS: dict[str, tuple[Callable[[dict[str, Any]], Any], set[str]]] = {
    "no animation": (lambda doc: doc.pop("animations"), {"motion"}),
    "a part is missing": (lambda doc: doc["nodes"][1].update(name="other"), {"motion"}),
    "a loop": (lambda doc: doc["nodes"][1].update(children=[0]), {"motion"}),
    "steps": (lambda doc: doc["animations"][0]["samplers"][0].update(interpolation="STEP"), {"motion"}),
    "stretched": (lambda doc: doc["nodes"][1].update(scale=[1, 1, 1.1]), {"motion", "joints"}),
    "flap stays up": (
        lambda doc: doc["animations"][0]["channels"].pop(0),
        {"collide", "flat"},
    ),
}


@pytest.mark.parametrize(("change", "codes"), FOLDS.values(), ids=FOLDS.keys())
def test_a_fold_that_does_not_work_is_caught(
    written: Path, change: Callable[[dict[str, Any]], Any], codes: set[str]
) -> None:
    edit_glb(written, change)
    assert failing(written) & codes


def test_printability_that_was_made_better_is_caught(written: Path) -> None:
    path = written / "printability.json"
    told = json.loads(path.read_text())
    next(kind for kind in told["kinds"] if kind["name"] == "floating regions")["count"] = 0
    path.write_text(json.dumps(told))
    (row,) = [row for row in inspect_folder(written).rows if row.code == "printable"]
    assert not row.ok and "floating regions: " in row.text and row.facts["open_edges"] == 0


def test_stl_of_another_part_is_caught(written: Path) -> None:
    shutil.copy(written / "stl" / "top.stl", written / "stl" / "flap.stl")
    assert failing(written) == {"stl"}
