"""Which stops and latches there is room for: each is tried on the solids along the whole fold before it is made.

A piece is taken where its body stays one body, no gap as printed gets narrower than the clearance, nothing meets it at
any time once it has its pockets, what it is let into is not another hinge's foot, and the print still fits its bed.
What costs least is asked first.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.hinges import knuckles
from foldfab.fabrication.inspect import CLASH, GAP_SHARE, box_corners, instants
from foldfab.fabrication.latches import Lock, held_at, is_free
from foldfab.fabrication.model import Assembly, Joint, Latch
from foldfab.fabrication.mounts import Stop
from foldfab.fabrication.passing import Passage, seen_from
from foldfab.fabrication.places import places
from foldfab.fabrication.plates import ROOT_SHARE, axis_of
from foldfab.fabrication.pockets import pocket
from foldfab.fabrication.posture import needs_pins, printed_turn
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, cut, union
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.turning import PAST, meets, stops_at, turn
from foldfab.fabrication.walls import LINE, thin_sides
from foldfab.geometry.arrays import Array

ROUNDING = 0.01
"""By how much a print may seem to grow, mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """What a stop or a latch makes of a body."""

    is_added: bool
    """Whether there is more of it, or less."""
    shape: Shape


def changed(shape: Shape, changes: Iterable[Change]) -> Shape:
    """A body of that shape with all changes, in their order."""
    for change in changes:
        shape = union([shape, change.shape]) if change.is_added else cut(shape, [change.shape])
    return shape


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """A stop with the bodies that it changes: its two, and those in which it needs a pocket."""

    stop: Stop
    changed: dict[str, Solid]
    pockets: dict[str, Shape]


@dataclass(frozen=True, slots=True, eq=False)
class Latched:
    """What a pin that holds a hinge makes of its base, beside the stop that has the tongue."""

    base: Solid
    needs_seats: bool
    """Whether the base has to be given the seats of the pin."""
    latch: Latch


