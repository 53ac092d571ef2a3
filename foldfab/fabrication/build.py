"""The verb of this room: a FoldSolution becomes an Assembly (sections 5.6 and 6, Fabrication)."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from foldfab.errors import FabricationError
from foldfab.fabrication import solids
from foldfab.fabrication.bodies import bodies
from foldfab.fabrication.bores import blocked, bored
from foldfab.fabrication.inspect import inspect, listing
from foldfab.fabrication.joinery import cut_to_bed, with_breaks
from foldfab.fabrication.model import AS_READ, LEVEL, Assembly, Finding, Joint
from foldfab.fabrication.own import own_shapes
from foldfab.fabrication.panels import panels
from foldfab.fabrication.plates import axis_of, plate
from foldfab.fabrication.posture import cuts_parts, edge_up, needs_pins, open_turn
from foldfab.fabrication.printed import printed
from foldfab.fabrication.props import planed, propped
from foldfab.fabrication.relief import relief
from foldfab.fabrication.shapes import Shape, cut
from foldfab.fabrication.snaps import snap_findings
from foldfab.fabrication.soles import eased
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.stopping import measured, stopped
from foldfab.fabrication.turning import PAST
from foldfab.folding.kinematics import configuration, key_times
from foldfab.folding.mechanism import joints, tilts
from foldfab.folding.model import Chain, FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.recipe.hinges import STYLES, hinge_problem
from foldfab.recipe.model import Posture

Progress = Callable[[str, float], None]
"""Called with what is being done and the share of it that is done."""

PLANED = 0.5
"""What may be taken off one end of a part for it to stand flush with others on edge, as a share of K."""


def build(solution: FoldSolution, posture: Posture, progress: Progress | None = None) -> Assembly:
    """The solids of a solution with their hinges and motion, inspected by the kernel.

    Raises:
        FabricationError: a finding means that the print would not work; it says which part and what to change.
    """
    tell = progress or (lambda what, share: None)
    _require_hinges(solution, posture)
    solution = with_breaks(solution, posture)
    tell("solids", 0.0)
    described, findings = _shapes(solution, posture)
    made = _solids(described)
    times = key_times(solution)
    poses = configuration(solution, times)
    up = edge_up(solution, made, poses) if posture == "edge" else None
    if up is not None:
        below, taken = planed(made, poses, up, PLANED * solution.thickness.panel)
        described = {name: cut(shape, [below[name]] if name in below else []) for name, shape in described.items()}
        made = {**made, **{name: solids.cut(made[name], [printed(below[name])]) for name in below}}
        findings += _planed(taken)
    joints_ = tuple(_joints(solution))
    draft = Assembly(solution, (), joints_, times, {n: poses[n] for n in made}, posture, (), described, up)
    tell("stops", 0.0)
    ramps, level = relief(solution, made, joints_, up) if up is not None else ({}, [])
    findings += _level(level)
    held = stopped(draft, made, ramps)
    held, told = own_shapes(draft, held, ramps)
    made, draft = held.made, replace(draft, joints=held.joints, shapes=held.shapes)
    made, draft, more = _finished(draft, made, ramps)
    findings += [*told, *more]
    draft = replace(draft, bodies=bodies(solution, made))
    findings += [*snap_findings(solution), *_notes(solution)]
    findings += inspect(draft, made, lambda share: tell("inspection", share))
    _require_sound(findings)
    draft, more = cut_to_bed(draft, made)
    _require_sound(more)
    return replace(draft, findings=(*findings, *more))


def _finished(
    draft: Assembly, made: dict[str, Solid], ramps: dict[str, list[Shape]]
) -> tuple[dict[str, Solid], Assembly, list[Finding]]:
    """What is cut once the stops stand: ramps on edge, bores that are to be open for their pins, edges on the bed."""
    solution, props = draft.solution, dict[str, Solid]()
    has_bores = draft.up is None and STYLES[solution.thickness.hinge].has_loose_pin
    if draft.up is not None:
        made = {name: solids.tidied(solids.cut(b, [printed(r) for r in ramps[name]])) for name, b in made.items()}
        props = propped(made, draft.poses, draft.up, solution.thickness.gap)
        draft = replace(draft, shapes={name: cut(shape, ramps[name]) for name, shape in draft.shapes.items()})
    elif has_bores:
        made, shapes = bored(solution, made, draft.shapes)
        draft = replace(draft, shapes=shapes)
    made, draft = _bevelled(replace(draft, propped=bodies(solution, props)), made)
    return made, draft, blocked(draft, made) if has_bores else []


def _bevelled(draft: Assembly, made: dict[str, Solid]) -> tuple[dict[str, Solid], Assembly]:
    """Bodies without their edges on the bed, but those whose hinges would stop too late without them."""
    whole = bodies(draft.solution, made)
    done, shapes = eased(draft, whole, made, draft.shapes)
    joints = measured(draft, done)
    is_prompt = {joint.name: [_is_prompt(angle) for angle in joint.stop_deg] for joint in draft.joints}
    late = [
        j
        for j in joints
        if any(was and not _is_prompt(a) for was, a in zip(is_prompt[j.name], j.stop_deg, strict=True))
    ]
    draft = replace(draft, spared=frozenset(name for joint in late for name in joint.parts))
    # Parts that are cut have other edges on the bed afterwards.
    if cuts_parts(draft.solution, draft.posture):
        return made, replace(draft, joints=measured(draft, made))
    if late:
        done, shapes = eased(draft, whole, made, draft.shapes)
        joints = measured(draft, done)
    return done, replace(draft, shapes=shapes, joints=joints)


def _is_prompt(angle: float | None) -> bool:
    return angle is not None and angle <= PAST


def _require_hinges(solution: FoldSolution, posture: Posture) -> None:
    options = solution.scaffold.recipe.print
    problem = hinge_problem(options.hinge, options.thickness, posture)
    if needs_pins(posture) and options.hinge == "cone":
        problem = "hinges pinned by cones print in place only; load the recipe with the posture plate, or another hinge"
    if problem:
        raise FabricationError(problem)


def _require_sound(findings: list[Finding]) -> None:
    fatal = [f for f in findings if f.is_fatal]
    if fatal:
        told = "".join(f"\n  {f.code}: {f.text}" for f in fatal[:12])
        more = f"\n  and {len(fatal) - 12} more" if len(fatal) > 12 else ""
        raise FabricationError(f"this print would not work:{told}{more}")


def _notes(solution: FoldSolution) -> list[Finding]:
    recipe = solution.scaffold.recipe
    posture = [Finding("posture", recipe.print.why)] if recipe.print.why else []
    read = [Finding(AS_READ, note) for note in recipe.notes]
    return [*posture, *read, *(Finding("note", note) for note in solution.notes)]


def _shapes(solution: FoldSolution, posture: Posture) -> tuple[dict[str, Shape], list[Finding]]:
    """By body, what it is made of in the open posture, canonical frame, mm; and the findings on the way."""
    made: dict[str, Shape] = {}
    findings = []
    up = open_turn(solution.scaffold)[2] if posture == "open" else None
    for base in solution.scaffold.bases:
        carried = tuple(c for c in solution.chains if base.name in (c.anchor, c.far))
        made[base.name], is_filled = plate(base, carried, solution.thickness)
        if is_filled:
            findings.append(
                Finding("filled", f"{base.name} is printed as one full plate, because its parts are too far apart")
            )
    for chain in solution.chains:
        made.update(zip(chain.panels, panels(chain, solution.thickness, up), strict=True))
    return made, findings


def _solids(described: dict[str, Shape]) -> dict[str, Solid]:
    known: dict[Shape, Solid] = {}
    return {name: solids.tidied(printed(shape, known)) for name, shape in described.items()}


def _planed(taken: dict[str, float]) -> list[Finding]:
    if not taken:
        return []
    told = (
        f"{', '.join(sorted(taken))} lose up to {max(taken.values()):.2f} mm at one end, so that more stands on the bed"
    )
    return [Finding("planed", told)]


def _level(hinges: list[str]) -> list[Finding]:
    if not hinges:
        return []
    why = "because ramps below knuckles so short would open their sockets; print larger"
    return [Finding(LEVEL, f"the undersides of {listing(hinges)} stay flat on edge and want support, {why}")]


def _joints(solution: FoldSolution) -> list[Joint]:
    found = []
    for chain in solution.chains:
        angles = np.degrees(tilts(chain, np.array([0.0, 1.0])))
        turns = np.concatenate([[[0.0], [0.0]], angles, [[0.0], [0.0]]], axis=1)
        for j, (a, b) in enumerate(itertools.pairwise(chain.bodies)):
            turn = abs(float((turns[1, j + 1] - turns[1, j]) - (turns[0, j + 1] - turns[0, j])))
            axis = _axis(chain, j)
            inserted = 0 < j < len(chain.lengths)
            found.append(Joint(f"{a}~{b}", (a, b), axis, chain.panel / 2, (0.0, round(turn, 3)), inserted))
    return sorted(found, key=lambda j: j.name)


def _axis(chain: Chain, j: int) -> Array:
    """(2, 3) the ends of hinge j in the open posture."""
    if j in (0, len(chain.lengths)):
        middle = axis_of(chain, 0 if j == 0 else 1)
    else:
        middle = chain.root + joints(chain, tilts(chain, np.zeros(1)))[0, j] @ np.stack([chain.across, chain.rise])
    ends: Array = middle + chain.hinge_spans[j][:, None] * chain.along
    return ends
