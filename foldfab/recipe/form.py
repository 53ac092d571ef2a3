"""The form of a recipe file: which keys there are and what each may hold.

Everything that can be said about one field alone is said here, so that all fields of a file are judged in one pass;
`problems` turns what pydantic finds into sentences, and `schema` turns the form into a JSON Schema for editors.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    StringConstraints,
    Tag,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import PydanticCustomError

from foldfab.recipe.clearance import LEAST, MOST
from foldfab.recipe.hinges import HingeKind, hinge_problem
from foldfab.recipe.model import (
    Collisions,
    FoldOptions,
    Material,
    Mechanism,
    Ordering,
    Pattern,
    PostureWish,
    PrintOptions,
)
from foldfab.recipe.model import Side as FoldSide
from foldfab.recipe.names import folder_name_problem, has_control_characters, part_name_problem
from foldfab.recipe.patterns import hinges_problem, is_covered, pattern_problem, rigid_problem, window_problem
from foldfab.recipe.printers import DEFAULT_PRINTER, LARGEST, PRINTERS, SMALLEST

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

_FOLD = FoldOptions()
_PRINT = PrintOptions(printer=DEFAULT_PRINTER)

Units = Literal["mm", "cm", "m", "in"]
MILLIMETRES: dict[str, float] = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
"""By unit."""


def _complain(text: str | None) -> None:
    if text is not None:
        raise PydanticCustomError(OWN_WORDS, "{text}", {"text": text})


def _folder(name: str) -> str:
    _complain(folder_name_problem(name))
    return name


def _part_name(name: str, info: ValidationInfo) -> str:
    """Beside a model it may be a pattern for several names."""
    globs = (info.context or {}).get("globs", False)
    return _pattern_of_names(name) if globs else _merged_name(name)


def _pattern_of_names(name: str) -> str:
    _complain(part_name_problem(name.replace("*", "x").replace("?", "x")))
    return name


def _merged_name(name: str) -> str:
    _complain(part_name_problem(name))
    return name


def _file(name: str) -> str:
    _complain(None if name.strip() and not has_control_characters(name) else "should be a file's name")
    return name


def _printer_name(text: str) -> str:
    _complain(None if 0 < len(text.strip()) <= 100 else "should be one line of 1 to 100 characters")
    return _one_line(text)


def _one_line(text: str) -> str:
    _complain("should be one line without control characters" if has_control_characters(text) else None)
    return text


def _in_reach(value: float, info: ValidationInfo) -> float:
    factor = (info.context or {}).get("factor", 1.0)
    far = abs(value) * factor > FARTHEST
    _complain(f"{value:g} is more than {FARTHEST:.0f} mm; is the unit right?" if far else None)
    return value


def _thick_enough(value: float, info: ValidationInfo) -> float:
    factor = (info.context or {}).get("factor", 1.0)
    thin = 0 < value * factor < SMALLEST_SIZE
    _complain(f"{value:g} is less than {SMALLEST_SIZE:g} mm; is the unit right?" if thin else None)
    return value


def _right_handed(rows: list[list[float]]) -> list[list[float]]:
    matrix = np.array(rows)
    with np.errstate(over="ignore", invalid="ignore"):
        is_orthonormal = bool(np.abs(matrix @ matrix.T - np.eye(3)).max() <= AXES_TOLERANCE)
    _complain(None if is_orthonormal else "should be three unit rows at right angles to each other")
    left = float(np.linalg.det(matrix)) < 0
    _complain("should be right-handed (row 1 × row 2 = row 3); change the sign of the last row" if left else None)
    return rows


def _not_zero(vector: list[float]) -> list[float]:
    _complain("is zero; give a vector that points somewhere, such as [0, 0, -1]" if not any(vector) else None)
    return vector


def _on_cuts(window: list[float], info: ValidationInfo) -> list[float]:
    _complain(window_problem(window, (info.context or {}).get("shrink_steps")))
    return window


def _allowed_hinges(hinges: int, info: ValidationInfo) -> int:
    _complain(hinges_problem(hinges, (info.context or {}).get("max_hinges")))
    return hinges


def _makeable(hinge: HingeKind, info: ValidationInfo) -> HingeKind:
    thickness = info.data.get("thickness")
    _complain(hinge_problem(hinge, _PRINT.thickness if thickness == "auto" else thickness, info.data.get("posture")))
    return hinge


def _known_printer(text: str) -> str:
    known = ", ".join(PRINTERS)
    own = '{"name": "mine", "build_volume": [200, 200, 180]}'
    _complain(None if text in PRINTERS else f"should be one of {known}, or {own}, not {text!r}")
    return text


Coordinate = Annotated[float, AfterValidator(_in_reach)]
Length = Annotated[float, Field(gt=0), AfterValidator(_thick_enough), AfterValidator(_in_reach)]
Side = Annotated[float, Field(ge=SMALLEST, le=LARGEST)]
Plate = Annotated[float, Field(ge=THINNEST, le=THICKEST)]
Three = Field(min_length=3, max_length=3)
Vector = Annotated[list[float], Three]
Window = Annotated[
    list[Annotated[float, Field(ge=0, le=1)]], Field(min_length=2, max_length=2), AfterValidator(_on_cuts)
]
AxisName = Literal["x", "+x", "-x", "y", "+y", "-y", "z", "+z", "-z", "auto"]
Direction = Annotated[
    Annotated[AxisName, Tag("<axis>")] | Annotated[Vector, AfterValidator(_not_zero), Tag("<vector>")],
    Discriminator(lambda value: "<vector>" if isinstance(value, list) else "<axis>"),
]
Pairs = Annotated[
    list[Annotated[list[Annotated[str, AfterValidator(_pattern_of_names)]], Field(min_length=2, max_length=2)]],
    Field(max_length=MOST_PAIRS),
]
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


class Form(BaseModel):
    """Strict: nothing is converted, nothing unknown is let through."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, frozen=True)