class Trial:
    """The bodies of a print as they stand, to try pieces on."""

    def __init__(
        self,
        assembly: Assembly,
        made: dict[str, Solid],
        ramps: Mapping[str, list[Shape]] = MappingProxyType({}),
        locks: Mapping[str, Lock] = MappingProxyType({}),
    ) -> None:
        """`ramps` is what will be cut from bodies once they have their stops, `locks` by joint their latches."""
        self.assembly, self.made, self.shapes = assembly, made, dict(assembly.shapes)
        self._plain = made
        self._passage = Passage(assembly.solution, instants(assembly))
        self.poses = self._passage.poses
        self._is_open = assembly.posture in ("open", "plate")
        self._turn = printed_turn(assembly)
        corners = [self._printed(name, solid) for name, solid in made.items()]
        self._extent = np.min([c[0] for c in corners], axis=0), np.max([c[1] for c in corners], axis=0)
        self._feet = list(_feet(assembly))
        self._planes = {place.name: place.plane for place in places(assembly.solution)}
        self.turns = {j.name: turn(j, *(self.poses[p] for p in j.parts)) for j in assembly.joints}
        self._ramps = {name: [printed(ramp) for ramp in some] for name, some in ramps.items()}
        self.locks = dict(locks)
        """By joint, the latch that it has."""
        self.changes: dict[str, list[Change]] = {name: [] for name in made}
        """By body, what stops and latches made of it, in their order."""
        self._parts = {j.name: j.parts for j in assembly.joints}

    def angle(self, joint: str, *, is_folded: bool) -> float | None:
        """How far past an end of its range a hinge turns as it stands, degrees."""
        return stops_at(self.turns[joint], *self._halves(joint), is_folded=is_folded)

    def is_prompt(self, joint: str, *, is_folded: bool, fitted: Fitted | None = None) -> bool:
        """Whether a hinge stops within `PAST` of an end of its range, as it stands or with a stop."""
        first, second = self._halves(joint, fitted)
        return meets(self.turns[joint], first, second, PAST, is_folded=is_folded)

    def fitted(self, stop: Stop) -> Fitted | None:
        """The bodies with a stop; None where a body would fall apart, or a third one or the bed is in its way."""
        if not self._fits(stop.body, printed(stop.added)) or (stop.cut is not None and self._is_taken(stop)):
            return None
        if stop.lip is not None and not self._has_room_for_lip(stop, stop.lip):
            return None
        pockets: dict[str, Shape] = {}
        for name in self.made:
            if name not in (stop.body, stop.other) and not self._is_clear(stop, {name: self.made[name]}):
                hole = self._pocket(stop, name)
                if hole is None:
                    return None
                pockets[name] = hole
        changed = self._with(stop, pockets)
        if changed is None or not self._is_clear(stop, {name: changed[name] for name in pockets}):
            return None
        return Fitted(stop, changed, pockets)

    def has_room(self, fitted: Fitted) -> bool:
        """Whether a stop stays apart from what it stops against along the whole fold, and leaves no thin wall."""
        stop, changed = fitted.stop, fitted.changed
        if not self._is_clear(stop, {stop.other: changed[stop.other]}):
            return False
        # What lies between two holes may be too thin to be printed.
        mine = _around([printed(shape) for shape in (stop.added, stop.lip, stop.cut) if shape is not None])
        near = {name: _around([printed(hole)]) for name, hole in fitted.pockets.items()}
        return all(
            self._thin_sides(name, solid, near.get(name, mine))
            <= self._thin_sides(name, self._plain[name], near.get(name, mine))
            for name, solid in changed.items()
        ) and not any(self._unstopped(name, changed[name]) for name in fitted.pockets)

    def soonest(self, late: Sequence[Fitted]) -> Fitted | None:
        """Of stops that work beyond `PAST`, the one that works first and has room; None where none does better."""
        if not late:
            return None
        joint, is_folded = late[0].stop.joint, late[0].stop.is_folded
        before = self.angle(joint, is_folded=is_folded)
        angles = [stops_at(self.turns[joint], *self._halves(joint, one), is_folded=is_folded) for one in late]
        better = [
            (angle, n) for n, angle in enumerate(angles) if angle is not None and (before is None or angle < before)
        ]
        return next((late[n] for _, n in sorted(better) if self.has_room(late[n])), None)

    def take(self, fitted: Fitted) -> None:
        """Makes a stop."""
        stop = fitted.stop
        self._change(stop.body, Change(True, stop.added))
        if stop.lip is not None:
            self._change(stop.other, Change(True, stop.lip))
        if stop.cut is not None:
            self._change(stop.other, Change(False, stop.cut))
        for name, hole in fitted.pockets.items():
            self._change(name, Change(False, hole))
        for name, solid in fitted.changed.items():
            self._make(name, solid)

    def reshape(self, name: str, shape: Shape) -> str:
        """Makes a body of another shape, or says why it cannot be: then it stays as it is."""
        solid = solids.tidied(printed(shape))
        problem = self._problem(name, solid)
        if not problem:
            self.shapes[name] = shape
            self._make(name, solid)
        return problem

    def _make(self, name: str, solid: Solid) -> None:
        self.made = {**self.made, name: solid}
        low, high = self._printed(name, solid)
        self._extent = np.minimum(low, self._extent[0]), np.maximum(high, self._extent[1])

    def _change(self, name: str, change: Change) -> None:
        self.changes[name].append(change)
        self.shapes[name] = changed(self.shapes[name], [change])

    def _problem(self, name: str, solid: Solid) -> str:
        """Why a body cannot become another solid, or nothing."""
        if solids.pieces(solid) != 1:
            return "falls apart"
        if not solids.stays_closed(solid):
            return "touches itself along an edge"
        if self._thin_sides(name, solid) > self._thin_sides(name, self.made[name]):
            return "has walls thinner than a line"
        if not self._fits(name, solid):
            return "does not fit the bed"
        for other in self.made:
            # The room that it fills was looked for between the instants as well.
            if other != name and not self._is_apart(name, solid, other, self.made[other], in_between=False):
                return f"meets {other}"
        return self._unstopped(name, solid) or self._unlatched({name: solid})

    def _unstopped(self, name: str, solid: Solid) -> str:
        """That a hinge of a body would stop no more, or nothing."""
        for joint in self._hinges_of(name):
            first, second = (solid if part == name else self.made[part] for part in joint.parts)
            for is_folded in (False, True):
                was = self.is_prompt(joint.name, is_folded=is_folded)
                if was and not meets(self.turns[joint.name], first, second, PAST, is_folded=is_folded):
                    return f"leaves {joint.name} without a stop"
        return ""

    def _unlatched(self, changed: Mapping[str, Solid]) -> str:
        """That a latch would not hold any more with other bodies, or nothing."""
        made = {**self.made, **changed}
        for joint, held in self.locks.items():
            base = self._base_of(joint)
            is_held = is_free(changed.values(), held)
            if is_held and {*self._parts[joint]} & {*changed}:
                is_held = self._missing(made[base], held) <= CLASH and self._play(joint, held, made) is not None
            if not is_held:
                return f"leaves {joint} without a latch"
        return ""

    def hinges(self, name: str) -> list[Array]:
        """The corners (8, 3) of all that a pocket in a body has to leave: knuckles and feet."""
        boxes = [(low, high) for base, _, low, high in self._feet if base == name]
        boxes += [(j.axis.min(0) - j.radius, j.axis.max(0) + j.radius) for j in self._hinges_of(name)]
        return [box_corners(low, high) for low, high in boxes]

    def latched(self, fitted: Fitted) -> Latched | None:
        """What a pin makes of the base of a stop, made or not; None where it has no room or does not hold."""
        stop = fitted.stop
        held, made = stop.lock, {**self.made, **fitted.changed}
        if held is None:
            return None
        base = made[stop.other]
        needs_seats = self._missing(base, held) > CLASH
        if needs_seats:
            if not self._has_room_for_seats(stop, held, made):
                return None
            base = solids.union([base, printed(held.seats)])
        base = solids.tidied(solids.cut(base, [printed(held.groove)]))
        made[stop.other] = base
        if solids.pieces(base) != 1 or not solids.stays_closed(base) or self._unstopped(stop.other, base):
            return None
        if self._thin_sides(stop.other, base) > self._thin_sides(stop.other, fitted.changed.get(stop.other, base)):
            return None
        angle = self._play(stop.joint, held, made)
        if angle is None or self._unlatched({**fitted.changed, stop.other: base}):
            return None
        (start, end), into = held.ends.tolist(), held.into.tolist()
        latch = Latch(stop.other, (tuple(start), tuple(end)), tuple(into), angle, held.moment)
        return Latched(base, needs_seats, latch)

    def lock(self, stop: Stop, made: Latched) -> None:
        """Makes the latch of a stop that is made."""
        assert stop.lock is not None
        if made.needs_seats:
            self._change(stop.other, Change(True, stop.lock.seats))
        self._change(stop.other, Change(False, stop.lock.groove))
        self._make(stop.other, made.base)
        self.locks[stop.joint] = stop.lock

    def _play(self, joint: str, held: Lock, made: Mapping[str, Solid]) -> float | None:
        """How far a hinge turns from open before its pin holds it, degrees; None where it does not, or has no room."""
        base = self._base_of(joint)
        panel = next(part for part in self._parts[joint] if part != base)
        if not is_free(made.values(), held):
            return None
        return held_at(self.turns[joint], made[panel], held, is_base_first=self._parts[joint][0] == base)

    def _base_of(self, joint: str) -> str:
        bases = {base for base, *_ in self._feet}
        return next(part for part in self._parts[joint] if part in bases)

    def _missing(self, base: Solid, held: Lock) -> float:
        """How much of what has to be of a base beside a groove, cut or not, is not, mm³."""
        return float(solids.cut(printed(held.seats), [base, printed(held.groove)]).volume())

    def _has_room_for_seats(self, stop: Stop, held: Lock, made: Mapping[str, Solid]) -> bool:
        """Whether nothing meets the seats that a base is given along the whole fold."""
        added = solids.cut(printed(held.seats), [made[stop.other]])
        return self._fits(stop.other, added) and all(
            self._is_apart(stop.other, added, name, other) for name, other in made.items() if name != stop.other
        )

    def _halves(self, joint: str, fitted: Fitted | None = None) -> tuple[Solid, Solid]:
        made = self.made if fitted is None else {**self.made, **fitted.changed}
        first, second = self._parts[joint]
        return made[first], made[second]

    def _pocket(self, stop: Stop, name: str) -> Shape | None:
        """What is to be cut from a third body for a stop to pass; None where there is no room for it."""
        other, gap = self.made[name], self.assembly.solution.thickness.gap
        taken = self._passage.taken(stop.body, printed(stop.added), name, other)
        return pocket(other, self._planes[name], taken, gap, self.hinges(name)) if taken else None

    def _hinges_of(self, name: str) -> list[Joint]:
        return [joint for joint in self.assembly.joints if name in joint.parts]

    def _with(self, stop: Stop, pockets: Mapping[str, Shape]) -> dict[str, Solid] | None:
        """The bodies with a stop; None where one of them would fall apart."""
        body = solids.union([self.made[stop.body], printed(stop.added)])
        other = self.made[stop.other]
        other = other if stop.lip is None else solids.union([other, printed(stop.lip)])
        other = other if stop.cut is None else solids.cut(other, [printed(stop.cut)])
        bored = {name: solids.cut(self.made[name], [printed(hole)]) for name, hole in pockets.items()}
        changed = {name: solids.tidied(solid) for name, solid in {stop.body: body, stop.other: other, **bored}.items()}
        return changed if all(solids.pieces(s) == 1 and solids.stays_closed(s) for s in changed.values()) else None

    def _thin_sides(self, name: str, solid: Solid, near: tuple[Array, Array] | None = None) -> int:
        return thin_sides(solids.cut(solid, self._ramps.get(name, [])), near)

    def _is_clear(self, stop: Stop, others: Mapping[str, Solid]) -> bool:
        """Whether nothing meets the material of a stop along the whole fold."""
        added = printed(stop.added)
        return all(self._is_apart(stop.body, added, name, solid) for name, solid in others.items())

    def _has_room_for_lip(self, stop: Stop, lip: Shape) -> bool:
        """Whether a lip adds to its base, and nothing meets what of it is left beside its slot along the whole fold."""
        holes = [] if stop.cut is None else [printed(stop.cut)]
        added = solids.cut(printed(lip), [self.made[stop.other], *holes])
        if added.is_empty() or not self._fits(stop.other, added):
            return False
        return all(
            self._is_apart(stop.other, added, name, other) for name, other in self.made.items() if name != stop.other
        )

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
        return any(name not in mine and solids.overlap(hole, solid) > CLASH for name, solid in self.made.items())

    def _fits(self, name: str, added: Solid) -> bool:
        """Whether the print, which may fit its bed just so, still fits it with a piece of a body."""
        if needs_pins(self.assembly.posture):
            return True
        bed = np.array(self.assembly.solution.scaffold.recipe.print.printer.build_volume)
        low, high = self._printed(name, added)
        low, high = np.minimum(low, self._extent[0]), np.maximum(high, self._extent[1])
        size, now = high - low, self._extent[1] - self._extent[0]
        return bool((size <= bed).all() or (size[[1, 0, 2]] <= bed).all() or (size <= now + ROUNDING).all())

    def _printed(self, name: str, solid: Solid) -> tuple[Array, Array]:
        """Corners (3,) of a piece of a body as it stands on the bed."""
        pose = self.poses[name][0 if self._is_open else -1]
        points = (solids.mesh(solid)[0] @ pose[:3, :3].T + pose[:3, 3]) @ self._turn.T
        return points.min(0), points.max(0)

    def _is_apart(self, body: str, added: Solid, name: str, other: Solid, *, in_between: bool = True) -> bool:
        """Whether a piece of a body stays apart from another body all along the fold."""
        clearance = self.assembly.solution.thickness.gap
        key = 0 if self._is_open else -1
        piece = solids.moved(added, seen_from(self.poses[name][key], self.poses[body][key]))
        if solids.gap(piece, other, clearance) < GAP_SHARE * clearance:
            return False
        return not self._passage.meets(body, added, name, other, above=CLASH / 2, in_between=in_between)


def _around(pieces: list[Solid]) -> tuple[Array, Array]:
    """The box around pieces, and the walls beside them."""
    corners = [solids.bounds(piece) for piece in pieces]
    return np.min([c[0] for c in corners], axis=0) - LINE, np.max([c[1] for c in corners], axis=0) + LINE


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
            marks = knuckles(chain.hinge_spans[-end], own, chain.breaks).carrier if chain.pads[end] <= 0 else (span,)
            pad = max(chain.pads[end], 0.0)
            foot = axis_of(chain, end) - out * (own.axis_height + pad)
            for low, high in marks:
                side, top = chain.across * own.panel / 2, out * (pad + own.panel)
                corners = foot + np.array([chain.along * low - side, chain.along * high + side])
                corners = np.concatenate([corners, corners + top])
                yield base, chain.panels, corners.min(0) - root, corners.max(0) + root
