"""What a print has room for: on its bed, between its bodies as they fold, beside the feet and knuckles of its hinges.

A judge knows how bodies move, how large the print is by now and where its hinges are. The bodies as they stand are
shown to it with each question; a piece is asked for as one of a body, with which it moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.hinges import knuckles
from foldfab.fabrication.inspect import CLASH, GAP_SHARE, box_corners, instants
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.passing import Passage, seen_from
from foldfab.fabrication.places import places
from foldfab.fabrication.plates import ROOT_SHARE, axis_of
from foldfab.fabrication.pockets import pocket
from foldfab.fabrication.posture import needs_pins, printed_pose, printed_turn
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.walls import LINE, thin_sides
from foldfab.geometry.arrays import Array

ROUNDING = 0.01
"""By how much a print may seem to grow, mm."""

Box = tuple[Array, Array]
"""Two corners (3,), mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Foot:
    """What carries a hinge on its base: a foot or a plinth, with its root in the plate."""

    base: str
    panels: tuple[str, ...]
    """Those of the chain that stands on it."""
    box: Box


class Judge:
    """What there is room for in a print."""

    def __init__(
        self, assembly: Assembly, made: Mapping[str, Solid], ramps: Mapping[str, list[Shape]] = MappingProxyType({})
    ) -> None:
        """`made` is all bodies to begin with, `ramps` what will be cut from them at last."""
        self._assembly, self._gap = assembly, assembly.solution.thickness.gap
        self._passage = Passage(assembly.solution, instants(assembly))
        self.poses = self._passage.poses
        """By body, (k, 4, 4) motions from the open posture, all along the fold."""
        self._turn = printed_turn(assembly)
        self._extent = _around(self._on_bed(name, solid) for name, solid in made.items())
        self._feet = list(_feet(assembly))
        self._planes = {place.name: place.plane for place in places(assembly.solution)}
        self._ramps = {name: [printed(ramp) for ramp in some] for name, some in ramps.items()}

    def accept(self, name: str, solid: Solid) -> None:
        """Lets a body become another solid: the print is at least so large from now on."""
        self._extent = _around([self._on_bed(name, solid), self._extent])

    def fits(self, body: str, piece: Solid) -> bool:
        """Whether the print, which may fit its bed just so, still fits it with a piece of a body."""
        if needs_pins(self._assembly.posture):
            return True
        bed = np.array(self._assembly.solution.scaffold.recipe.print.printer.build_volume)
        low, high = _around([self._on_bed(body, piece), self._extent])
        size, now = high - low, self._extent[1] - self._extent[0]
        return bool((size <= bed).all() or (size[[1, 0, 2]] <= bed).all() or (size <= now + ROUNDING).all())

    def met(self, body: str, piece: Solid, others: Mapping[str, Solid], *, in_between: bool = True) -> Iterator[str]:
        """The names of other bodies to which a piece of a body comes too close: in print, or anywhere in the fold.

        Without `in_between` at the instants of the fold alone.
        """
        for name, other in others.items():
            if name != body and not self._is_apart(body, piece, name, other, in_between=in_between):
                yield name

    def is_apart(self, body: str, piece: Solid, others: Mapping[str, Solid]) -> bool:
        """Whether a piece of a body stays apart from all other bodies, in print and all along the fold."""
        return not any(self.met(body, piece, others))

    def has_room(self, body: str, piece: Solid, others: Mapping[str, Solid]) -> bool:
        """Whether a body may have one piece more: it fits the bed, and stays apart from all other bodies."""
        return self.fits(body, piece) and self.is_apart(body, piece, others)

    def may_have(self, name: str, piece: Solid, made: Mapping[str, Solid], holes: Sequence[Solid] = ()) -> bool:
        """Whether a piece adds to a body, and there is room for what of it is not cut away again."""
        added = solids.cut(piece, [made[name], *holes])
        return not added.is_empty() and self.has_room(name, added, made)

    def is_spare(self, hole: Solid, name: str, panel: str, made: Mapping[str, Solid]) -> bool:
        """Whether a body may lose a hole to its hinge with a panel: no foot of another hinge, nor a third body."""
        hits_foot = (f.base == name and panel not in f.panels and _meet(solids.bounds(hole), f.box) for f in self._feet)
        others = (solid for other, solid in made.items() if other not in (name, panel))
        return not any(hits_foot) and not any(solids.overlap(hole, solid) > CLASH for solid in others)

    def is_thinner(self, name: str, solid: Solid, before: Solid, near: Box | None = None) -> bool:
        """Whether more of a body than before is walls thinner than a line, its ramps cut; what reaches `near` alone."""
        now, then = (thin_sides(solids.cut(one, self._ramps.get(name, [])), near) for one in (solid, before))
        return now > then

    def pocket(self, body: str, piece: Solid, name: str, other: Solid) -> Shape | None:
        """What another body would have to lose for a piece of a body to pass; None where it has a hinge there."""
        taken = self._passage.taken(body, piece, name, other)
        return pocket(other, self._planes[name], taken, self._gap, self._hinges(name)) if taken else None

    def _hinges(self, name: str) -> Iterator[Array]:
        """The corners (8, 3) of all that a pocket in a body has to leave: feet and knuckles."""
        yield from (box_corners(*foot.box) for foot in self._feet if foot.base == name)
        for joint in self._assembly.joints:
            if name in joint.parts:
                yield box_corners(joint.axis.min(0) - joint.radius, joint.axis.max(0) + joint.radius)

    def _on_bed(self, name: str, solid: Solid) -> Box:
        """Around a piece of a body as it stands on the bed."""
        pose = printed_pose(self._assembly, name)
        points = (solids.mesh(solid)[0] @ pose[:3, :3].T + pose[:3, 3]) @ self._turn.T
        return points.min(0), points.max(0)

    def _is_apart(self, body: str, piece: Solid, name: str, other: Solid, *, in_between: bool) -> bool:
        there, here = (printed_pose(self._assembly, each) for each in (name, body))
        if solids.gap(solids.moved(piece, seen_from(there, here)), other, self._gap) < GAP_SHARE * self._gap:
            return False
        return not self._passage.meets(body, piece, name, other, above=CLASH / 2, in_between=in_between)


