"""Every hinge gets its stops, where there is room for them; what each then turns to is measured."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

from foldfab.fabrication import solids
from foldfab.fabrication.inspect import instants
from foldfab.fabrication.latches import Lock
from foldfab.fabrication.latching import fasten, latched
from foldfab.fabrication.model import Assembly, Joint, Latch
from foldfab.fabrication.mounts import Stop
from foldfab.fabrication.posture import printed_turn
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.stops import bolts, rests, stops
from foldfab.fabrication.trial import Change, Fitted, Trial
from foldfab.fabrication.turning import Turn, stops_at, turns
from foldfab.fabrication.undercuts import bevels, roofs
from foldfab.folding.kinematics import configuration
from foldfab.folding.model import Chain

ROOFS = (1.0, 0.5)
"""How high roofs are tried, in shares of what makes them pointed."""


@dataclass(frozen=True, slots=True)
class Stopped:
    """Bodies and joints with their stops and latches."""

    made: dict[str, Solid]
    shapes: dict[str, Shape]
    """What each body is made of."""
    joints: tuple[Joint, ...]
    """With what each reaches."""
    locks: dict[str, Lock]
    """By joint, the latch that it has."""
    changes: dict[str, list[Change]]
    """By body, what stops and latches made of it."""


def stopped(assembly: Assembly, made: dict[str, Solid], ramps: Mapping[str, list[Shape]]) -> Stopped:
    """The bodies with stops and, where they are asked for, latches.

    `assembly` needs no bodies yet, but the shapes of which `made` was made; `ramps` is what will be cut from bodies.
    """
    trial = Trial(assembly, made, ramps)
    taken: dict[str, tuple[str, ...]] = {joint.name: () for joint in assembly.joints}
    made_stops: dict[str, Fitted] = {}
    for chain, hinge, name in _hinges(assembly):
        ends = stops(assembly.solution, chain, hinge, in_open=assembly.posture in ("open", "plate"))
        ways = ((False, ends), (True, rests(assembly.solution, chain, hinge)))
        if assembly.posture == "edge":
            # There, what reaches out of a knuckle or a base would begin in the air.
            ends = (stop for stop in ends if stop.kind in ("heel", "butt"))
            ways = ((False, ends), (True, rests(assembly.solution, chain, hinge, assembly.up)))
        for is_folded, candidates in ways:
            best = _best(trial, name, candidates, is_folded)
            if best is not None:
                trial.take(best)
                taken[name] = (*taken[name], best.stop.kind)
                made_stops |= {} if is_folded else {name: best}
    if assembly.posture == "open":
        _undercut(assembly, trial, made_stops)
    latches = _latches(assembly, trial, made_stops)
    joints = tuple(
        replace(j, stops=taken[j.name], latch=latches.get(j.name))
        for j in reached(assembly.joints, trial.hinges.turns, trial.made)
    )
    return Stopped(trial.made, trial.shapes, joints, trial.locks, trial.changes)


def _undercut(assembly: Assembly, trial: Trial, made: Mapping[str, Fitted]) -> None:
    """Takes roofs and bevels from panels at their inserted hinges, where what is left is sound and stops as before."""
    thickness, up = assembly.solution.thickness, printed_turn(assembly)[2]
    for chain, hinge, name in _hinges(assembly):
        if not 0 < hinge < len(chain.lengths):
            continue
        _trim(trial, [list(roofs(chain, thickness, hinge, up, share)) for share in ROOFS])
        # The end of a panel is all that stops a hinge without a lap, if late.
        if trial.is_prompt(name, is_folded=False):
            own = [printed(made[name].stop.added)] if name in made else []
            reach = [(solids.mesh(solid)[0] - chain.root) @ chain.along for solid in own]
            taken = tuple((float(r.min()), float(r.max())) for r in reach)
            _trim(trial, [list(bevels(chain, thickness, hinge, up, taken))])


def _trim(trial: Trial, ways: list[list[tuple[str, Shape]]]) -> None:
    """Takes holes from bodies, by their names: all in the first way, or each in the first way that has room."""
    first = ways[0]
    if first and not trial.trim(first[0][0], [hole for _, hole in first]):
        for choices in zip(*ways, strict=True):
            any(trial.trim(name, [hole]) for name, hole in choices)


def _latches(assembly: Assembly, trial: Trial, made: Mapping[str, Fitted]) -> dict[str, Latch]:
    """Latches by joint, where they are asked for and have room: at the tongue that stops a hinge, or at one more.

    They come last, so that no other stop takes what holds them.
    """
    found: dict[str, Latch] = {}
    if not assembly.solution.scaffold.recipe.print.latch or assembly.posture == "edge":
        return found
    for chain, hinge, name in _hinges(assembly):
        if name in made:
            held = latched(trial, replace(made[name], changed={}))
            if held is not None:
                fasten(trial, made[name].stop, held)
                found[name] = held.latch
                continue
        for stop in bolts(assembly.solution, chain, hinge):
            fitted = trial.fitted(stop)
            held = latched(trial, fitted) if fitted is not None and trial.has_room(fitted) else None
            if fitted is not None and held is not None:
                trial.take(fitted)
                fasten(trial, stop, held)
                found[name] = held.latch
                break
    return found


def measured(assembly: Assembly, made: dict[str, Solid]) -> tuple[Joint, ...]:
    """The joints with what each reaches on bodies that were changed after they got their stops."""
    poses = configuration(assembly.solution, instants(assembly))
    return reached(assembly.joints, turns(assembly.joints, poses), made)


def reached(joints: tuple[Joint, ...], ranges: Mapping[str, Turn], made: Mapping[str, Solid]) -> tuple[Joint, ...]:
    """The joints with how far past the ends of their ranges they turn."""
    return tuple(replace(j, stop_deg=_angles(ranges[j.name], *(made[part] for part in j.parts))) for j in joints)


def _hinges(assembly: Assembly) -> Iterator[tuple[Chain, int, str]]:
    for chain in assembly.solution.chains:
        for hinge, (below, above) in enumerate(pairwise(chain.bodies)):
            yield chain, hinge, f"{below}~{above}"


def _best(trial: Trial, joint: str, candidates: Iterable[Stop], is_folded: bool) -> Fitted | None:
    """The first stop that works within `PAST`, or the one that works soonest; None where none is needed or helps."""
    if trial.is_prompt(joint, is_folded=is_folded):
        return None
    late: list[Fitted] = []
    for stop in candidates:
        fitted = trial.fitted(stop)
        if fitted is None:
            continue
        if not trial.is_prompt(joint, is_folded=is_folded, fitted=fitted):
            late.append(fitted)
        elif trial.has_room(fitted):
            return fitted
    return trial.soonest(late)


def _angles(range_: Turn, first: Solid, second: Solid) -> tuple[float | None, float | None]:
    return stops_at(range_, first, second, is_folded=False), stops_at(range_, first, second, is_folded=True)
