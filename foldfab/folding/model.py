"""The noun of this room: a FoldSolution, what is changed in each patch and how everything moves.

Lengths are print millimetres in the canonical frame (d = -Z); fold progress and time are in [0, 1].
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from foldfab.geometry.arrays import Array, frozen
from foldfab.recipe.hinges import STYLES, HingeKind
from foldfab.recipe.model import PrintOptions
from foldfab.scaffold.model import Scaffold

Mechanism = Literal["in-place", "slanted", "deleted"]
Side = Literal["l", "r"]

KNUCKLE_WALL = 0.8
"""Least wall behind a socket, two lines of a 0.4 mm nozzle, mm."""
PANEL_WEB = 1.2
"""Least length of whole panel between two hinges, mm."""
POCKET_SKIN = 1.2
"""Least of a base that is left below pockets, six layers of 0.2 mm, mm."""


@dataclass(frozen=True, slots=True)
class Thickness:
    """What real material adds to the paper's zero-thickness patches (section 5.6)."""

    panel: float
    """K, mm."""
    gap: float
    """g, the printed clearance, mm."""
    hinge: HingeKind = "cone"
    """How the knuckles of a hinge are pinned together."""

    @classmethod
    def of_print(cls, options: PrintOptions) -> Thickness:
        """What the options of a print ask for."""
        return cls(options.thickness, options.clearance, options.hinge)

    def of(self, panel: float | None) -> Thickness:
        """The same with panels of another thickness, mm; itself where they have none of their own."""
        return self if panel is None or panel == self.panel else Thickness(panel, self.gap, self.hinge)

    @property
    def axis_height(self) -> float:
        """How far a base hinge's axis stands off the base face: K/2 + g, mm."""
        return self.panel / 2 + self.gap

    @property
    def axis_offset(self) -> float:
        """How far an inserted hinge's axis stands off the panel's mid-plane: (K + g)/2, mm."""
        return (self.panel + self.gap) / 2

    @property
    def pin_radius(self) -> float:
        """Base radius and height of the 45° cone that pins two knuckles together, mm."""
        return 0.3 * self.panel

    @property
    def socket_radius(self) -> float:
        """Mouth radius and depth of the conical socket, the gap away from the pin everywhere, mm."""
        return self.pin_radius + (math.sqrt(2.0) - 1.0) * self.gap

    @property
    def socket_width(self) -> float:
        """Least width of a knuckle of the carrier, mm: with a socket in one side, or as its style needs it."""
        return self.socket_radius + KNUCKLE_WALL if self.hinge == "cone" else STYLES[self.hinge].knuckle

    @property
    def hinge_width(self) -> float:
        """Least width of a hinge that cannot be pulled apart: the carrier's, the follower's and the carrier's
        knuckle, mm, with what its style needs before and behind them.
        """
        style = STYLES[self.hinge]
        return 2 * (self.socket_width + self.gap) + style.pin_knuckle + style.head + style.tip

    @property
    def foot_room(self) -> float:
        """Radius around a base hinge's axis that is cut from the panel so that the foot's corners clear, mm."""
        return math.hypot(self.panel / 2, self.axis_height) + self.gap

    @property
    def knuckle_room(self) -> float:
        """Radius around an inserted hinge's axis that is cut from the other panel, mm."""
        return self.panel / 2 + self.gap

    def least_length(self, *, is_first: bool, is_last: bool, ends_free: bool) -> float:
        """Least axis spacing of a panel that leaves a web between what its hinges take away, mm."""
        low = self.foot_room if is_first else self.knuckle_room
        high = 0.0 if is_last and ends_free else self.foot_room if is_last else self.knuckle_room
        return low + high + PANEL_WEB

    def stack(self, panels: int, *, has_upper_base: bool) -> float:
        """Clear height of a folded chain of that many panels, mm."""
        return panels * (self.panel + self.gap) + (self.gap if has_upper_base else 0.0)


