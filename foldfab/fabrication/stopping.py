"""Every hinge gets its stops, where there is room for them; what each then turns to is measured."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from foldfab.fabrication.model import Assembly, Joint, Latch
from foldfab.fabrication.mounts import Stop
from foldfab.fabrication.shapes import Shape
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.stops import rests, stops
from foldfab.fabrication.trial import Change, Fitted, Trial
from foldfab.folding.model import Chain


@dataclass(frozen=True, slots=True)
class Stopped:
    """Bodies and joints with their stops and latches."""

    made: dict[str, Solid]
    shapes: dict[str, Shape]
    """What each body is made of."""
    joints: tuple[Joint, ...]
    """With what each reaches."""
    gives: dict[str, list[Solid]]
    """By panel, what of it gives way while it passes its latches."""
    changes: dict[str, list[Change]]
    """By body, what stops and latches made of it."""


def stopped(assembly: Assembly, made: dict[str, Solid], ramps: Mapping[str, list[Shape]]) -> Stopped:
    """The bodies with stops and, where they are asked for, latches.

    `assembly` needs no bodies yet, but the shapes of which `made` was made; `ramps` is what will be cut from bodies.
    """
    trial = Trial(assembly, made, ramps)
    taken: dict[str, tuple[str, ...]] = {joint.name: () for joint in assembly.joints}
    latches: dict[str, Latch | None] = {}
    is_latched = assembly.solution.scaffold.recipe.print.latch
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
                latches |= {name: trial.latch(best.stop)} if is_latched and best.stop.detent else {}
    joints = tuple(replace(j, stops=taken[j.name], latch=latches.get(j.name)) for j in reached(trial, assembly.joints))
    return Stopped(trial.made, trial.shapes, joints, trial.gives, trial.changes)


def measured(assembly: Assembly, made: dict[str, Solid]) -> tuple[Joint, ...]:
    """The joints with what each reaches on bodies that were changed after they got their stops."""
    return reached(Trial(assembly, made), assembly.joints)


def reached(trial: Trial, joints: tuple[Joint, ...]) -> tuple[Joint, ...]:
    """The joints with how far past their ends they turn."""
    return tuple(replace(j, stop_deg=_angles(trial, j.name)) for j in joints)


def _hinges(assembly: Assembly) -> Iterator[tuple[Chain, int, str]]:
    for chain in assembly.solution.chains:
        bodies = [chain.anchor, *chain.panels, *([chain.far] if chain.far else [])]
        for hinge in range(len(bodies) - 1):
            yield chain, hinge, f"{bodies[hinge]}~{bodies[hinge + 1]}"


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


def _angles(trial: Trial, joint: str) -> tuple[float | None, float | None]:
    return trial.angle(joint, is_folded=False), trial.angle(joint, is_folded=True)
