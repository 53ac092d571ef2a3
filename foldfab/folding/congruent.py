"""Units that are the same but for where they stand: what one can do, all of them can.

Furniture repeats itself, and composites do so a thousand times. The lanes of a unit and the conflicts between them
depend on nothing but its own patches and plates, and on what may be cut from these; a translated copy of a unit gets
copies of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from foldfab.folding.aside import set_aside
from foldfab.folding.balance import pocket_room
from foldfab.folding.lanes import Lane
from foldfab.folding.nominal import Nominal
from foldfab.folding.outline import leaves_outline
from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import Repertoire, made_from_scratch
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes

DIGITS = 5
"""To how many digits of mm two units agree to be copies."""


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """A unit in terms that do not depend on its names or its place."""

    signature: object
    """Hashable; equal for translated copies."""
    origin: Array
    """(3,) mm."""
    bases: tuple[str, ...]
    """In the order of the signature."""
    patches: tuple[str, ...]
    """In the order of the signature."""


def repertoire(problem: Problem, unit: Unit) -> Repertoire:
    """What the patches of a unit can do, made once for all its copies."""
    if unit not in problem.repertoires:
        problem.repertoires[unit] = _made(problem, unit)
    found: Repertoire = problem.repertoires[unit]
    return found


def _made(problem: Problem, unit: Unit) -> Repertoire:
    # A unit by itself has no copies.
    now = pose(problem, unit) if len(problem.units) > 1 else None
    known: tuple[Repertoire, Pose] | None = problem.poses.get(now.signature) if now is not None else None
    if now is not None and known is not None:
        return copied(problem, *known, unit, now)
    made = made_from_scratch(problem, unit)
    set_aside(problem, made)
    if now is not None:
        problem.poses[now.signature] = made, now
    return made


def pose(problem: Problem, unit: Unit) -> Pose:
    """What a unit looks like, wherever it stands."""
    sites = [problem.sites[p] for p in unit.patches]
    origin = np.min([s.foot for s in sites], axis=0)
    corners = {b: _rounded(np.concatenate(problem.plates[b]) - np.tile(origin, 2)) for b in unit.bases}
    bases = tuple(sorted(unit.bases, key=lambda b: (corners[b], unit.bases.index(b))))
    place: dict[str | None, int] = {b: i for i, b in enumerate(bases)}
    seen = {}
    for s in sites:
        numbers = [s.foot - origin, s.across, s.along, s.rise, s.span, np.array(s.held).ravel()]
        numbers.append(np.array([s.lean, s.clear, s.patch.width, s.patch.length, s.panel]))
        # How chains can be balanced is part of what is known about their lanes.
        numbers.append(np.array([pocket_room(problem, s, base) for base in (s.anchor, s.far)]))
        banned = tuple(sorted(v for p, v in problem.banned if p == s.patch.name))
        ends = (place[s.anchor], place.get(s.far, -1), s.patch.hingeable, round(s.importance, 12), banned)
        seen[s.patch.name] = (_rounded(np.concatenate(numbers)), ends)
    patches = tuple(sorted(unit.patches, key=lambda p: (seen[p], unit.patches.index(p))))
    order = tuple(place[b] for b in unit.bases)
    signature = (tuple(seen[p] for p in patches), tuple(corners[b] for b in bases), order)
    return Pose(signature, origin, bases, patches)


def copied(problem: Problem, known: Repertoire, then: Pose, unit: Unit, now: Pose) -> Repertoire:
    """What a unit can do, from what its copy can do."""
    offset = now.origin - then.origin
    base: dict[str | None, str | None] = dict(zip(then.bases, now.bases, strict=True))
    patch = dict(zip(then.patches, now.patches, strict=True))
    lanes = [_copied_lane(problem, x, offset, base, patch[x.patch]) for x in known.lanes]
    made = Repertoire(unit, Nominal({str(base[b]): down for b, down in known.nominal.down.items()}), lanes)
    for movers in known.movers:
        made.movers.append({k: Boxes(boxes.center + offset, boxes.axes, boxes.half) for k, boxes in movers.items()})
    for (name, variant), lane in known.by_variant.items():
        made.by_variant[patch[name], variant] = lanes[lane.number] if lane is not None else None
    made.plain.update({patch[p]: tuple(lanes[x.number] for x in many) for p, many in known.plain.items()})
    made.aside.update({patch[p]: tuple(lanes[x.number] for x in many) for p, many in known.aside.items()})
    made.later.update({patch[p]: list(many) for p, many in known.later.items()})
    made.pieces.update(known.pieces)
    made.parts.update(known.parts)
    made.interrupted.update(known.interrupted)
    made.plain_of.update(known.plain_of)
    made.compared.update(known.compared)
    made.sheets.update(known.sheets)
    made.tables.update(known.tables)
    made.reach.update({str(base[b]): (low + offset, high + offset) for b, (low, high) in known.reach.items()})
    return made


def _copied_lane(problem: Problem, x: Lane, offset: Array, base: dict[str | None, str | None], patch: str) -> Lane:
    c = x.chain
    chain = replace(c, patch=patch, anchor=str(base[c.anchor]), far=base.get(c.far), root=c.root + offset)
    shift = float(offset @ c.across)
    beside = (x.beside[0] + shift, x.beside[1] + shift)
    return replace(
        x, patch=patch, chain=chain, cuts=x.cuts + float(offset @ c.along), beside=beside,
        is_out=leaves_outline(problem, chain, beside), low=x.low + offset, high=x.high + offset,
        reach=(x.reach[0] + offset, x.reach[1] + offset) if x.reach is not None else None,
    )  # fmt: skip


def _rounded(values: Array) -> tuple[float, ...]:
    return tuple((np.round(values, DIGITS) + 0.0).tolist())
