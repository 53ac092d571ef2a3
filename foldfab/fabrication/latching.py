"""Latches tried on the solids: what a pin takes of its base is made where it has room, and holds.

A pin needs a stop with a tongue; its seats are added to the base where it lacks them, and its groove is cut. Every
hinge still stops as it did, and every latch that was made still holds.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

from foldfab.fabrication import solids
from foldfab.fabrication.halves import play, unlatched, unstopped
from foldfab.fabrication.judge import flaw
from foldfab.fabrication.latches import is_seated
from foldfab.fabrication.model import Latch
from foldfab.fabrication.mounts import Stop
from foldfab.fabrication.printed import printed
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.trial import Change, Fitted, Trial, applied


@dataclass(frozen=True, slots=True, eq=False)
class Latched:
    """What a pin that holds a hinge makes of its base, beside the stop that has the tongue."""

    base: Solid
    changes: tuple[Change, ...]
    """Those of the base: its seats, where it lacks them, and its groove."""
    latch: Latch


def latched(trial: Trial, fitted: Fitted) -> Latched | None:
    """What a pin makes of the base of a stop, made or not; None where it has no room or does not hold."""
    stop = fitted.stop
    held, made = stop.lock, {**trial.made, **fitted.changed}
    if held is None:
        return None
    seats = () if is_seated(made[stop.other], held) else (Change(True, held.seats),)
    if seats and not trial.judge.may_have(stop.other, printed(held.seats), made):
        return None
    changes = (*seats, Change(False, held.groove))
    base = solids.tidied(functools.reduce(applied, changes, made[stop.other]))
    if flaw(base) or unstopped(trial.hinges, trial.made, stop.other, base):
        return None
    if trial.judge.is_thinner(stop.other, base, made[stop.other]):
        return None
    made[stop.other] = base
    angle = play(trial.hinges, stop.joint, held, made)
    if angle is None or unlatched(trial.hinges, trial.locks, trial.made, {**fitted.changed, stop.other: base}):
        return None
    (start, end), into = held.ends.tolist(), held.into.tolist()
    latch = Latch(stop.other, (tuple(start), tuple(end)), tuple(into), angle, held.moment)
    return Latched(base, changes, latch)


def fasten(trial: Trial, stop: Stop, made: Latched) -> None:
    """Makes the latch of a stop that is made."""
    assert stop.lock is not None
    trial.alter(stop.other, made.changes, made.base)
    trial.locks[stop.joint] = stop.lock
