"""Which folding options each patch of a unit has in its surroundings (sections 5.3 to 5.6).

The lanes of the unit are held against what stands around it, and the pieces that meet anything are pruned (section 5.5,
inner loop). Where what a lane meets lies folded on its own bases, it is tried again standing on plinths of that height:
the horizontal cropping of figure 15(c). Without plinths the windows that keep clear remain: the vertical cropping of
figure 15(b). The choice decides by cost.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from foldfab.folding.basic import WHOLE
from foldfab.folding.lanes import Lane
from foldfab.folding.outline import leaves_box
from foldfab.folding.problem import Crossed, Problem, as_sheet
from foldfab.folding.repertoire import Repertoire, cuts_of, far_shift, lane, stops_early, swept
from foldfab.folding.space import Batch, blocked, carried
from foldfab.folding.surroundings import Surroundings
from foldfab.folding.work import LOOKING
from foldfab.geometry.arrays import Bools

PAD_SHARE = 0.4
"""Plinths may take at most this share of the height between two bases; beyond it nothing flat is left."""
RAISES = 4
"""How often plinths are made higher because of what the raised chain meets."""
THE_BOX = "the bounding box"

Room = dict[int, Bools]
"""By lane, which of its pieces (N_s,) meet something outside the unit."""


@dataclass(frozen=True, slots=True, eq=False)
class Prospects:
    """The lanes of a unit that are worth looking at in some surroundings."""

    lanes: Mapping[str, tuple[Lane, ...]]
    """By patch."""
    blocked: Room
    obstacles: Mapping[int, tuple[str, ...]]
    """By lane, the owners of what it meets."""
    met: Mapping[int, set[int]]
    """By lane, the boxes around the unit that it meets; -1 for the bounds that it must keep to."""


def prospects(problem: Problem, own: Repertoire, around: Surroundings, *, in_place: bool) -> Prospects:
    """What the patches of a unit can do where it stands; only by in-place folding where asked for."""
    plain = {p: tuple(x for x in own.plain[p] if x.drag is None or not in_place) for p in own.unit.patches}
    every = [x for many in plain.values() for x in many]
    room: Room = {}
    met: dict[int, set[int]] = {}
    _look_at(problem, own, around, every, room, met)
    lanes = {}
    for patch, many in plain.items():
        low = [x for x in many if room[x.number].any() and x.variant.hinged == WHOLE]
        raised = [r for x in low for r in _raised(problem, own, around, x, room, met)]
        lanes[patch] = (*many, *raised)
    _raise_partners(problem, own, around, lanes, room, met)
    owners = {n: {_owner(around, i) for i in found} for n, found in met.items()}
    for n in owners if problem.crossed else ():
        owners[n].update(_crossed(problem, own.lanes[n]).by)
    return Prospects(lanes, room, {n: tuple(sorted(names)) for n, names in owners.items()}, met)


def blocked_pieces(problem: Problem, own: Repertoire, around: Surroundings, many: list[Lane]) -> Room:
    """Which pieces of some lanes meet something around the unit or leave what they must keep to."""
    room: Room = {}
    _look_at(problem, own, around, many, room, {})
    return room


def in_the_way(problem: Problem, own: Repertoire, around: Surroundings, many: list[Lane]) -> tuple[str, ...]:
    """The owners of what some lanes meet around the unit, sorted."""
    met: dict[int, set[int]] = {}
    _look_at(problem, own, around, many, {}, met)
    return tuple(sorted({_owner(around, box) for found in met.values() for box in found}))


def unhindered(problem: Problem, own: Repertoire) -> Prospects:
    """What the patches of a unit could do if nothing stood around it."""
    blocked = {x.number: ruled_out(problem, x) for many in own.plain.values() for x in many}
    return Prospects(own.plain, blocked, {}, {})


def ruled_out(problem: Problem, x: Lane) -> Bools:
    """Which pieces (N_s,) of a lane are out of the question wherever it stands."""
    found = np.full(problem.options.shrink_steps, x.is_out)
    return found | np.array(_crossed(problem, x).pieces) if problem.crossed else found


def _crossed(problem: Problem, x: Lane) -> Crossed:
    """What a lane crosses without thickness, whatever was made of it for the sake of it."""
    nothing = Crossed((False,) * problem.options.shrink_steps, ())
    return problem.crossed.get((x.patch, as_sheet(x.variant)), nothing)


def _owner(around: Surroundings, box: int) -> str:
    return THE_BOX if box < 0 else around.solids[int(around.owner[box])].owner


def _look_at(
    problem: Problem, own: Repertoire, around: Surroundings, many: list[Lane], room: Room, met: dict[int, set[int]]
) -> None:
    """Finds out which pieces of the lanes have no room, and what they meet."""
    fresh = [x for x in many if x.number not in around.met]
    problem.work.charge(LOOKING * len(fresh))
    found, hit = _held_against(problem, own, around, fresh)
    for x in fresh:
        if x.is_out or (problem.options.stay_in_box and leaves_the_box(problem, own, around, x)):
            found[x.number] = np.ones_like(found[x.number])
            hit[x.number].add(-1)
        elif problem.crossed:
            found[x.number] |= ruled_out(problem, x)
        around.met[x.number] = found[x.number], hit[x.number]
    for x in many:
        room[x.number], met[x.number] = around.met[x.number]


def _held_against(
    problem: Problem, own: Repertoire, around: Surroundings, many: list[Lane], passed: Bools | None = None
) -> tuple[Room, dict[int, set[int]]]:
    """Which pieces of the lanes meet what is around them, and which of its boxes; those `passed` (boxes,) left out."""
    steps = problem.options.shrink_steps
    room: Room = {x.number: np.zeros(steps, dtype=bool) for x in many}
    met: dict[int, set[int]] = {x.number: set() for x in many}
    close = _close(problem, around, many)
    if not close or not len(around.boxes):
        return room, met
    cuts = cuts_of(own)
    for group in _alike(own, close):
        for section in range(own.nominal.sections):
            a = swept(problem, own, group, section)
            if a is None:
                continue
            b = _carried(own, around, group[0], section)
            pieces, lanes, boxes = blocked(a, cuts, b, lambda: _never_met(problem, own, around, passed))
            for number, box in zip(lanes.tolist(), boxes.tolist(), strict=True):
                met[number].add(box)
            for x in group:
                room[x.number] |= pieces[x.number]
    return room, met


def _alike(own: Repertoire, many: list[Lane]) -> list[list[Lane]]:
    """Lanes with which the unit's bases move in the same way."""
    groups: dict[object, list[Lane]] = {}
    for x in many:
        groups.setdefault(_way(own, x), []).append(x)
    return list(groups.values())


