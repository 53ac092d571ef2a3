"""The form of a recipe file: which keys there are and what each may hold.

Everything that can be said about one field alone is said here or in `fields`, so that all fields of a file are judged
in one pass; `problems` turns what pydantic finds into sentences, and `schema` turns the form into a JSON Schema.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationInfo, model_validator

from foldfab.recipe.fields import (
    MOST_PARTS,
    MOST_PATTERNS,
    Axes,
    Clearance,
    Coordinate,
    Direction,
    FileName,
    FolderName,
    Hinges,
    KnownPrinter,
    Length,
    MakeableHinge,
    MergedName,
    OneLine,
    Pairs,
    PartName,
    Plate,
    PrinterName,
    Scale,
    Side,
    Thickness,
    Three,
    Units,
    Window,
    complain,
)
from foldfab.recipe.model import (
    Collisions,
    FoldOptions,
    Look,
    Material,
    Mechanism,
    Ordering,
    Pattern,
    PostureWish,
    PrintOptions,
)
from foldfab.recipe.model import Side as FoldSide
from foldfab.recipe.names import part_name_problem
from foldfab.recipe.patterns import is_covered, pattern_problem, rigid_problem
from foldfab.recipe.printers import DEFAULT_PRINTER

_FOLD = FoldOptions()
_PRINT = PrintOptions(printer=DEFAULT_PRINTER)


class Form(BaseModel):
    """Strict: nothing is converted, nothing unknown is let through."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, frozen=True)


class BoxForm(Form):
    """A box: its middle, its lengths along its axes, and its axes where they are not x, y and z."""

    center: Annotated[list[Coordinate], Three] = Field(description="The middle of the box.")
    size: Annotated[list[Length], Three] = Field(description="Full lengths along the rows of axes.")
    axes: Axes | None = Field(
        default=None, description="Three right-handed orthonormal rows; x, y and z where missing."
    )


class PatternForm(Form):
    """What the modification of a part is like; what is left out may be anything."""

    mechanism: Mechanism | None = Field(default=None, description="How it folds, or deleted where it is taken away.")
    hinges: Hinges | None = Field(default=None, description="Hinges inserted in its interior.")
    side: FoldSide | None = Field(default=None, description="To which side its lowest panel folds, left or right.")
    window: Window | None = Field(
        default=None, description="Where the share of the width that is kept begins and ends, in shrink_steps-ths."
    )

    @model_validator(mode="after")
    def _is_possible(self) -> PatternForm:
        complain(pattern_problem(self.pattern))
        return self

    @property
    def pattern(self) -> Pattern:
        """The same as an item of the model."""
        window = None if self.window is None else (float(self.window[0]), float(self.window[1]))
        return Pattern(self.mechanism, self.hinges, self.side, window)


def _pinnable(pin: PatternForm, info: ValidationInfo) -> PatternForm:
    empty = "is empty, so it would pin nothing; give mechanism, hinges, side or window, or leave it out"
    complain(empty if pin.pattern == Pattern() else None)
    complain(None if info.data.get("hingeable", True) else rigid_problem(pin.pattern))
    return pin


def _forbiddable(form: PatternForm, info: ValidationInfo) -> PatternForm:
    empty = "is empty, so it would forbid everything; give mechanism, hinges, side or window, or leave it out"
    complain(empty if form.pattern == Pattern() else None)
    pin = info.data.get("pin")
    complain("forbids all that pin asks for" if pin and is_covered(pin.pattern, form.pattern) else None)
    return form


class PartForm(Form):
    """One segment of the furniture: a box, a mesh, or, beside a model, flags for the bodies of a name."""

    name: PartName = Field(
        description="Unique in the recipe; becomes a file's name. Beside a model, leg* fits all that begin so."
    )
    box: BoxForm | None = None
    mesh: FileName | None = Field(
        default=None, description="A file of shapes in the recipe's folder that is this part."
    )
    ignore: bool = Field(default=False, description="Whether these bodies of the model are left out.")
    merge: MergedName | None = Field(
        default=None, description="The name of the one part that these bodies of the model become."
    )
    by_contact: bool = Field(
        default=False, description="Whether only those of them become one part that touch; each heap is a part."
    )
    hingeable: bool = Field(default=True, description="False where no hinge may be inserted in its interior.")
    pin: Annotated[PatternForm, AfterValidator(_pinnable)] | None = Field(
        default=None, description="What its modification has to be like."
    )
    forbid: list[Annotated[PatternForm, AfterValidator(_forbiddable)]] = Field(
        default=[], max_length=MOST_PATTERNS, description="What its modification must not be like."
    )
    thickness: Plate | None = Field(default=None, description="Thickness of its plate or panels, mm in print.")
    shape: Look | None = Field(default=None, description="A plain plate, or as it looks; as the print says if missing.")

    @model_validator(mode="after")
    def _is_one_thing(self, info: ValidationInfo) -> PartForm:
        complain(self._problem((info.context or {}).get("globs", False)))
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
        if self.by_contact and self.merge is None:
            return '"by_contact" says how bodies merge; give "merge", or leave it out'
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

    name: PrinterName
    build_volume: Annotated[list[Side], Three] = Field(description="x, y and z that it can print, mm.")


PrinterChoice = Annotated[
    Annotated[KnownPrinter, Tag("<id>")] | Annotated[PrinterForm, Tag("<own>")],
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
    hinge: MakeableHinge = Field(default=_PRINT.hinge, description="How hinges are pinned together.")
    shape: Look = Field(
        default=_PRINT.shape,
        description="Plain plates, or the solids of parts that came with a shape, where they fold.",
    )
    latch: bool = Field(default=_PRINT.latch, description="Whether pins of filament can hold the furniture open.")
    scale: Scale = Field(default="fit", description="Print size over true size; fit is the largest on the printer.")


class RecipeForm(Form):
    """A piece of furniture, the direction it folds in, and how it is to be folded and printed."""

    schema_: str | None = Field(default=None, alias="$schema", description="Where editors find this schema.")
    name: FolderName | None = Field(
        default=None, description="The print folder's name; the file's name without .json where missing."
    )
    about: OneLine = Field(default="", description="One line: what the furniture is modelled after.")
    units: Units = Field(default="mm", description="Unit of all centers and sizes.")
    direction: Direction = Field(
        default="auto", description="Folding direction, a named axis or a vector; auto tries all six axes."
    )
    model: FileName | None = Field(
        default=None, description="A file of shapes in the recipe's folder; its bodies are parts."
    )
    parts: list[PartForm] = Field(default=[], max_length=MOST_PARTS)
    touching: Pairs = Field(
        default=[], description="Pairs of parts that touch although their boxes are apart; leg* fits all that begin so."
    )
    apart: Pairs = Field(default=[], description="Pairs of parts that do not touch although their boxes do.")
    fold: FoldForm = Field(default_factory=FoldForm)
    print: PrintForm = Field(default_factory=PrintForm)
