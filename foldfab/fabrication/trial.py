"""Which stops and latches there is room for: each is tried on the solids along the whole fold before it is made.

A piece is taken where its body stays one body, no gap as printed gets narrower than the clearance, nothing meets it at
any instant, what it is let into is not another hinge's foot, and the print still fits its bed. Costs a boolean for each
instant at which the piece is near another body.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.hinges import knuckles
from foldfab.fabrication.inspect import CLASH, GAP_SHARE, STILL, instants
from foldfab.fabrication.latches import tried
from foldfab.fabrication.model import Assembly, Latch
from foldfab.fabrication.plates import ROOT_SHARE, axis_of
from foldfab.fabrication.posture import needs_pins, printed_turn
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import cut, union
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.stops import Stop
from foldfab.fabrication.turning import Turn, stops_at, turn
from foldfab.fabrication.walls import thin_sides
from foldfab.folding.kinematics import configuration
from foldfab.geometry.arrays import Array, Bools

ROUNDING = 0.01
"""By how much a print may seem to grow, mm."""


class Trial:
    """The bodies of a print as they stand, to try pieces on."""

    def __init__(
        self, assembly: Assembly, made: dict[str, Solid], ramps: Mapping[str, list[Solid]] = MappingProxyType({})
    ) -> None:
        """`ramps` is what will be cut from bodies once they have their stops."""
        self.assembly, self.made, self.shapes = assembly, made, dict(assembly.shapes)
        self.poses = configuration(assembly.solution, instants(assembly))
        self._bounds = {name: self._along(name, solid) for name, solid in made.items()}
        self._is_open = assembly.posture in ("open", "plate")
        self._turn = printed_turn(assembly)
        corners = [self._printed(name, solid) for name, solid in made.items()]
        self._extent = np.min([c[0] for c in corners], axis=0), np.max([c[1] for c in corners], axis=0)
        self._feet = list(_feet(assembly))
        self.turns = {j.name: turn(j, *(self.poses[p] for p in j.parts)) for j in assembly.joints}
        self._ramps = ramps
        self._thin = {name: self._thin_sides(name, solid) for name, solid in made.items()}
        self.gives: dict[str, list[Solid]] = {}
        """By panel, what of it gives way while it passes its latches."""
        self._parts = {j.name: j.parts for j in assembly.joints}

    def angle(self, joint: str, *, is_folded: bool) -> float | None:
        """How far past an end of its range a hinge turns as it stands, degrees."""
        return self._angle(joint, self.made, is_folded)

    def better(self, stop: Stop) -> float | None:
        """The angle at which a stop would work, where there is room for it and it does better than what is there."""
        made = self._with(stop)
        if made is None:
            return None
        before = self.angle(stop.joint, is_folded=stop.is_folded)
        after = self._angle(stop.joint, made, stop.is_folded)
        if after is None or (before is not None and after >= before) or not self._has_room(stop, made):
            return None
        # What lies between two holes may be too thin to be printed.
        return None if any(self._thin_sides(n, made[n]) > self._thin[n] for n in (stop.body, stop.other)) else after

    def _thin_sides(self, name: str, solid: Solid) -> int:
        return thin_sides(solids.cut(solid, self._ramps.get(name, [])))

    def take(self, stop: Stop) -> None:
        """Makes a stop."""
        made = self._with(stop)
        assert made is not None
        self.made = made
        self.shapes[stop.body] = union([self.shapes[stop.body], stop.added])
        if stop.cut is not None:
            self.shapes[stop.other] = cut(self.shapes[stop.other], [stop.cut])
        for name in (stop.body, stop.other):
            self._bounds[name] = self._along(name, made[name])
            low, high = self._printed(name, made[name])
            self._extent = np.minimum(low, self._extent[0]), np.maximum(high, self._extent[1])

    def latch(self, stop: Stop) -> Latch | None:
        """Makes the latch of a stop that is made, where it holds and lets go."""
        if stop.detent is None:
            return None
        panel = solids.tidied(solids.cut(self.made[stop.body], [printed(stop.detent.slit)]))
        base = solids.tidied(solids.union([self.made[stop.other], printed(stop.detent.ridges)]))
        if not all(solids.pieces(s) == 1 and solids.stays_closed(s) for s in (panel, base)):
            return None
        is_base_first = self._parts[stop.joint][0] == stop.other
        found = tried(self.turns[stop.joint], base, panel, stop.detent, is_base_first=is_base_first)
        if found is not None:
            self.made = {**self.made, stop.body: panel, stop.other: base}
            self.shapes[stop.body] = cut(self.shapes[stop.body], [stop.detent.slit])
            self.shapes[stop.other] = union([self.shapes[stop.other], stop.detent.ridges])
            self.gives.setdefault(stop.body, []).append(printed(stop.detent.pressed))
        return found

    def _angle(self, joint: str, made: dict[str, Solid], is_folded: bool) -> float | None:
        first, second = self._parts[joint]
        range_: Turn = self.turns[joint]
        return stops_at(range_, made[first], made[second], is_folded=is_folded)

    def _with(self, stop: Stop) -> dict[str, Solid] | None:
        """The bodies with a stop; None where one of them would fall apart."""
        made = {**self.made, stop.body: solids.tidied(solids.union([self.made[stop.body], printed(stop.added)]))}
        if stop.cut is not None:
            made[stop.other] = solids.tidied(solids.cut(made[stop.other], [printed(stop.cut)]))
        changed = [made[name] for name in (stop.body, stop.other)]
        return made if all(solids.pieces(s) == 1 and solids.stays_closed(s) for s in changed) else None

    def _has_room(self, stop: Stop, made: dict[str, Solid]) -> bool:
        if stop.cut is not None and self._is_taken(stop):
            return False
        if not self._fits(stop):
            return False
        added = printed(stop.added)
        reach = self._along(stop.body, added)
        others = [name for name in made if name != stop.body]
        return all(self._is_apart(stop.body, added, name, made[name], reach) for name in others)

    def _is_taken(self, stop: Stop) -> bool:
        """Whether what is cut away is, or holds, something else."""
        assert stop.cut is not None
        hole = printed(stop.cut)
        low, high = solids.bounds(hole)
        mine = self._parts[stop.joint]
        for base, chain_panels, foot_low, foot_high in self._feet:
            is_own = bool({*mine} & {*chain_panels}) and base in mine
            if base == stop.other and not is_own and bool((low < foot_high).all() and (foot_low < high).all()):
                return True
        for name, solid in self.made.items():
            if name in mine or not _near(self._bounds[name], (low[None], high[None]), 0.0)[0]:
                continue
            if solids.overlap(hole, solid) > CLASH:
                return True
        return False

    def _fits(self, stop: Stop) -> bool:
        """Whether the print, which may fit its bed just so, still fits it."""
        if needs_pins(self.assembly.posture):
            return True
        bed = np.array(self.assembly.solution.scaffold.recipe.print.printer.build_volume)
        low, high = self._printed(stop.body, printed(stop.added))
        low, high = np.minimum(low, self._extent[0]), np.maximum(high, self._extent[1])
        size, now = high - low, self._extent[1] - self._extent[0]
        return bool((size <= bed).all() or (size[[1, 0, 2]] <= bed).all() or (size <= now + ROUNDING).all())

    def _printed(self, name: str, solid: Solid) -> tuple[Array, Array]:
        """Corners (3,) of a piece of a body as it stands on the bed."""
        pose = self.poses[name][0 if self._is_open else -1]
        points = (solids.mesh(solid)[0] @ pose[:3, :3].T + pose[:3, 3]) @ self._turn.T
        return points.min(0), points.max(0)

    def _is_apart(self, body: str, added: Solid, name: str, other: Solid, reach: tuple[Array, Array]) -> bool:
        """Whether a piece of a body stays apart from another body all along the fold."""
        clearance = self.assembly.solution.thickness.gap
        key = 0 if self._is_open else -1
        near = _near(reach, self._bounds[name], clearance)
        if near[key]:
            piece = solids.moved(added, self._relative(name, body, key))
            if solids.gap(piece, other, clearance) < GAP_SHARE * clearance:
                return False
        last: Array | None = None
        for k in np.nonzero(near)[0]:
            relative = self._relative(name, body, int(k))
            if last is not None and np.abs(last - relative).max() < STILL:
                continue
            last = relative
            if solids.overlap(other, solids.moved(added, relative)) > CLASH / 2:
                return False
        return True

    def _relative(self, name: str, body: str, key: int) -> Array:
        pose: Array = np.linalg.inv(self.poses[name][key]) @ self.poses[body][key]
        return pose

    def _along(self, name: str, solid: Solid) -> tuple[Array, Array]:
        """Lower and upper corners (k, 3) of a piece of a body all along the fold."""
        low, high = solids.bounds(solid)
        pose = self.poses[name]
        center = pose[:, :3, :3] @ ((low + high) / 2) + pose[:, :3, 3]
        half = np.abs(pose[:, :3, :3]) @ ((high - low) / 2)
        return center - half, center + half


def _near(a: tuple[Array, Array], b: tuple[Array, Array], gap: float) -> Bools:
    near = (a[0] <= b[1] + gap) & (b[0] <= a[1] + gap)
    found: Bools = np.all(near, axis=1)
    return found


def _feet(assembly: Assembly) -> Iterator[tuple[str, tuple[str, ...], Array, Array]]:
    """By foot or plinth: its base, the panels of its chain, and its corners (3,) with its root in the plate."""
    thickness = assembly.solution.thickness
    root = np.array([0.0, 0.0, ROOT_SHARE * thickness.panel])
    for chain in assembly.solution.chains:
        own = thickness.of(chain.panel)
        for end, base in enumerate((chain.anchor, chain.far)):
            if base is None:
                continue
            out, span = chain.rise * (1.0 if end == 0 else -1.0), tuple(map(float, chain.span))
            marks = knuckles(chain.hinge_spans[-end], own, chain.breaks).carrier if chain.pads[end] == 0 else (span,)
            foot = axis_of(chain, end) - out * (own.axis_height + chain.pads[end])
            for low, high in marks:
                side, top = chain.across * own.panel / 2, out * (chain.pads[end] + own.panel)
                corners = foot + np.array([chain.along * low - side, chain.along * high + side])
                corners = np.concatenate([corners, corners + top])
                yield base, chain.panels, corners.min(0) - root, corners.max(0) + root