@dataclass(frozen=True, slots=True)
class Modification:
    """What is done to one foldable patch: m = (N_h, s, a0, a1) of section 5.3."""

    patch: str
    mechanism: Mechanism
    hinges: int
    """N_h, hinges inserted in its interior; 0 where slanted or deleted."""
    side: Side | None
    """To which side its lowest panel folds; None where deleted."""
    window: tuple[float, float]
    """[a0, a1], the share of its width that is kept; (0, 0) where deleted."""
    importance: float
    """λ, its share of the area of all foldable patches."""
    cost: float
    """Its term of eq. 1, importance included."""
    reason: str = ""
    """Why it had to be, one clause; empty where nothing was changed."""

    @property
    def is_deleted(self) -> bool:
        """Whether the patch is taken away."""
        return self.mechanism == "deleted"


@dataclass(frozen=True, slots=True)
class Shape:
    """What the motion of a chain depends on, wherever it stands; equal shapes move alike."""

    lean: float
    """Tilt of the open patch, radians."""
    turn: float
    """Tilt of the first panel when folded: ±π/2."""
    lengths: tuple[float, ...]
    """(m,) distances between consecutive hinge axes along the panels, mm."""
    offsets: tuple[float, ...]
    """(m + 1,) how far each hinge axis stands off the panels' mid-plane, mm."""
    comes_down: bool
    """Whether its far end is a base that comes straight down."""


