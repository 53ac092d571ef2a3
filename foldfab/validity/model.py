"""The nouns of this room: a Linkage (definition 1), a Folding of it (definition 3), and what is wrong with one.

Nothing here knows of furniture: bodies are rigid sets of oriented boxes, of any thickness down to none, and hinges
are lines that two of them share. Lengths are millimetres, angles radians, time t is in [0, 1].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from foldfab.geometry.arrays import Array, frozen
from foldfab.geometry.boxes import Boxes

Kind = Literal["start", "apart", "hinge", "collision", "flat"]
"""`start`: t = 0 is not the modified furniture; `apart`: a body that no hinge holds; `hinge`: condition (ii) of section
5.2; `collision`: condition (iii); `flat`: t = 1 is not a flat configuration."""


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """One rigid patch, or what has become of it."""

    name: str
    pieces: Boxes
    """(n,) what it is made of, in the open posture; a half length of 0 makes a rectangle."""
    normal: Array
    """(3,) unit normal of its sheet in the open posture."""
    is_base: bool = False
    """Whether it stays perpendicular to d all the time."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "normal", frozen(self.normal, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Hinge:
    """An edge of the hinge graph; a positive angle turns `second` against `first` right-handed about `direction`."""

    first: str
    second: str
    point: Array
    """(3,) on the axis, open posture, mm."""
    direction: Array
    """(3,) unit vector, open posture."""
    room: float = 0.0
    """Radius around the axis in which the knuckles of `first` interleave with `second`, mm: what of `second` lies
    nearer is not tested against `first`, all else is."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", frozen(self.point, 3))
        object.__setattr__(self, "direction", frozen(self.direction, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Linkage:
    """Bodies and the hinges between them, in the open posture."""

    bodies: tuple[Body, ...]
    """The first one stays where it is."""
    hinges: tuple[Hinge, ...]


def no_slip(times: Array, hinges: int) -> Array:
    """(k, h, 3) zeros: hinges without play."""
    return np.zeros((len(times), hinges, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Folding:
    """A folding transform Θ^t: the angle of every hinge at every moment."""

    model: str
    """`with thickness` or `without thickness`, for the words of a violation."""
    linkage: Linkage
    moments: Array
    """(k,) times from 0 to 1 that are looked at, ascending; between two of them everything is bisected."""
    angles: Callable[[Array], Array]
    """Times (k,) to angles (k, h), 0 in the open posture, radians."""
    slips: Callable[[Array], Array]
    """Times (k,) to (k, h, 3): how far the play of each hinge carries its second body off the first one's axis, mm."""
    places: Callable[[Array], dict[str, Array]] | None = None
    """Times (k,) to the (k, 3) translations that some bodies are said to make, mm."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "moments", frozen(self.moments, -1))


@dataclass(frozen=True, slots=True)
class Violation:
    """Why a folding solution is not valid."""

    kind: Kind
    model: str
    """`with thickness`, `without thickness`, or nothing where both are concerned."""
    time: float
    """t at which it is first seen."""
    parts: tuple[str, ...]
    """Names of the bodies, panels or patches."""
    amount: float
    """How badly, in mm, or in radians where something is turned; 0 where there is no measure."""
    text: str
    """One sentence with its moment and its parts."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """What was looked at, and what is wrong."""

    moments: int
    """Moments at which all hinges and all pairs were tested, both models together, without those of bisections."""
    closing: int
    """Hinges beyond the spanning tree, in one model."""
    violations: tuple[Violation, ...]
    """Empty where the solution is valid; by kind, then time."""
