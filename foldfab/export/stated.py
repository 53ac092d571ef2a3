"""What a print folder's `sheet.json` states, as far as it can be checked."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from foldfab.errors import PrintFolderError
from foldfab.geometry.arrays import Array, frozen

MOST_FIT = 0.5
"""More than this between two pieces is no fit, mm."""
MOST_PIN = 5.0
"""No pin is thicker than this, mm."""
MOST_PLAY = 10.0
"""A latch that lets a hinge turn further than this is none, degrees."""


@dataclass(frozen=True, slots=True, eq=False)
class StatedPart:
    """One printed part."""

    name: str
    kind: str
    stl: str
    """Path of its STL within the folder."""
    volume: float
    """mm³."""
    normal: Array
    """(3,) of its plate, open posture, sheet frame."""


@dataclass(frozen=True, slots=True, eq=False)
class StatedSeam:
    """What holds two pieces of a part together."""

    fit: float
    """The gap between them, mm."""
    pull: Array
    """(3,) unit vector along which the second cannot be pulled off the first, open posture, sheet frame."""


@dataclass(frozen=True, slots=True, eq=False)
class StatedLatch:
    """The pin that holds a hinge open."""

    base: str
    """The part in which it lies."""
    width: float
    """Its diameter, mm."""
    ends: Array
    """(2, 3) of its axis, mm, open posture, sheet frame."""
    holds_at: float
    """How far the hinge turns before it meets the pin, degrees."""


@dataclass(frozen=True, slots=True, eq=False)
class StatedJoint:
    """One hinge, or one seam."""

    name: str
    parts: tuple[str, str]
    axis: Array
    """(2, 3) mm, open posture, sheet frame."""
    radius: float
    """Of its knuckles, mm."""
    range_deg: tuple[float, float]
    latch: StatedLatch | None = None
    seam: StatedSeam | None = None


@dataclass(frozen=True, slots=True)
class StatedTerm:
    """The cost term of one foldable patch."""

    importance: float
    hinges: int
    window: tuple[float, float]
    is_deleted: bool


@dataclass(frozen=True, slots=True, eq=False)
class Stated:
    """The fields of `sheet.json` that are checked."""

    name: str
    recipe_sha256: str
    """Of `recipe.json`."""
    posture: str
    direction: Array
    """(3,) unit vector."""
    clearance: float
    """mm."""
    bed: Array
    """(3,) build volume, mm."""
    print_files: tuple[str, ...]
    propped: tuple[str, ...]
    """Parts that are printed with a prop to be broken off."""
    space_saving: float
    alpha: float
    max_hinges: int
    cost: float
    lower_bound: float
    terms: tuple[StatedTerm, ...]
    components: int
    parts: tuple[StatedPart, ...]
    joints: tuple[StatedJoint, ...]


def read_sheet(folder: Path) -> dict[str, Any]:
    """The JSON object of a print folder's `sheet.json`.

    Raises:
        PrintFolderError: there is none, or it is no JSON object.
    """
    path = folder / "sheet.json"
    try:
        sheet = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise PrintFolderError(f"{path}: cannot be read ({error.strerror}); is this a print folder?") from error
    except (ValueError, RecursionError) as error:
        raise PrintFolderError(f"{path}: is not JSON ({error}); print the recipe again") from error
    if not isinstance(sheet, dict):
        raise PrintFolderError(f"{path}: holds no JSON object; print the recipe again")
    return sheet


def stated(sheet: dict[str, Any]) -> Stated:
    """The checked fields of a sheet.

    Raises:
        KeyError, TypeError, ValueError: a field is absent or of another form.
    """
    direction = frozen(sheet["direction"], 3)
    parts = tuple(_part(row) for row in sheet["parts"])
    names = {part.name for part in parts}
    if abs(float(direction @ direction) - 1) > 1e-6:
        raise ValueError("direction is no unit vector")
    if not parts or len(names) != len(parts):
        raise ValueError("parts are none, or share a name")
    return Stated(
        name=_text(sheet["name"]),
        recipe_sha256=_text(sheet["provenance"]["recipe_sha256"]),
        posture=_text(sheet["posture"]),
        direction=direction,
        clearance=_number(sheet["clearance_mm"]),
        bed=frozen(sheet["printer"]["build_volume_mm"], 3),
        print_files=tuple(_text(name) for name in sheet.get("print_files", [f"{sheet['name']}.3mf"])),
        propped=tuple(_text(name) for name in sheet.get("propped", [])),
        space_saving=_number(sheet["space_saving"]),
        alpha=_number(sheet["options"]["alpha"]),
        max_hinges=int(_number(sheet["options"]["max_hinges"])),
        cost=_number(sheet["cost"]),
        lower_bound=_number(sheet["lower_bound"]),
        terms=tuple(_term(row) for row in sheet["cost_terms"]),
        components=int(_number(sheet.get("components", 1))),
        parts=parts,
        joints=tuple(_joint(row, names) for row in sheet["joints"]),
    )


def inside(folder: Path, name: str) -> Path:
    """The path of a file of the folder; a sheet must not lead anywhere else.

    Raises:
        ValueError: it leads out of the folder.
    """
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise ValueError(f"{name} leads out of the folder")
    return path


def _part(row: dict[str, Any]) -> StatedPart:
    normal = frozen(row["normal"], 3)
    if abs(float(normal @ normal) - 1) > 1e-4:
        raise ValueError(f"normal of {row['name']} is no unit vector")
    return StatedPart(_text(row["name"]), _text(row["kind"]), _text(row["stl"]), _number(row["volume_mm3"]), normal)


def _joint(row: dict[str, Any], names: set[str]) -> StatedJoint:
    a, b = row["parts"]
    if not {a, b} <= names or a == b:
        raise ValueError(f"joint {row['name']} does not join two of the parts")
    low, high = row["range_deg"]
    latch = _latch(row["latch"], (a, b)) if "latch" in row else None
    axis, radius = frozen(row["axis"], 2, 3), _number(row["radius_mm"])
    seam = _seam(row["seam"]) if "seam" in row else None
    return StatedJoint(_text(row["name"]), (a, b), axis, radius, (_number(low), _number(high)), latch, seam)


def _latch(row: dict[str, Any], parts: tuple[str, str]) -> StatedLatch:
    base, width, ends, holds_at = row["base"], _number(row["pin_mm"]), frozen(row["ends"], 2, 3), row["holds_at_deg"]
    if base not in parts or not 0 < width <= MOST_PIN or not bool((ends[0] != ends[1]).any()):
        raise ValueError(f"a latch whose pin of {width:g} mm has no ends, or lies in neither part of its joint")
    if not 0 <= _number(holds_at) <= MOST_PLAY:
        raise ValueError(f"a latch that holds at {holds_at:g}°")
    return StatedLatch(base, width, ends, float(holds_at))


def _seam(row: dict[str, Any]) -> StatedSeam:
    fit, pull = _number(row["fit_mm"]), frozen(row["pull"], 3)
    if not 0 < fit <= MOST_FIT or abs(float(pull @ pull) - 1) > 1e-4:
        raise ValueError(f"a seam with a fit of {fit:g} mm, or pulled along no unit vector")
    return StatedSeam(fit, pull)


def _term(row: dict[str, Any]) -> StatedTerm:
    low, high = row["window"]
    window = (_number(low), _number(high))
    return StatedTerm(_number(row["importance"]), int(_number(row["hinges"])), window, bool(row.get("deleted", False)))


def _text(value: Any) -> str:
    if not isinstance(value, str) or not value:
        raise ValueError(f"{value!r} stands where a text should")
    return value


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not -1e12 < value < 1e12:
        raise ValueError(f"{value!r} stands where a number should")
    return float(value)