def mirrored(shape: Shape) -> Shape:
    """The shape of the chain that folds to the other side."""
    offsets = tuple(-offset for offset in shape.offsets)
    return Shape(-shape.lean, -shape.turn, shape.lengths, offsets, shape.comes_down)


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """A patch as it folds: rigid panels in a row, from the base that carries it (the anchor) to its far end.

    It lives in the vertical plane spanned by `across` (x) and `rise` (y); all its hinge axes run along `along`.
    A tilt is the angle of a panel from `rise` towards `across`, radians.
    """

    patch: str
    anchor: str
    """The base that carries the first hinge."""
    far: str | None
    """The base at the other end; None for a T-scaffold's free tip."""
    mechanism: Mechanism
    root: Array
    """(3,) middle of the first hinge axis, open posture, mm."""
    across: Array
    """(3,) unit horizontal normal of the upright patch."""
    along: Array
    """(3,) unit hinge direction; across × along = rise."""
    rise: Array
    """(3,) ±Z, from the anchor towards the far end."""
    lean: float
    """Tilt of the open patch, radians."""
    turn: float
    """Tilt of the first panel when folded: ±π/2."""
    lengths: Array
    """(m,) distances between consecutive hinge axes along the panels, mm; the last one to the tip of a T."""
    offsets: Array
    """(m + 1,) how far each hinge axis stands off the panels' mid-plane, mm."""
    span: Array
    """(2,) extent along `along` relative to `root` of the panels, mm."""
    hinge_spans: Array
    """(m + 1, 2) extent along `along` relative to `root` of each hinge, mm; the last row is unused at a tip."""
    pads: tuple[float, float]
    """Height of the fixed plinths at the anchor and at the far base, mm (the horizontal cropping of section 5.6);
    negative where it stands in a pocket of the base."""
    panel: float
    """K of its own panels, mm: more than the print's where the stack is balanced by thickness (figure 19)."""
    breaks: tuple[tuple[float, float], ...] = ()
    """Stretches along `along` relative to `root` that its hinges leave free of knuckles, mm, in ascending order."""
    shape: Shape = field(init=False)
    """What its motion depends on."""
    to_the_right: Shape = field(init=False)
    """The same, or its mirror image where it folds to the left: both move alike, and one table does for both."""
    basis: Array = field(init=False)
    """(3, 3) rows across, along and rise."""
    plane: Array = field(init=False)
    """(2, 3) rows across and rise, in whose plane it moves."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "root", frozen(self.root, 3))
        object.__setattr__(self, "basis", frozen([self.across, self.along, self.rise], 3, 3))
        for name, row in zip(("across", "along", "rise"), self.basis, strict=True):
            object.__setattr__(self, name, row)
        object.__setattr__(self, "plane", self.basis[::2])
        object.__setattr__(self, "lengths", frozen(self.lengths, -1))
        object.__setattr__(self, "offsets", frozen(self.offsets, len(self.lengths) + 1))
        object.__setattr__(self, "span", frozen(self.span, 2))
        object.__setattr__(self, "hinge_spans", frozen(self.hinge_spans, len(self.lengths) + 1, 2))
        comes_down = self.mechanism == "in-place" and self.far is not None
        lengths, offsets = tuple(self.lengths.tolist()), tuple(self.offsets.tolist())
        shape = Shape(float(self.lean), float(self.turn), lengths, offsets, comes_down)
        object.__setattr__(self, "shape", shape)
        object.__setattr__(self, "to_the_right", shape if shape.turn > 0 else mirrored(shape))

    @property
    def panels(self) -> tuple[str, ...]:
        """Names of its panels from the anchor on: `back` or `back/1`, `back/2`, …"""
        if len(self.lengths) == 1:
            return (self.patch,)
        return tuple(f"{self.patch}/{i + 1}" for i in range(len(self.lengths)))

    def stretches(self, hinge: int) -> tuple[tuple[float, float], ...]:
        """What its breaks leave of a hinge, by its number, along `along` relative to `root`, mm."""
        low, high = self.hinge_spans[hinge].tolist()
        ends = [low, *(min(max(end, low), high) for mark in self.breaks for end in mark), high]
        return tuple((a, b) for a, b in zip(ends[::2], ends[1::2], strict=True) if b > a)

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of all that its hinges join, in their order: anchor, panels and the far base."""
        return (self.anchor, *self.panels, *([self.far] if self.far else []))


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """The folding transform of one unit, sampled densely; between two samples it is interpolated."""

    unit: str
    patches: tuple[str, ...]
    """The foldable patches of the unit, deleted ones included."""
    start: float
    """t at which it starts to fold."""
    end: float
    """t at which it lies flat; the start of the next step."""
    samples: Array
    """(k,) local times from 0 to 1."""
    travel: dict[str, Array]
    """By base that moves, (k, 3) translation since the start of the step, mm; those moving together share an array."""
    fold: dict[str, Array]
    """By patch of the unit that is kept, (k,) fold progress s."""
    play: dict[str, Array]
    """By patch of the unit that is kept, (k,) mm along `rise` that the play in its hinges has to cover."""

    def __post_init__(self) -> None:
        n = len(self.samples)
        object.__setattr__(self, "samples", frozen(self.samples, n))
        ways = {id(v): frozen(v, n, 3) for v in self.travel.values()}
        object.__setattr__(self, "travel", {k: ways[id(v)] for k, v in self.travel.items()})
        object.__setattr__(self, "fold", {k: frozen(v, n) for k, v in self.fold.items()})
        object.__setattr__(self, "play", {k: frozen(v, n) for k, v in self.play.items()})


@dataclass(frozen=True, slots=True, eq=False)
class FoldSolution:
    """How the furniture is modified and folded, from open (t = 0) to flat (t = 1)."""

    scaffold: Scaffold
    """What it was made from."""
    thickness: Thickness
    chains: tuple[Chain, ...]
    """One for each patch that is kept, sorted by patch."""
    modifications: tuple[Modification, ...]
    """One for each foldable patch, sorted by patch."""
    steps: tuple[Step, ...]
    """In folding order."""
    cost: float
    """Eq. 1 over the whole scaffold."""
    lower_bound: float
    """No solution over the same options is cheaper."""
    notes: tuple[str, ...] = ()
    """What was done for the sake of thickness that a maker may want to know."""

    def chain(self, patch: str) -> Chain:
        """The chain of that patch."""
        return next(chain for chain in self.chains if chain.patch == patch)

    def modification(self, patch: str) -> Modification:
        """The modification of that patch."""
        return next(modification for modification in self.modifications if modification.patch == patch)
