"""The noun of this room: Shapes, the bodies that a file holds, before anything is made of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from foldfab.recipe.model import Mesh

Up = Literal["x", "y", "z"]


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """One body where it stands in the furniture, in its file's unit and axes."""

    name: str
    """As the file has it; neither unique nor safe, empty where there is none."""
    mesh: Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Shapes:
    """What a file of shapes holds."""

    bodies: tuple[Body, ...]
    up: Up = "z"
    """The axis that points up by the file's format."""
    millimetres: float | None = None
    """Of one unit of the file; None where its format states no unit."""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Wishes:
    """How shapes are to be understood; None and False leave it to the file."""

    units: str | None = None
    """"mm", "cm", "m" or "in", whatever the file states."""
    default_units: str | None = None
    """The same, for files whose format states none."""
    up: str | None = None
    """"x", "y" or "z"."""
    split_shells: bool = False
    """Whether shells of one body that do not touch are parts of their own."""
    smallest: float | None = None
    """mm; what is no longer than this is hardware and left out. None: a share of the furniture."""
    ignore: tuple[str, ...] = ()
    """Patterns of names that are left out."""
