"""Which stops and shapes the bodies of a print can have: each is tried on the solids before it is made.

A piece is taken where its body stays one body, the `judge` has room for it once it has its pockets, and every hinge
that stops in time, or is held, does so afterwards. What costs least is asked first.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from foldfab.fabrication import solids
from foldfab.fabrication.halves import angle_of, hinges_of, is_prompt, unlatched, unstopped
from foldfab.fabrication.judge import Judge, beside, flaw
from foldfab.fabrication.latches import Lock
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.mounts import Stop
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, cut, union
from foldfab.fabrication.solids import Solid


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
        self.hinges = hinges_of(assembly, self.judge.poses)
        self.locks = dict(locks)
        """By joint, the latch that it has."""
        self.changes: dict[str, list[Change]] = {name: [] for name in made}
        """By body, what stops and latches made of it, in their order."""

    def is_prompt(self, joint: str, *, is_folded: bool, fitted: Fitted | None = None) -> bool:
        """Whether a hinge stops within `PAST` of an end of its range, as it stands or with a stop."""
        made = {**self.made, **fitted.changed} if fitted else self.made
        return is_prompt(self.hinges, joint, made, is_folded=is_folded)

    def fitted(self, stop: Stop) -> Fitted | None:
        """The bodies with a stop; None where a body would fall apart, or a third one or the bed is in its way."""
        added, holes = printed(stop.added), [] if stop.cut is None else [printed(stop.cut)]
        if not self.judge.fits(stop.body, added):
            return None
        if not all(self.judge.is_spare(hole, stop.other, stop.body, self.made) for hole in holes):
            return None
        if stop.lip is not None and not self.judge.may_have(stop.other, printed(stop.lip), self.made, holes):
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
        return not any(unstopped(self.hinges, self.made, name, changed[name]) for name in fitted.pockets)

    def soonest(self, late: Sequence[Fitted]) -> Fitted | None:
        """Of stops that work beyond `PAST`, the one that works first and has room; None where none does better."""
        if not late:
            return None
        ways = ({}, *(one.changed for one in late))
        before, *angles = [angle_of(self.hinges, late[0].stop, {**self.made, **changed}) for changed in ways]
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
        if unstopped(self.hinges, self.made, name, solid):
            return False
        self.alter(name, [Change(False, hole) for hole in holes], solid)
        return True

    def alter(self, name: str, changes: Iterable[Change], solid: Solid) -> None:
        """Makes changes to a body, which make that solid of it."""
        for change in changes:
            self._change(name, change)
        self._make(name, solid)

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
            found[name] = applied(found[name], change)
        return {name: solids.tidied(solid) for name, solid in found.items()}

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
        problem = unstopped(self.hinges, self.made, name, solid)
        return problem or unlatched(self.hinges, self.locks, self.made, {name: solid})


def _changes(stop: Stop, pockets: Mapping[str, Shape]) -> Iterator[tuple[str, Change]]:
    """All that a stop and its pockets make of bodies, by their names."""
    yield stop.body, Change(True, stop.added)
    if stop.lip is not None:
        yield stop.other, Change(True, stop.lip)
    if stop.cut is not None:
        yield stop.other, Change(False, stop.cut)
    for name, hole in pockets.items():
        yield name, Change(False, hole)


def applied(solid: Solid, change: Change) -> Solid:
    """A body after a change."""
    piece = printed(change.shape)
    return solids.union([solid, piece]) if change.is_added else solids.cut(solid, [piece])
