"""The gallery is the golden data: every shipped recipe has a committed sheet and picture, and is recomputed here.

Counts and words must be the same, volumes within 0.1 %, other numbers within 1e-6 of themselves or 0.001 mm.
"""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import foldfab
from foldfab.export.mesh_files import file_stems
from foldfab.export.sheet import sheet_json
from foldfab.export.shell import sheet_shells

ROOT = Path(__file__).resolve().parents[1]
PRINTS = ROOT / "prints"
RECIPES = sorted((ROOT / "recipes").glob("*.json"))
SHEETS = [path for path in RECIPES if (PRINTS / path.stem / "sheet.json").is_file()]
RENEW = "if the change is meant, renew it: for r in recipes/*.json; do foldfab print $r -q -o prints; done"
VOLUME, RELATIVE, ABSOLUTE = 1e-3, 1e-6, 1e-3
SLIM = 3
"""A sheet differs in at most that many lines in a message."""


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda path: path.stem)
def test_a_shipped_recipe_is_in_the_gallery(recipe: Path) -> None:
    folder = PRINTS / recipe.stem
    assert (folder / "sheet.json").is_file(), RENEW
    assert (folder / "preview.png").read_bytes().startswith(b"\x89PNG"), RENEW
    sheet = golden(recipe)
    assert sheet["name"] == recipe.stem
    assert sheet["posture"] == "open"


def test_the_gallery_shows_nothing_else() -> None:
    shown = {path.parent.name for path in PRINTS.glob("*/sheet.json")}
    assert shown <= {recipe.stem for recipe in RECIPES}, "a print of no shipped recipe lies in prints/"


@pytest.mark.parametrize("recipe", SHEETS, ids=lambda path: path.stem)
def test_a_sheet_is_what_comes_out_now(recipe: Path) -> None:
    found = list(differences(golden(recipe), recomputed(recipe)))
    more = f"\n  and {len(found) - SLIM} more" if len(found) > SLIM else ""
    assert not found, f"prints/{recipe.stem}/sheet.json:\n  " + "\n  ".join(found[:SLIM]) + f"{more}\n{RENEW}"


@pytest.mark.parametrize("recipe", SHEETS, ids=lambda path: path.stem)
def test_every_hinge_of_the_gallery_stops_within_three_degrees(recipe: Path) -> None:
    turned = {joint["name"]: joint["stop_deg"] for joint in golden(recipe)["joints"]}
    assert {name for name, ends in turned.items() if None in ends or max(ends) > 3.0} == set()


CHANGES: dict[str, Callable[[dict[str, Any]], None]] = {
    "a volume by 0.2 %": lambda sheet: _scale(sheet["parts"][0], "volume_mm3", 1.002),
    "the scale": lambda sheet: _scale(sheet, "scale", 1.00001),
    "a cost": lambda sheet: _add(sheet, "cost", 2e-3),
    "a count": lambda sheet: _add(sheet["options"], "max_hinges", 1),
    "a name": lambda sheet: sheet["parts"][0].update(name="other"),
    "an axis": lambda sheet: _add(sheet["joints"][0]["axis"][1], 2, 0.01),
    "a flag": lambda sheet: sheet["joints"][0].update(inserted=not sheet["joints"][0]["inserted"]),
    "a joint less": lambda sheet: sheet["joints"].pop(),
    "a field less": lambda sheet: sheet.pop("space_saving"),
    "a field more": lambda sheet: sheet.update(colour="red"),
    "a number that is none": lambda sheet: sheet.update(space_saving=math.nan),
    "a number that became a word": lambda sheet: sheet.update(components="1"),
    "a finding": lambda sheet: sheet["findings"].append({"code": "clash", "text": "seat meets back"}),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_a_changed_sheet_is_noticed(change: Callable[[dict[str, Any]], None]) -> None:
    sheet = golden(SHEETS[0])
    changed = copy.deepcopy(sheet)
    change(changed)
    assert list(differences(sheet, sheet)) == []
    assert len(list(differences(sheet, changed))) == 1


def test_rounding_is_not_a_change() -> None:
    sheet = golden(SHEETS[0])
    rounded = copy.deepcopy(sheet)
    _scale(rounded["parts"][0], "volume_mm3", 1.0005)
    _add(rounded["joints"][0]["axis"][0], 0, 5e-4)
    assert list(differences(sheet, rounded)) == []


def golden(recipe: Path) -> dict[str, Any]:
    """The committed sheet of a recipe."""
    found: dict[str, Any] = json.loads((PRINTS / recipe.stem / "sheet.json").read_text(encoding="utf-8"))
    return found


def recomputed(recipe: Path) -> dict[str, Any]:
    """The sheet of a recipe as it comes out now; no file is written."""
    assembly = foldfab.fabricate(foldfab.foldabilize(foldfab.load(str(recipe))))
    shells = sheet_shells(assembly)
    stems = file_stems(shell.name for shell in shells)
    found: dict[str, Any] = json.loads(sheet_json(assembly, shells, {n: f"stl/{s}.stl" for n, s in stems.items()}))
    return found


def differences(old: Any, new: Any, place: str = "") -> Iterator[str]:
    """Where two sheets differ by more than rounding."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted(old.keys() ^ new.keys()):
            yield f"{place}.{key} is only in the {'committed' if key in old else 'new'} sheet"
        for key in sorted(old.keys() & new.keys()):
            yield from differences(old[key], new[key], f"{place}.{key}")
    elif isinstance(old, list) and isinstance(new, list):
        if len(old) != len(new):
            yield f"{place} has {len(new)} entries, not {len(old)}"
        else:
            for i, (one, other) in enumerate(zip(old, new, strict=True)):
                yield from differences(one, other, f"{place}[{i}]")
    elif not is_same(old, new, place):
        yield f"{place} is {new!r}, not {old!r}"


def is_same(old: Any, new: Any, place: str) -> bool:
    """Whether two values agree: numbers with a fraction nearly, everything else exactly."""
    if not (isinstance(old, float) and isinstance(new, float)):
        return type(old) is type(new) and bool(old == new)
    if place.endswith("volume_mm3"):
        return math.isclose(old, new, rel_tol=VOLUME)
    absolute = ABSOLUTE if is_length(place) else RELATIVE
    return math.isclose(old, new, rel_tol=RELATIVE, abs_tol=absolute)


def is_length(place: str) -> bool:
    """Whether the number there is in millimetres or degrees."""
    return "_mm" in place or ".axis" in place or "_deg" in place


def _add(where: Any, key: Any, amount: float) -> None:
    where[key] += amount


def _scale(where: Any, key: Any, factor: float) -> None:
    where[key] *= factor
