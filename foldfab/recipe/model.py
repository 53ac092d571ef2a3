"""The noun of this room: a Recipe, furniture split into parts, a folding direction and two sets of options."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from foldfab.geometry.arrays import Array, Indices, frozen, frozen_indices
from foldfab.recipe.hinges import HingeKind

Posture = Literal["open", "folded", "edge", "plate"]
PostureWish = Literal["open", "folded", "edge", "plate", "auto"]
"""A posture, or whichever is best."""
Ordering = Literal["greedy", "optimal"]
Collisions = Literal["swept", "regions"]
Mechanism = Literal["in-place", "slanted", "deleted"]
Side = Literal["l", "r"]
Material = Literal["pla", "petg", "abs", "nylon"]
Look = Literal["plain", "own"]
Source = Literal["recipe", "command line", "profile", "calibration"]
Pair = tuple[str, str]
"""The names of two parts, sorted."""

_SAME_EDGE = 1e-9
"""Shares of the width that are closer than this are the same cutting point."""


@dataclass(frozen=True, slots=True)
class Pattern:
    """What a modification m = (N_h, s, a0, a1) of section 5.3 is like; None lets anything through."""

    mechanism: Mechanism | None = None
    hinges: int | None = None
    """N_h, hinges inserted in its interior."""
    side: Side | None = None
    """To which side its lowest panel folds."""
    window: tuple[float, float] | None = None
    """[a0, a1], exactly the share of its width that is kept; [0, 1] where it is not shrunk."""

    def fits(self, mechanism: Mechanism, hinges: int, side: Side | None, window: tuple[float, float]) -> bool:
        """Whether a modification is like this. What is deleted has no hinges, side or window to speak of."""
        if self.mechanism not in (None, mechanism):
            return False
        if mechanism == "deleted":
            return (self.hinges, self.side, self.window) == (None, None, None)
        edges = zip(self.window or window, window, strict=True)
        is_same_window = all(abs(one - other) <= _SAME_EDGE for one, other in edges)
        return self.hinges in (None, hinges) and self.side in (None, side) and is_same_window


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A surface of triangles, as it stands in a file: neither closed nor oriented for certain."""

    vertices: Array
    """(n, 3)."""
    faces: Indices
    """(m, 3) indices of vertices."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, -1, 3))
        object.__setattr__(self, "faces", frozen_indices(self.faces, -1, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """One segment of the furniture, as its tight oriented box."""

    name: str
    """Unique within the recipe."""
    center: Array
    """(3,) mm."""
    size: Array
    """(3,) mm, full lengths along the rows of `axes`."""
    axes: Array
    """(3, 3) right-handed orthonormal rows."""
    hingeable: bool = True
    """False where no hinge may be inserted in its interior (section 5.7)."""
    pin: Pattern | None = None
    """What its modification has to be like; None where the search is free."""
    forbid: tuple[Pattern, ...] = ()
    """What its modification must not be like."""
    thickness: float | None = None
    """K of its plate or panels, mm in print; None where the print's options decide."""
    shape: Mesh | None = None
    """What it looks like, in true mm where it stands; None where it is its box."""
    look: Look | None = None
    """Whether it is printed as a plain plate or as it looks; None where the print's options decide."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", frozen(self.center, 3))
        object.__setattr__(self, "size", frozen(self.size, 3))
        object.__setattr__(self, "axes", frozen(self.axes, 3, 3))

    def allows(self, mechanism: Mechanism, hinges: int, side: Side | None, window: tuple[float, float]) -> bool:
        """Whether a modification of its patches is like its pin and unlike all that is forbidden."""
        asked = (mechanism, hinges, side, window)
        is_pinned = self.pin is None or self.pin.fits(*asked)
        return is_pinned and not any(pattern.fits(*asked) for pattern in self.forbid)


@dataclass(frozen=True, slots=True, kw_only=True)
class FoldOptions:
    """What the solver may do; the defaults are the paper's (section 6, Parameters)."""

    alpha: float = 0.5
    """α in [0, 1]: the weight of splits against shrinking (eq. 3)."""
    max_hinges: int = 3
    """N̂_h, the most hinges that may be inserted in a patch."""
    shrink_steps: int = 5
    """N_s, how many pieces a patch is cut into for shrinking."""
    slanting: bool = True
    """Whether H-scaffolds may fold slanted (T-scaffolds always may)."""
    stay_in_box: bool = False
    """Whether the fold must stay within the bounding box of the input."""
    ordering: Ordering = "optimal"
    """How units are ordered: greedily (section 5.5), or modifications and order chosen in one shot."""
    collisions: Collisions = "swept"
    """What makes two options conflict: shapes that meet in time, or the paper's folding times and regions that both
    overlap (section 5.4)."""
    symmetry: bool = False
    """Whether parts that mirror each other are treated alike."""
    time_limit: float = 2.0
    """Seconds on an ordinary machine, counted in work done, so that the same input gives the same answer."""


@dataclass(frozen=True, slots=True)
class Printer:
    """A printer by the volume it can build."""

    name: str
    build_volume: tuple[float, float, float]
    """mm, x × y × z."""


USUAL_THICKNESS = 4.0
"""K where nobody says another, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintOptions:
    """How the model is to be printed."""

    printer: Printer
    thickness: float = USUAL_THICKNESS
    """K, the thickness of plates and panels, mm in print."""
    may_thin: bool = field(default=False, compare=False)
    """Whether K may be less than that, where the furniture folds whole only then."""
    base_thickness: float | None = None
    """The thickness of base plates, mm in print; None where it is K."""
    own_thickness: bool = False
    """Whether each part is as thick as it is at print scale, and only where that is less as thick as said above."""
    clearance: float = 0.3
    """g, the gap that a hinge is printed with, mm in print."""
    clearance_from: Source = field(default="profile", compare=False)
    """Who said so: the profile of nozzle, layer and material, or the printer's calibration, where nobody else did."""
    nozzle: float = 0.4
    """mm."""
    layer: float = 0.2
    """Height of a layer, mm."""
    material: Material = "pla"
    posture: PostureWish = "open"
    why: str = ""
    """Why it is this posture, where it was chosen for the maker."""
    hinge: HingeKind = "cone"
    """How the knuckles of a hinge are pinned together."""
    shape: Look = "plain"
    """Whether plates are plain, or look like the parts that came as meshes or CAD solids."""
    latch: bool = False
    """Whether base hinges get a groove for a pin that holds them open."""
    scale: float | None = None
    """Print size over true size; None is the largest that fits the printer."""


@dataclass(frozen=True, slots=True, eq=False)
class Recipe:
    """Furniture as it was understood from a file."""

    name: str
    direction: Array | None
    """(3,) unit folding direction d; None takes the best of those that are tried."""
    parts: tuple[Part, ...]
    fold: FoldOptions
    print: PrintOptions
    about: str = ""
    """One line: what the furniture is modelled after."""
    source: str = field(default="<memory>")
    """Where it came from, for messages."""
    notes: tuple[str, ...] = ()
    """What reading had to suppose or leave out, a sentence each."""
    touching: tuple[Pair, ...] = ()
    """Parts that touch although their boxes are apart, sorted."""
    apart: tuple[Pair, ...] = ()
    """Parts that do not touch although their boxes do, sorted."""
    why: str = ""
    """Why it folds along its direction, where that was chosen for the maker."""

    def __post_init__(self) -> None:
        if self.direction is not None:
            object.__setattr__(self, "direction", frozen(self.direction, 3))