def _way(own: Repertoire, x: Lane) -> object:
    """How the unit's bases move with a lane, hashable."""
    if stops_early(own, x):
        return (x.chain.far, round(float(x.way[2]), 6))
    return np.round(x.drag, 6).tobytes() if x.drag is not None else ""


def _carried(own: Repertoire, around: Surroundings, lead: Lane, section: int) -> Batch:
    """The surroundings as they move with the unit's bases while lanes like `lead` fold."""
    key = (_way(own, lead), section)
    if key not in around.moved:
        shifts = np.stack([far_shift(own, lead, base, section) for base in own.unit.bases], axis=1)
        around.moved[key] = carried(around.boxes, shifts[:, around.group], np.arange(len(around.boxes)))
    return around.moved[key]


def _close(problem: Problem, around: Surroundings, many: list[Lane]) -> list[Lane]:
    """The lanes that come near anything but the plates that their own hinges stand on; all others have room.

    Where a unit has very many bases, all of its lanes.
    """
    reach = [x.reach for x in many if x.reach is not None]
    if len(reach) < len(many) or not many:
        return many
    near: Bools = ~_own_plates(problem, many, around)
    low, high = (np.array([corners[end] for corners in reach])[:, around.group] for end in (0, 1))
    for axis in range(3):
        near &= (low[..., axis] <= around.corners[1][:, axis]) & (high[..., axis] >= around.corners[0][:, axis])
    return [x for x, found in zip(many, near, strict=True) if found.any()]


def _never_met(problem: Problem, own: Repertoire, around: Surroundings, passed: Bools | None) -> Bools:
    plates = _own_plates(problem, own.lanes, around)
    return plates if passed is None else plates | passed


def _own_plates(problem: Problem, many: list[Lane], around: Surroundings) -> Bools:
    """(lanes, boxes) the plates that a lane's own hinges stand on; they are never in its way."""
    number = problem.tree.number
    own_bases = np.array([[number[x.chain.anchor], number[x.chain.far or x.chain.anchor]] for x in many])
    found: Bools = (own_bases[:, :, None] == around.plate).any(1)
    return found


