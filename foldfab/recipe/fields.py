"""The fields of a recipe file: what each may hold, as types that judge their values (`form` puts them together)."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, StringConstraints, Tag, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from foldfab.recipe.clearance import LEAST, MOST
from foldfab.recipe.hinges import HingeKind, hinge_problem
from foldfab.recipe.model import USUAL_THICKNESS
from foldfab.recipe.names import folder_name_problem, has_control_characters, part_name_problem
from foldfab.recipe.patterns import hinges_problem, window_problem
from foldfab.recipe.printers import LARGEST, PRINTERS, SMALLEST

MOST_PARTS = 20_000
"""Enough for composites of 32 × 32 cells."""
THINNEST, THICKEST = 2.0, 20.0
"""Limits of the thickness of a plate, mm in print."""
MOST_PATTERNS = 100
"""Forbidden for one part."""
MOST_PAIRS = 20_000
"""Of parts of which is said whether they touch."""
FARTHEST = 1e6
"""mm; larger sizes and coordinates are a wrong unit."""
SMALLEST_SIZE = 0.01
"""mm; thinner boxes are a wrong unit."""
AXES_TOLERANCE = 1e-3
"""How far the rows of `axes` may be from orthonormal, in every entry of axes · axesᵀ."""
OWN_WORDS = "foldfab"
"""The type of errors whose message is already a sentence of ours."""

Units = Literal["mm", "cm", "m", "in"]
MILLIMETRES: dict[str, float] = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
"""By unit."""


def complain(text: str | None) -> None:
    """What is wrong with a value in a sentence of ours, where there is one.

    Raises:
        PydanticCustomError: there is.
    """
    if text is not None:
        raise PydanticCustomError(OWN_WORDS, "{text}", {"text": text})


def _folder(name: str) -> str:
    complain(folder_name_problem(name))
    return name


def _part_name(name: str, info: ValidationInfo) -> str:
    """Beside a model it may be a pattern for several names."""
    globs = (info.context or {}).get("globs", False)
    return _pattern_of_names(name) if globs else _merged_name(name)


def _pattern_of_names(name: str) -> str:
    complain(part_name_problem(name.replace("*", "x").replace("?", "x")))
    return name


def _merged_name(name: str) -> str:
    complain(part_name_problem(name))
    return name


def _file(name: str) -> str:
    complain(None if name.strip() and not has_control_characters(name) else "should be a file's name")
    return name


def _printer_name(text: str) -> str:
    complain(None if 0 < len(text.strip()) <= 100 else "should be one line of 1 to 100 characters")
    return _one_line(text)


def _one_line(text: str) -> str:
    complain("should be one line without control characters" if has_control_characters(text) else None)
    return text


def _in_reach(value: float, info: ValidationInfo) -> float:
    factor = (info.context or {}).get("factor", 1.0)
    far = abs(value) * factor > FARTHEST
    complain(f"{value:g} is more than {FARTHEST:.0f} mm; is the unit right?" if far else None)
    return value


def _thick_enough(value: float, info: ValidationInfo) -> float:
    factor = (info.context or {}).get("factor", 1.0)
    thin = 0 < value * factor < SMALLEST_SIZE
    complain(f"{value:g} is less than {SMALLEST_SIZE:g} mm; is the unit right?" if thin else None)
    return value


def _right_handed(rows: list[list[float]]) -> list[list[float]]:
    matrix = np.array(rows)
    with np.errstate(over="ignore", invalid="ignore"):
        is_orthonormal = bool(np.abs(matrix @ matrix.T - np.eye(3)).max() <= AXES_TOLERANCE)
    complain(None if is_orthonormal else "should be three unit rows at right angles to each other")
    left = float(np.linalg.det(matrix)) < 0
    complain("should be right-handed (row 1 × row 2 = row 3); change the sign of the last row" if left else None)
    return rows


def _not_zero(vector: list[float]) -> list[float]:
    complain("is zero; give a vector that points somewhere, such as [0, 0, -1]" if not any(vector) else None)
    return vector


def _on_cuts(window: list[float], info: ValidationInfo) -> list[float]:
    complain(window_problem(window, (info.context or {}).get("shrink_steps")))
    return window


def _allowed_hinges(hinges: int, info: ValidationInfo) -> int:
    complain(hinges_problem(hinges, (info.context or {}).get("max_hinges")))
    return hinges


def _makeable(hinge: HingeKind, info: ValidationInfo) -> HingeKind:
    thickness = info.data.get("thickness")
    complain(hinge_problem(hinge, USUAL_THICKNESS if thickness == "auto" else thickness, info.data.get("posture")))
    return hinge


def _known_printer(text: str) -> str:
    known = ", ".join(PRINTERS)
    own = '{"name": "mine", "build_volume": [200, 200, 180]}'
    complain(None if text in PRINTERS else f"should be one of {known}, or {own}, not {text!r}")
    return text


Coordinate = Annotated[float, AfterValidator(_in_reach)]
Length = Annotated[float, Field(gt=0), AfterValidator(_thick_enough), AfterValidator(_in_reach)]
Side = Annotated[float, Field(ge=SMALLEST, le=LARGEST)]
Plate = Annotated[float, Field(ge=THINNEST, le=THICKEST)]
Three = Field(min_length=3, max_length=3)
Vector = Annotated[list[float], Three]
Axes = Annotated[list[Vector], Three, AfterValidator(_right_handed)]
Window = Annotated[
    list[Annotated[float, Field(ge=0, le=1)]], Field(min_length=2, max_length=2), AfterValidator(_on_cuts)
]
AxisName = Literal["x", "+x", "-x", "y", "+y", "-y", "z", "+z", "-z", "auto"]
Direction = Annotated[
    Annotated[AxisName, Tag("<axis>")] | Annotated[Vector, AfterValidator(_not_zero), Tag("<vector>")],
    Discriminator(lambda value: "<vector>" if isinstance(value, list) else "<axis>"),
]
NamePattern = Annotated[str, AfterValidator(_pattern_of_names)]
Pairs = Annotated[list[Annotated[list[NamePattern], Field(min_length=2, max_length=2)]], Field(max_length=MOST_PAIRS)]
FolderName = Annotated[str, AfterValidator(_folder)]
PartName = Annotated[str, AfterValidator(_part_name)]
MergedName = Annotated[str, AfterValidator(_merged_name)]
FileName = Annotated[str, AfterValidator(_file)]
PrinterName = Annotated[str, AfterValidator(_printer_name)]
KnownPrinter = Annotated[str, AfterValidator(_known_printer), WithJsonSchema({"enum": list(PRINTERS)})]
OneLine = Annotated[str, StringConstraints(max_length=500), AfterValidator(_one_line)]
Hinges = Annotated[int, Field(ge=0, le=9), AfterValidator(_allowed_hinges)]
MakeableHinge = Annotated[HingeKind, AfterValidator(_makeable)]
Scale = Annotated[
    Annotated[Literal["fit"], Tag("<fit>")] | Annotated[float, Field(ge=1e-5, le=1e3), Tag("<number>")],
    Discriminator(lambda value: "<fit>" if isinstance(value, str) else "<number>"),
]
Thickness = Annotated[
    Annotated[Literal["auto"], Tag("<auto>")] | Annotated[Plate, Tag("<number>")],
    Discriminator(lambda value: "<auto>" if isinstance(value, str) else "<number>"),
]
Clearance = Annotated[
    Annotated[Literal["auto"], Tag("<auto>")] | Annotated[float, Field(ge=LEAST, le=MOST), Tag("<number>")],
    Discriminator(lambda value: "<auto>" if isinstance(value, str) else "<number>"),
]


TAGS = ("<auto>", "<axis>", "<vector>", "<fit>", "<number>", "<id>", "<own>")
"""What keeps the branches of unions apart; left out of places."""
