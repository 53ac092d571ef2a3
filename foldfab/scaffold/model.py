"""The noun of this room: a Scaffold, base patches and foldable patches joined by hinges.

Everything here stands in the canonical frame: the folding direction d is -Z, lengths are print millimetres
(true millimetres times the print scale), and print = rotation · (scale · recipe).
"""

from __future__ import annotations

from dataclasses import dataclass, field

from foldfab.geometry.arrays import Array, frozen
from foldfab.recipe.model import Recipe


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """A horizontal oriented rectangle: what one member part covers of a base patch."""

    part: str
    center: Array
    """(2,) mm."""
    along: Array
    """(2,) unit direction of its first side."""
    half: Array
    """(2,) half lengths along `along` and across it, mm."""
    extent: tuple[float, float] | None = None
    """Heights between which the part lies, mm, where the parts of a base lie at several heights."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", frozen(self.center, 2))
        object.__setattr__(self, "along", frozen(self.along, 2))
        object.__setattr__(self, "half", frozen(self.half, 2))


@dataclass(frozen=True, slots=True, eq=False)
class BasePatch:
    """A patch perpendicular to d, fitted to connected coplanar parts and edges; it only ever translates."""

    name: str
    parts: tuple[str, ...]
    """The recipe's parts that lie in it."""
    bottom: float
    """Height of the lowest member mid-sheet, mm."""
    top: float
    """Height of the highest member mid-sheet, mm."""
    outlines: tuple[Outline, ...]
    """What it covers; one connected region."""
    thickness: float | None = None
    """K of its plate, mm; None where it is that of the print."""


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A foldable patch: a rectangle whose lower and upper ends are perpendicular to d."""

    name: str
    parts: tuple[str, ...]
    """The recipe's parts that it abstracts, the first one names it."""
    center: Array
    """(3,) mm."""
    along: Array
    """(3,) unit hinge direction, horizontal."""
    up: Array
    """(3,) unit direction from the lower end to the upper end, perpendicular to `along`."""
    width: float
    """Full length along the hinge direction, mm."""
    length: float
    """Full length along `up`, mm."""
    lower: str | None
    """The base patch at its lower end, None at a free tip."""
    upper: str | None
    """The base patch at its upper end, None at a free tip."""
    hingeable: bool = True
    thickness: float | None = None
    """K of its panels, mm; None where it is that of the print."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", frozen(self.center, 3))
        object.__setattr__(self, "along", frozen(self.along, 3))
        object.__setattr__(self, "up", frozen(self.up, 3))

    @property
    def area(self) -> float:
        """mm²."""
        return self.width * self.length

    @property
    def bases(self) -> tuple[str, ...]:
        """The bases it touches, lower first: one for a T-scaffold, two for an H-scaffold."""
        return tuple(base for base in (self.lower, self.upper) if base is not None)


@dataclass(frozen=True, slots=True, eq=False)
class Scaffold:
    """The whole abstraction of a recipe along its folding direction."""

    recipe: Recipe
    direction: Array
    """(3,) unit folding direction in the recipe's frame."""
    rotation: Array
    """(3, 3) turns the recipe's frame into the canonical one."""
    scale: float
    """Print size over true size."""
    bases: tuple[BasePatch, ...]
    """Sorted by height, then name."""
    patches: tuple[Patch, ...]
    """Sorted by name."""
    notes: tuple[str, ...] = ()
    """What the abstraction did to parts that a user may want to know."""
    _bases: dict[str, BasePatch] = field(init=False, repr=False)
    _patches: dict[str, Patch] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", frozen(self.direction, 3))
        object.__setattr__(self, "rotation", frozen(self.rotation, 3, 3))
        object.__setattr__(self, "_bases", {base.name: base for base in self.bases})
        object.__setattr__(self, "_patches", {patch.name: patch for patch in self.patches})

    def base(self, name: str) -> BasePatch:
        """The base patch of that name."""
        return self._bases[name]

    def patch(self, name: str) -> Patch:
        """The foldable patch of that name."""
        return self._patches[name]