def _raised(
    problem: Problem, own: Repertoire, around: Surroundings, first: Lane, room: Room, met: dict[int, set[int]]
) -> tuple[Lane, ...]:
    """The lane on plinths as high as what it meets folded on its own bases; nothing where that does not help."""
    current, clear = first, problem.sites[first.patch].clear
    for _ in range(RAISES):
        pads = _needed_pads(problem, own, around, current, met[current.number])
        if sum(pads) > PAD_SHARE * clear:
            return ()
        if pads == current.variant.pads:
            break
        higher = lane(problem, own, first.patch, replace(current.variant, pads=pads))
        if higher is None:
            return ()
        current = higher
        if current.number not in room:
            _look_at(problem, own, around, [current], room, met)
        if not room[current.number].any():
            break
    if current is first or room[current.number].sum() >= room[first.number].sum():
        return ()
    _keep_clear(problem, own, around, [(current, first)], room, met)
    return (current,) if room[current.number].sum() < room[first.number].sum() else ()


def _keep_clear(
    problem: Problem, own: Repertoire, around: Surroundings, raised: list[tuple[Lane, Lane]], room: Room,
    met: dict[int, set[int]],
) -> None:  # fmt: skip
    """Rules out what lanes on plinths would meet without them and stands open: thickness only adds constraints
    (section 5.6), and plinths are for what lies folded.
    """
    lies = np.array([s.state != "open" for s in around.solids])[around.owner]
    standing, by = _held_against(problem, own, around, [plain for _, plain in raised], lies)
    for x, plain in raised:
        room[x.number], met[x.number] = room[x.number] | standing[plain.number], met[x.number] | by[plain.number]
        around.met[x.number] = room[x.number], met[x.number]


def _raise_partners(
    problem: Problem, own: Repertoire, around: Surroundings, lanes: dict[str, tuple[Lane, ...]], room: Room,
    met: dict[int, set[int]],
) -> None:  # fmt: skip
    """Slanted lanes drag their base together: where one stands on plinths, the others may as well."""
    wanted = sorted({x.variant for many in lanes.values() for x in many if x.drag is not None and any(x.variant.pads)})
    for patch, many in lanes.items():
        made = {x.variant for x in many}
        found = (lane(problem, own, patch, v) for v in wanted if v not in made)
        fresh = [x for x in found if x is not None and sum(x.variant.pads) <= PAD_SHARE * problem.sites[patch].clear]
        if fresh:
            _look_at(problem, own, around, fresh, room, met)
            plain = {x.variant: x for x in many}
            pairs = ((x, plain.get(replace(x.variant, pads=(0.0, 0.0)))) for x in fresh)
            _keep_clear(problem, own, around, [(x, y) for x, y in pairs if y is not None], room, met)
            lanes[patch] = (*many, *fresh)


def _needed_pads(
    problem: Problem, own: Repertoire, around: Surroundings, x: Lane, met: set[int]
) -> tuple[float, float]:
    """Heights above the anchor's face and below the far face of the folded things that the lane meets."""
    pads = list(x.variant.pads)
    rises = x.chain.rise[2] > 0
    for box in met - {-1}:
        solid, base = around.solids[int(around.owner[box])], own.unit.bases[int(around.group[box])]
        if solid.state == "open" or base not in (x.chain.anchor, x.chain.far):
            continue
        end = 0 if base == x.chain.anchor else 1
        middle = around.boxes.center[box, 2]
        reach = float(around.boxes.half[box] @ np.abs(around.boxes.axes[box, :, 2]))
        face = problem.faces[base]
        height = middle + reach - face.top if rises == (end == 0) else face.bottom - middle + reach
        pads[end] = max(pads[end], float(height))
    return (pads[0], pads[1])


def leaves_the_box(problem: Problem, own: Repertoire, around: Surroundings, x: Lane) -> bool:
    """Whether a lane, or what it carries along, leaves the bounding box of the open furniture."""
    root = own.unit.bases[int(around.cluster[0])]
    for section in x.active:
        found = swept(problem, own, (x,), section)
        assert found is not None
        shift = {base: far_shift(own, x, base, section) for base in own.unit.bases}
        carried_by = around.offset - shift[root]
        low, high = found.low.min(1), found.high.max(1)
        if leaves_box(problem, low, high, around.bounds, shift, carried_by):
            return True
    return False
