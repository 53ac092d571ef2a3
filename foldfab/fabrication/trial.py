"""Which stops, latches and shapes the bodies of a print can have: each is tried on the solids before it is made.

A piece is taken where its body stays one body, the `judge` has room for it once it has its pockets, and every hinge
that stops in time, or is held, does so afterwards. What costs least is asked first.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from foldfab.fabrication import solids
from foldfab.fabrication.judge import Judge, beside, flaw
from foldfab.fabrication.latches import Lock, held_at, is_free, is_seated
from foldfab.fabrication.model import Assembly, Latch
from foldfab.fabrication.mounts import Stop
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, cut, union
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.turning import PAST, meets, stops_at, turns


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
    changes: tuple[Change, ...]
    """Those of the base: its seats, where it lacks them, and its groove."""
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
        self.judge = Judge(assembly, made, ramps)
        self.turns = turns(assembly.joints, self.judge.poses)
        self.locks = dict(locks)
        """By joint, the latch that it has."""
        self.changes: dict[str, list[Change]] = {name: [] for name in made}
        """By body, what stops and latches made of it, in their order."""
        self._parts = {j.name: j.parts for j in assembly.joints}
        self._bases = {base.name for base in assembly.solution.scaffold.bases}

    def is_prompt(self, joint: str, *, is_folded: bool, fitted: Fitted | None = None) -> bool:
        """Whether a hinge stops within `PAST` of an end of its range, as it stands or with a stop."""
        first, second = self._halves(joint, fitted.changed if fitted else {})
        return meets(self.turns[joint], first, second, PAST, is_folded=is_folded)

    def fitted(self, stop: Stop) -> Fitted | None:
        """The bodies with a stop; None where a body would fall apart, or a third one or the bed is in its way."""
        added, holes = printed(stop.added), [] if stop.cut is None else [printed(stop.cut)]
        if not self.judge.fits(stop.body, added):
            return None
        if not all(self.judge.is_spare(hole, stop.other, stop.body, self.made) for hole in holes):
            return None
        if stop.lip is not None and not self._has_room_for(stop.other, stop.lip, self.made, holes):
            return None
        pockets: dict[str, Shape] = {}
        thirds = {name: solid for name, solid in self.made.items() if name != stop.other}
        for name in self.judge.met(stop.body, added, thirds):
            hole = self.judge.pocket(stop.body, added, name, self.made[name])
            if hole is None:
                return None
            pockets[name] = hole
        changed = self._with(stop, pockets)
        if any(map(flaw, changed.values())):
            return None
        if not self.judge.is_apart(stop.body, added, {name: changed[name] for name in pockets}):
            return None
        return Fitted(stop, changed, pockets)

    def has_room(self, fitted: Fitted) -> bool:
        """Whether a stop stays apart from what it stops against along the whole fold, and leaves no thin wall."""
        stop, changed = fitted.stop, fitted.changed
        if not self.judge.is_apart(stop.body, printed(stop.added), {stop.other: changed[stop.other]}):
            return False
        # What lies between two holes may be too thin to be printed.
        mine = beside(printed(shape) for shape in (stop.added, stop.lip, stop.cut) if shape is not None)
        near = {name: beside([printed(hole)]) for name, hole in fitted.pockets.items()}
        if any(self.judge.is_thinner(n, solid, self._plain[n], near.get(n, mine)) for n, solid in changed.items()):
            return False
        return not any(self._unstopped(name, changed[name]) for name in fitted.pockets)

    def soonest(self, late: Sequence[Fitted]) -> Fitted | None:
        """Of stops that work beyond `PAST`, the one that works first and has room; None where none does better."""
        if not late:
            return None
        before, *angles = [self._angle(late[0].stop, changed) for changed in ({}, *(one.changed for one in late))]
        better = [
            (angle, n) for n, angle in enumerate(angles) if angle is not None and (before is None or angle < before)
        ]
        return next((late[n] for _, n in sorted(better) if self.has_room(late[n])), None)

    def take(self, fitted: Fitted) -> None:
        """Makes a stop."""
        for name, change in _changes(fitted.stop, fitted.pockets):
            self._change(name, change)
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

    def trim(self, name: str, holes: Sequence[Shape]) -> bool:
        """Takes holes from a body; not where it would be less sound, or a hinge would stop no more as it did."""
        cutters = [printed(hole) for hole in holes]
        solid = solids.tidied(solids.cut(self.made[name], cutters))
        if flaw(solid) or self.judge.is_thinner(name, solid, self.made[name], beside(cutters)):
            return False
        if self._unstopped(name, solid):
            return False
        for hole in holes:
            self._change(name, Change(False, hole))
        self._make(name, solid)
        return True

    def latched(self, fitted: Fitted) -> Latched | None:
        """What a pin makes of the base of a stop, made or not; None where it has no room or does not hold."""
        stop = fitted.stop
        held, made = stop.lock, {**self.made, **fitted.changed}
        if held is None:
            return None
        seats = () if is_seated(made[stop.other], held) else (Change(True, held.seats),)
        if seats and not self._has_room_for(stop.other, held.seats, made):
            return None
        changes = (*seats, Change(False, held.groove))
        base = solids.tidied(functools.reduce(_applied, changes, made[stop.other]))
        if flaw(base) or self._unstopped(stop.other, base):
            return None
        if self.judge.is_thinner(stop.other, base, made[stop.other]):
            return None
        made[stop.other] = base
        angle = self._play(stop.joint, held, made)
        if angle is None or self._unlatched({**fitted.changed, stop.other: base}):
            return None
        (start, end), into = held.ends.tolist(), held.into.tolist()
        latch = Latch(stop.other, (tuple(start), tuple(end)), tuple(into), angle, held.moment)
        return Latched(base, changes, latch)

    def lock(self, stop: Stop, made: Latched) -> None:
        """Makes the latch of a stop that is made."""
        assert stop.lock is not None
        for change in made.changes:
            self._change(stop.other, change)
        self._make(stop.other, made.base)
        self.locks[stop.joint] = stop.lock

    def _make(self, name: str, solid: Solid) -> None:
        self.made = {**self.made, name: solid}
        self.judge.accept(name, solid)

    def _change(self, name: str, change: Change) -> None:
        self.changes[name].append(change)
        self.shapes[name] = changed(self.shapes[name], [change])

    def _with(self, stop: Stop, pockets: Mapping[str, Shape]) -> dict[str, Solid]:
        """The bodies that a stop changes, with it."""
        found = {name: self.made[name] for name in (stop.body, stop.other, *pockets)}
        for name, change in _changes(stop, pockets):
            found[name] = _applied(found[name], change)
        return {name: solids.tidied(solid) for name, solid in found.items()}

    def _has_room_for(self, name: str, piece: Shape, made: Mapping[str, Solid], holes: Sequence[Solid] = ()) -> bool:
        """Whether a piece adds to a body, and there is room for what of it is not cut away again."""
        added = solids.cut(printed(piece), [made[name], *holes])
        return not added.is_empty() and self.judge.has_room(name, added, made)

    def _problem(self, name: str, solid: Solid) -> str:
        """Why a body cannot become another solid, or nothing."""
        problem = flaw(solid)
        if problem:
            return problem
        if self.judge.is_thinner(name, solid, self.made[name]):
            return "has walls thinner than a line"
        if not self.judge.fits(name, solid):
            return "does not fit the bed"
        # The room that it fills was looked for between the instants as well.
        for other in self.judge.met(name, solid, self.made, in_between=False):
            return f"meets {other}"
        return self._unstopped(name, solid) or self._unlatched({name: solid})

    def _unstopped(self, name: str, solid: Solid) -> str:
        """That a hinge of a body would stop no more, or nothing."""
        for joint, parts in self._parts.items():
            for is_folded in (False, True) if name in parts else ():
                halves = self._halves(joint, {name: solid})
                was = self.is_prompt(joint, is_folded=is_folded)
                if was and not meets(self.turns[joint], *halves, PAST, is_folded=is_folded):
                    return f"leaves {joint} without a stop"
        return ""

    def _unlatched(self, changed: Mapping[str, Solid]) -> str:
        """That a latch would not hold any more with other bodies, or nothing."""
        made = {**self.made, **changed}
        for joint, held in self.locks.items():
            is_held = is_free(changed.values(), held)
            if is_held and {*self._parts[joint]} & {*changed}:
                base, _ = self._leaf(joint)
                is_held = is_seated(made[base], held) and self._play(joint, held, made) is not None
            if not is_held:
                return f"leaves {joint} without a latch"
        return ""

    def _play(self, joint: str, held: Lock, made: Mapping[str, Solid]) -> float | None:
        """How far a hinge turns from open before its pin holds it, degrees; None where it does not, or has no room."""
        if not is_free(made.values(), held):
            return None
        base, panel = self._leaf(joint)
        return held_at(self.turns[joint], made[panel], held, is_base_first=self._parts[joint][0] == base)

    def _leaf(self, joint: str) -> tuple[str, str]:
        """The base of a base hinge, and the panel that it holds."""
        first, second = self._parts[joint]
        return (first, second) if first in self._bases else (second, first)

    def _angle(self, stop: Stop, changed: Mapping[str, Solid]) -> float | None:
        """How far past an end of its range a hinge turns with other bodies, degrees."""
        first, second = self._halves(stop.joint, changed)
        return stops_at(self.turns[stop.joint], first, second, is_folded=stop.is_folded)

    def _halves(self, joint: str, changed: Mapping[str, Solid]) -> tuple[Solid, Solid]:
        """The two bodies of a hinge, with other ones in their place."""
        made = {**self.made, **changed}
        first, second = self._parts[joint]
        return made[first], made[second]


def _changes(stop: Stop, pockets: Mapping[str, Shape]) -> Iterator[tuple[str, Change]]:
    """All that a stop and its pockets make of bodies, by their names."""
    yield stop.body, Change(True, stop.added)
    if stop.lip is not None:
        yield stop.other, Change(True, stop.lip)
    if stop.cut is not None:
        yield stop.other, Change(False, stop.cut)
    for name, hole in pockets.items():
        yield name, Change(False, hole)


def _applied(solid: Solid, change: Change) -> Solid:
    piece = printed(change.shape)
    return solids.union([solid, piece]) if change.is_added else solids.cut(solid, [piece])