def flaw(solid: Solid) -> str:
    """Why a solid cannot be a body, or nothing."""
    if solids.pieces(solid) != 1:
        return "falls apart"
    return "" if solids.stays_closed(solid) else "touches itself along an edge"


def beside(pieces: Iterable[Solid]) -> Box:
    """The box around pieces, and the walls beside them."""
    low, high = _around(solids.bounds(piece) for piece in pieces)
    return low - LINE, high + LINE


def _around(boxes: Iterable[Box]) -> Box:
    lows, highs = zip(*boxes, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def _meet(one: Box, other: Box) -> bool:
    return bool((one[0] < other[1]).all() and (other[0] < one[1]).all())


def _feet(assembly: Assembly) -> Iterator[Foot]:
    thickness = assembly.solution.thickness
    root = np.array([0.0, 0.0, ROOT_SHARE * thickness.panel])
    for chain in assembly.solution.chains:
        own = thickness.of(chain.panel)
        for end, base in enumerate((chain.anchor, chain.far)):
            if base is None:
                continue
            out, span = chain.rise * (1.0 if end == 0 else -1.0), tuple(map(float, chain.span))
            marks = knuckles(chain.hinge_spans[-end], own, chain.breaks).carrier if chain.pads[end] <= 0 else (span,)
            pad = max(chain.pads[end], 0.0)
            foot = axis_of(chain, end) - out * (own.axis_height + pad)
            for low, high in marks:
                side, top = chain.across * own.panel / 2, out * (pad + own.panel)
                corners = foot + np.array([chain.along * low - side, chain.along * high + side])
                corners = np.concatenate([corners, corners + top])
                yield Foot(base, chain.panels, (corners.min(0) - root, corners.max(0) + root))