class BoxForm(Form):
    """A box: its middle, its lengths along its axes, and its axes where they are not x, y and z."""

    center: Annotated[list[Coordinate], Three] = Field(description="The middle of the box.")
    size: Annotated[list[Length], Three] = Field(description="Full lengths along the rows of axes.")
    axes: Annotated[list[Vector], Three, AfterValidator(_right_handed)] | None = Field(
        default=None, description="Three right-handed orthonormal rows; x, y and z where missing."
    )


class PatternForm(Form):
    """What the modification of a part is like; what is left out may be anything."""

    mechanism: Mechanism | None = Field(default=None, description="How it folds, or deleted where it is taken away.")
    hinges: Annotated[int, Field(ge=0, le=9), AfterValidator(_allowed_hinges)] | None = Field(
        default=None, description="Hinges inserted in its interior."
    )
    side: FoldSide | None = Field(default=None, description="To which side its lowest panel folds, left or right.")
    window: Window | None = Field(
        default=None, description="Where the share of the width that is kept begins and ends, in shrink_steps-ths."
    )

    @model_validator(mode="after")
    def _is_possible(self) -> PatternForm:
        _complain(pattern_problem(self.pattern))
        return self

    @property
    def pattern(self) -> Pattern:
        """The same as an item of the model."""
        window = None if self.window is None else (float(self.window[0]), float(self.window[1]))
        return Pattern(self.mechanism, self.hinges, self.side, window)


def _pinnable(pin: PatternForm, info: ValidationInfo) -> PatternForm:
    empty = "is empty, so it would pin nothing; give mechanism, hinges, side or window, or leave it out"
    _complain(empty if pin.pattern == Pattern() else None)
    _complain(None if info.data.get("hingeable", True) else rigid_problem(pin.pattern))
    return pin


def _forbiddable(form: PatternForm, info: ValidationInfo) -> PatternForm:
    empty = "is empty, so it would forbid everything; give mechanism, hinges, side or window, or leave it out"
    _complain(empty if form.pattern == Pattern() else None)
    pin = info.data.get("pin")
    _complain("forbids all that pin asks for" if pin and is_covered(pin.pattern, form.pattern) else None)
    return form


class PartForm(Form):
    """One segment of the furniture: a box, a mesh, or, beside a model, flags for the bodies of a name."""

    name: Annotated[str, AfterValidator(_part_name)] = Field(
        description="Unique in the recipe; becomes a file's name. Beside a model, leg* fits all that begin so."
    )
    box: BoxForm | None = None
    mesh: Annotated[str, AfterValidator(_file)] | None = Field(
        default=None, description="A file of shapes in the recipe's folder that is this part."
    )
    ignore: bool = Field(default=False, description="Whether these bodies of the model are left out.")
    merge: Annotated[str, AfterValidator(_merged_name)] | None = Field(
        default=None, description="The name of the one part that these bodies of the model become."
    )
    hingeable: bool = Field(default=True, description="False where no hinge may be inserted in its interior.")
    pin: Annotated[PatternForm, AfterValidator(_pinnable)] | None = Field(
        default=None, description="What its modification has to be like."
    )
    forbid: list[Annotated[PatternForm, AfterValidator(_forbiddable)]] = Field(
        default=[], max_length=MOST_PATTERNS, description="What its modification must not be like."
    )
    thickness: Plate | None = Field(default=None, description="Thickness of its plate or panels, mm in print.")

    @model_validator(mode="after")
    def _is_one_thing(self, info: ValidationInfo) -> PartForm:
        _complain(self._problem((info.context or {}).get("globs", False)))
        return self

    def _problem(self, beside_model: bool) -> str | None:
        """Why its keys do not go together, None where they do."""
        if self.box is not None and self.mesh is not None:
            return "has a box and a mesh; keep one"
        has_shape = self.box is not None or self.mesh is not None
        if (self.ignore or self.merge is not None) and (has_shape or not beside_model):
            return '"ignore" and "merge" are for bodies of a "model"; leave them out'
        if self.ignore and self.merge is not None:
            return "is ignored and merged; keep one"
        return part_name_problem(self.name) if has_shape else None


class FoldForm(Form):
    """What the solver may do."""

    alpha: float = Field(
        default=_FOLD.alpha, ge=0, le=1, description="Weight of inserted hinges (1) against shrinking (0)."
    )
    max_hinges: int = Field(default=_FOLD.max_hinges, ge=1, le=9, description="Most hinges inserted in one patch.")
    shrink_steps: int = Field(
        default=_FOLD.shrink_steps, ge=1, le=20, description="How many pieces a patch is cut into for shrinking."
    )
    slanting: bool = Field(default=_FOLD.slanting, description="Whether two bases may shear past each other.")
    stay_in_box: bool = Field(
        default=_FOLD.stay_in_box, description="Whether the fold must stay within the furniture's bounding box."
    )
    ordering: Ordering = Field(
        default=_FOLD.ordering, description="The paper's greedy order, or modifications and order chosen in one shot."
    )
    collisions: Collisions = Field(
        default=_FOLD.collisions,
        description="What rules options out: shapes that meet in time, or the paper's times and regions that overlap.",
    )
    symmetry: bool = Field(
        default=_FOLD.symmetry, description="Whether parts that mirror each other are treated alike."
    )
    time_limit: float = Field(
        default=_FOLD.time_limit,
        gt=0,
        le=3600,
        description="Seconds of work on an ordinary machine, counted in work and not in wall time.",
    )


class PrinterForm(Form):
    """A printer of one's own."""

    name: Annotated[str, AfterValidator(_printer_name)]
    build_volume: Annotated[list[Side], Three] = Field(description="x, y and z that it can print, mm.")


PrinterChoice = Annotated[
    Annotated[str, AfterValidator(_known_printer), WithJsonSchema({"enum": list(PRINTERS)}), Tag("<id>")]
    | Annotated[PrinterForm, Tag("<own>")],
    Discriminator(lambda value: "<own>" if isinstance(value, dict) else "<id>"),
]


class PrintForm(Form):
    """How the model is to be printed; always in millimetres of the print."""

    printer: PrinterChoice = Field(default=DEFAULT_PRINTER.name, description="A known printer or one's own.")
    thickness: Thickness = Field(
        default="auto",
        description="Thickness of plates and panels, mm; auto is 4, or less where it folds whole only so.",
    )
    base_thickness: Plate | None = Field(
        default=None, description="Thickness of base plates, mm; that of panels where missing."
    )
    own_thickness: bool = Field(
        default=_PRINT.own_thickness,
        description="Whether each part is as thick as it is at print scale, but no thinner than said above.",
    )
    clearance: Clearance = Field(
        default="auto", description="Gap that a hinge is printed with, mm; auto is by calibration, nozzle and material."
    )
    nozzle: float = Field(default=_PRINT.nozzle, ge=0.1, le=1.5, description="Diameter of the nozzle, mm.")
    layer: float = Field(default=_PRINT.layer, ge=0.03, le=1, description="Height of a layer, mm.")
    material: Material = Field(default=_PRINT.material, description="What it is printed of.")
    posture: PostureWish = Field(
        default=_PRINT.posture,
        description="Open; folded flat; on edge, hinge axes vertical; in loose parts on plates; or what is best.",
    )
    hinge: Annotated[HingeKind, AfterValidator(_makeable)] = Field(
        default=_PRINT.hinge, description="How hinges are pinned together."
    )
    shape: Literal["plain", "own"] = Field(
        default=_PRINT.shape, description="Plain plates, or cut to the outlines of parts that came with a shape."
    )
    latch: bool = Field(default=_PRINT.latch, description="Whether a detent holds the furniture open.")
    scale: Scale = Field(default="fit", description="Print size over true size; fit is the largest on the printer.")


class RecipeForm(Form):
    """A piece of furniture, the direction it folds in, and how it is to be folded and printed."""

    schema_: str | None = Field(default=None, alias="$schema", description="Where editors find this schema.")
    name: Annotated[str, AfterValidator(_folder)] | None = Field(
        default=None, description="The print folder's name; the file's name without .json where missing."
    )
    about: Annotated[str, StringConstraints(max_length=500), AfterValidator(_one_line)] = Field(
        default="", description="One line: what the furniture is modelled after."
    )
    units: Units = Field(default="mm", description="Unit of all centers and sizes.")
    direction: Direction = Field(
        default="auto", description="Folding direction, a named axis or a vector; auto tries all six axes."
    )
    model: Annotated[str, AfterValidator(_file)] | None = Field(
        default=None, description="A file of shapes in the recipe's folder; its bodies are parts."
    )
    parts: list[PartForm] = Field(default=[], max_length=MOST_PARTS)
    touching: Pairs = Field(
        default=[], description="Pairs of parts that touch although their boxes are apart; leg* fits all that begin so."
    )
    apart: Pairs = Field(default=[], description="Pairs of parts that do not touch although their boxes do.")
    fold: FoldForm = Field(default_factory=FoldForm)
    print: PrintForm = Field(default_factory=PrintForm)
