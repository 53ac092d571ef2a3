"""The conflict graph of a unit (section 5.4, definition 5), between the options of different patches.

Two options conflict where their panels meet while both fold, where they drag the upper base along different ways
(figure 12), or, with thickness, where their accordions snap so differently that the play in their hinges cannot
cover it, however they are balanced. Options of one patch form a clique and are never compared. What meets is found once
for the pieces of all lanes of a unit together; tables between the options of two patches are made from that.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from foldfab.folding.balance import can_agree
from foldfab.folding.basic import WHOLE
from foldfab.folding.lanes import Lane
from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import Repertoire, cuts_of, lane, pieces_met, regions, resting, stretches, swept
from foldfab.folding.sheets import RIM, sheets
from foldfab.folding.space import Batch, conflicts, meetings
from foldfab.geometry.arrays import Array, Bools, Indices

SAME_PLACE = 0.05
"""Two slanted chains drag their upper base alike where the ends differ by less, mm."""


def compare(problem: Problem, own: Repertoire, many: Iterable[Lane]) -> None:
    """Finds out which pieces of the lanes meet, and which of them meet lanes that were compared before."""
    fresh = [x for x in many if x.number not in own.compared]
    if not fresh:
        return
    # Plinths shorten a chain, but thickness only adds constraints (section 5.6): what its plain lane meets, it meets.
    plain = {
        x.number: lane(problem, own, x.patch, replace(x.variant, pads=(0.0, 0.0))) for x in fresh if any(x.variant.pads)
    }
    fresh += [y for y in plain.values() if y is not None and y not in fresh and y.number not in own.compared]
    known = [own.lanes[n] for n in sorted(own.compared)]
    same, once = _never_compared(own, fresh)
    own.compared.update(x.number for x in fresh)
    cuts, same, once = np.repeat(cuts_of(own), 2, axis=0), _told_apart(same), _told_apart(once)
    if problem.options.collisions == "regions":
        _learn(own, _regions_met(problem, own, fresh, known, cuts, same, once))
        known, fresh = [], []
    for section in range(own.nominal.sections):
        whole = [swept(problem, own, many, section) for many in (fresh, known)]
        moving, others = (_parted(own, x) if x is not None else None for x in whole)
        pairs = [(moving, moving, once), (moving, others, same)]
        if own.nominal.sections > 1:
            pairs += [(moving, _beside(problem, own, [*fresh, *known], fresh, section), same)]
            pairs += [(others, _beside(problem, own, fresh, known, section), same)]
        for a, b, apart in pairs:
            if a is not None and b is not None:
                _learn(own, conflicts(a, b, cuts, apart))
    for number, y in plain.items():
        own.plain_of[number] = y.number if y is not None else number
    if own.sheets:
        compare_sheets(problem, own)


def compare_sheets(problem: Problem, own: Repertoire) -> None:
    """Finds out which pieces of the lanes that fold in place cross as the paper's sheets; what is so is so for good.

    Lanes that differ by plinths, thickness or knuckles are one sheet.
    """
    alike: dict[object, list[Lane]] = {}
    for x in (x for x in own.lanes if x.chain.far is not None and x.chain.shape.comes_down):
        alike.setdefault((x.patch, x.variant.hinges, x.variant.side), []).append(x)
    kinds = list(alike.values())
    if {x.number for many in kinds for x in many} <= own.sheets:
        return
    own.sheets.update(x.number for many in kinds for x in many)
    played = sheets(problem.scaffold, [many[0].chain for many in kinds], RIM)
    if played is None:
        return
    # Where a window ends at a cut it ends half the gap before it: what only meets there need not meet.
    rim, cuts = RIM + problem.thickness.gap / 2, np.array([many[0].cuts for many in kinds])
    ends = np.stack([cuts - rim, cuts + rim], axis=-1).reshape(len(kinds), -1)[:, 1:-1]
    for (i, j), found in conflicts(played[0], played[0], ends, played[1]).items():
        pieces = found[::2, ::2]
        if pieces.any():
            _learn(own, {(2 * a.number, 2 * b.number): pieces for a in kinds[i] for b in kinds[j]})
    own.tables.clear()


def _regions_met(
    problem: Problem, own: Repertoire, fresh: list[Lane], known: list[Lane], cuts: Array, same: Bools, once: Bools
) -> dict[tuple[int, int], Bools]:
    """The paper's own test: folding time intervals overlap, and so do the regions that patches cover when folded."""
    start, stop = (np.repeat([getattr(x.active, end) for x in own.lanes], 2) for end in ("start", "stop"))
    apart = (start[:, None] >= stop) | (start >= stop[:, None])
    new = _parted(own, regions(problem, own, fresh))
    met = conflicts(new, new, cuts, once | apart)
    return met | conflicts(new, _parted(own, regions(problem, own, known)), cuts, same | apart) if known else met


def _parted(own: Repertoire, whole: Batch) -> Batch:
    """A batch of lanes with each told apart in two: panels have twice its number, knuckles and feet one more."""
    begins = np.append(True, np.diff(whole.lane) != 0)
    place = np.arange(len(whole)) - np.maximum.accumulate(np.where(begins, np.arange(len(whole)), 0))
    panels = np.array([len(x.chain.lengths) for x in own.lanes])
    return replace(whole, lane=2 * whole.lane + (place >= panels[whole.lane]))


def _told_apart(never: Bools) -> Bools:
    """Which lanes are never compared, for lanes that are told apart."""
    found: Bools = np.repeat(np.repeat(never, 2, axis=0), 2, axis=1)
    return found


@cache
def windows_table(windows: tuple[tuple[int, int], ...], steps: int) -> Array:
    """(windows, N_s) 1 where a window holds a piece."""
    place = np.arange(steps)
    found: Array = np.array([(place >= a) & (place < b) for a, b in windows]).astype(np.float32)
    found.setflags(write=False)
    return found


def table(
    problem: Problem, own: Repertoire, first: tuple[Lane, ...], second: tuple[Lane, ...], inside: Array, *,
    in_modes: bool = False, is_bare: bool = False,
) -> Bools | None:  # fmt: skip
    """Which options of one patch conflict with which of another: (n · w + 1, m · w + 1), lane by lane, deletion last.

    `inside` (w, N_s) says which pieces each window holds. None where nothing conflicts. Where `is_bare`, hinges that
    may still be interrupted have such knuckles as suit the two patches.
    """
    key: object = (tuple(x.number for x in first), tuple(x.number for x in second), in_modes)
    key = (key, *(tuple(may_be_interrupted(own, x) for x in many) for many in (first, second))) if is_bare else key
    if key not in own.tables:
        made = _table(problem, own, first, second, inside, in_modes=in_modes, is_bare=is_bare)
        own.tables[key] = made if made.any() else np.zeros((0, 0), dtype=bool)
    found = own.tables[key]
    return found if found.size else None


def neighbours(
    own: Repertoire, lanes: Mapping[str, tuple[Lane, ...]], *, in_modes: bool = False
) -> list[tuple[str, str]]:
    """The pairs of patches whose options may conflict, sorted; those that only drag apart left out where `in_modes`."""
    found = {(own.lanes[a].patch, own.lanes[b].patch) for a, b in own.pieces}
    together: dict[str, list[str]] = {}
    for patch, many in lanes.items():
        if many and many[0].chain.far is not None:
            together.setdefault(many[0].chain.far, []).append(patch)
    for patches in together.values():
        every = [x for p in patches for x in lanes[p]]
        snaps = [x.snap for x in every if x.chain.shape.comes_down]
        alike = not snaps or max(snaps) - min(snaps) <= 2 * min(x.give for x in every)
        if (not in_modes and any(x.drag is not None for x in every)) or not alike:
            found |= set(itertools.combinations(patches, 2))
    return sorted({(min(a, b), max(a, b)) for a, b in found if a in lanes and b in lanes})


def modes(own: Repertoire, lanes: Mapping[str, tuple[Lane, ...]]) -> list[set[int]]:
    """Sets of lanes, by number, that drag the bases of their unit along the same way; one set where none drags any."""
    found: list[tuple[Lane, set[int]]] = []
    for x in (x for p in own.unit.patches for x in lanes[p]):
        mode = next((m for lead, m in found if drag_alike(lead, x)), None)
        if mode is None:
            found.append((x, mode := set()))
        mode.add(x.number)
    return [mode for _, mode in found]


def drag_alike(a: Lane, b: Lane) -> bool:
    """Whether two lanes drag their bases along the same way (condition ii of section 5.2)."""
    if not _share_bases(a, b):
        return True
    if (a.drag is None) != (b.drag is None):
        return False
    return a.drag is None or bool(np.abs(a.way - b.way).max() < SAME_PLACE)


def snap_alike(problem: Problem, own: Repertoire, a: Lane, b: Lane) -> bool:
    """Whether the play in their hinges covers the difference between the snaps of two lanes that start together.

    As they are or, between the same two bases, balanced in one of the ways there are.
    """
    if a.chain.far != b.chain.far or not a.chain.shape.comes_down or not b.chain.shape.comes_down:
        return True
    if abs(a.snap - b.snap) <= a.give + b.give:
        return True
    if not _share_bases(a, b):
        return False
    key = tuple((x.chain.shape, x.variant, x.chain.panel, x.chain.anchor, x.chain.along.tobytes()) for x in (a, b))
    if key not in own.agreed:
        first, second = ((x.patch, x.variant, x.chain.span) for x in (a, b))
        own.agreed[key] = can_agree(problem, first, second)
    return own.agreed[key]


def _share_bases(a: Lane, b: Lane) -> bool:
    return a.chain.far is not None and {a.chain.anchor, a.chain.far} == {b.chain.anchor, b.chain.far}


def _beside(problem: Problem, own: Repertoire, many: list[Lane], moving: list[Lane], section: int) -> Batch | None:
    """Those of `many` that stand still in a section on bases of those that fold in it."""
    touched = {b for x in moving if section in x.active for b in (x.chain.anchor, x.chain.far)}
    near = [x for x in many if x.chain.anchor in touched or x.chain.far in touched]
    found = resting(problem, own, near, section)
    return _parted(own, found) if found is not None else None


def _never_compared(own: Repertoire, fresh: list[Lane]) -> tuple[Bools, Bools]:
    """(lanes, lanes) those of one patch and those that drag bases along different ways, which never go together; and
    these and, of two fresh lanes, the second with the first.
    """
    patch, way = _patches(own), _ways(own)
    is_fresh = np.zeros(len(own.lanes), dtype=bool)
    is_fresh[[x.number for x in fresh]] = True
    number = np.arange(len(own.lanes))
    same: Bools = (patch[:, None] == patch) | (way[:, None] != way)
    return same, same | (is_fresh[:, None] & is_fresh & (number[:, None] >= number))


def _patches(own: Repertoire) -> Indices:
    """(lanes,) the patch of each lane, by number."""
    number = {p: i for i, p in enumerate(own.unit.patches)}
    return np.array([number[x.patch] for x in own.lanes])


def _ways(own: Repertoire) -> Indices:
    """(lanes,) a number for each way in which lanes drag the bases of their unit, 0 for those that drag none."""
    if all(x.drag is None for x in own.lanes):
        return np.zeros(len(own.lanes), dtype=np.int64)
    # Only a unit of two bases that all its patches join has lanes that drag any (section 5.3).
    found: list[Array] = []
    numbers = []
    for x in own.lanes:
        alike = (i for i, way in enumerate(found) if np.abs(x.way - way).max() < SAME_PLACE)
        number = next(alike, len(found)) if x.drag is not None else -1
        if number == len(found):
            found.append(x.way)
        numbers.append(number + 1)
    return np.array(numbers)


def meet_across(problem: Problem, own: Repertoire, many: list[Lane], others: list[Lane]) -> set[tuple[int, int]]:
    """Which of some lanes meet which others of other patches, by number, where they drag bases along different ways.

    They never go together, so this is no part of the conflict graph; it tells why a patch does not fold by one of them.
    """
    found: set[tuple[int, int]] = set()
    patch, way = _patches(own), _ways(own)
    never = (way[:, None] == way) | (patch[:, None] == patch)
    for section in range(own.nominal.sections) if way.any() else ():
        a, b = swept(problem, own, many, section), swept(problem, own, others, section)
        if a is not None and b is not None:
            for _, p, q in meetings(a, b, never):
                found.update(zip(a.lane[p].tolist(), b.lane[q].tolist(), strict=True))
    return found


def _learn(own: Repertoire, met: Mapping[tuple[int, int], Bools]) -> None:
    """Keeps which pieces of lanes, told apart, meet."""
    for (a, b), pieces in met.items():
        key, found = ((a, b), pieces) if a < b else ((b, a), pieces.T)
        for known, at in ((own.parts, key), (own.pieces, (key[0] // 2, key[1] // 2))):
            known[at] = known[at] | found if at in known else found


def _table(
    problem: Problem, own: Repertoire, first: tuple[Lane, ...], second: tuple[Lane, ...], inside: Array, *,
    in_modes: bool, is_bare: bool,
) -> Bools:  # fmt: skip
    steps, count = inside.shape[1], len(inside)
    met = np.zeros((len(first), steps, len(second), steps), dtype=bool)
    never = np.zeros((len(first), len(second)), dtype=bool)
    for i, a in enumerate(first):
        for j, b in enumerate(second):
            for p in {a.number, own.plain_of.get(a.number, a.number)}:
                for q in {b.number, own.plain_of.get(b.number, b.number)}:
                    pieces = _panels_met(own, p, q) if is_bare else pieces_met(own.pieces, p, q)
                    if pieces is not None:
                        met[i, :, j] |= pieces
            never[i, j] = not (in_modes or drag_alike(a, b)) or not snap_alike(problem, own, a, b)
    made = _of_windows(met, never, inside, count)
    for i, a in enumerate(first) if is_bare else ():
        for j, b in enumerate(second):
            if pieces_met(own.pieces, a.number, b.number) is not None:
                block = made[i * count : (i + 1) * count, j * count : (j + 1) * count]
                block |= _without_room(problem, own, a, b, inside)
    return made


def may_be_interrupted(own: Repertoire, x: Lane) -> bool:
    """Whether there may be more lanes that do the same with less of its hinges."""
    return x.variant.hinged == WHOLE and x.number not in own.interrupted


def are_in_the_way(own: Repertoire) -> bool:
    """Whether any two lanes meet where only hinges do that may still be interrupted."""
    bare = ((pieces, _panels_met(own, p, q)) for (p, q), pieces in own.pieces.items())
    return any(panels is None or bool((pieces & ~panels).any()) for pieces, panels in bare)


def _panels_met(own: Repertoire, p: int, q: int) -> Bools | None:
    """Which pieces of two lanes meet without what may still be interrupted, those of the first one first."""
    found: Bools | None = None
    for i in range(1 if may_be_interrupted(own, own.lanes[p]) else 2):
        for j in range(1 if may_be_interrupted(own, own.lanes[q]) else 2):
            pieces = pieces_met(own.parts, 2 * p + i, 2 * q + j)
            if pieces is not None:
                found = pieces if found is None else found | pieces
    return found


def _without_room(problem: Problem, own: Repertoire, x: Lane, y: Lane, inside: Array) -> Bools:
    """(w, w) by windows of two lanes, whether hinges that may be interrupted have no room beside the other lane."""
    loose = [may_be_interrupted(own, lane) for lane in (x, y)]
    hinges: list[tuple[int, ...]] = [(1,) if is_loose else () for is_loose in loose]
    firm: list[tuple[int, ...]] = [(0,) if is_loose else (0, 1) for is_loose in loose]
    beside, below = _met(own, x, hinges[0], y, firm[1]), _met(own, x, firm[0], y, hinges[1])
    between = _met(own, x, hinges[0], y, hinges[1])
    if not (beside.any() or below.any() or between.any()):
        return np.zeros((len(inside), len(inside)), dtype=bool)
    (kept, may), (others, might) = (_kept(problem, own, lane, inside) for lane in (x, y))
    # By windows and the stretch of either lane, whether it has room beside what stays of the other one.
    first = may[:, None] & (kept @ beside @ inside.T == 0).T
    second = might & (inside @ below @ others.T == 0)[:, None]
    free = (kept @ between @ others.T == 0).astype(np.float32)
    found: Bools = ~((first.astype(np.float32) @ free > 0) & second).any(2)
    return found


def _met(own: Repertoire, x: Lane, parts: tuple[int, ...], y: Lane, others: tuple[int, ...]) -> Array:
    """(N_s, N_s) more than 0 where pieces of some parts of two lanes meet, 0 for panels and 1 for knuckles and feet."""
    steps = len(x.cuts) - 1
    found: Array = np.zeros((steps, steps), dtype=np.float32)
    for i, j in itertools.product(parts, others):
        pieces = pieces_met(own.parts, 2 * x.number + i, 2 * y.number + j)
        if pieces is not None:
            found += pieces
    return found


def _kept(problem: Problem, own: Repertoire, x: Lane, inside: Array) -> tuple[Array, Bools]:
    """(s, N_s) the pieces with knuckles, in all windows and then in all stretches of a lane, and which of these each
    window (w, s) may have: all its own, or a stretch within.
    """
    if x.number not in own.knuckled:
        kept = np.zeros((len(marks := stretches(problem, own, x)), inside.shape[1]), dtype=np.float32)
        for row, (a, b) in zip(kept, marks, strict=True):
            row[a:b] = 1
        within = ~((inside[:, None] == 0) & (kept > 0)).any(2)
        may = np.concatenate([np.eye(len(inside), dtype=bool), within], axis=1)
        own.knuckled[x.number] = np.concatenate([inside, kept]), may
    return own.knuckled[x.number]


def _of_windows(met: Bools, never: Bools, inside: Array, count: int) -> Bools:
    """Which options conflict: those whose pieces meet (n, N_s, m, N_s), and lanes that never go together (n, m)."""
    shape = (met.shape[0] * count + 1, met.shape[2] * count + 1)
    found = np.zeros(shape, dtype=bool)
    if met.any() or never.any():
        # How many pieces meet up to every two cuts tells how many do within any two windows.
        total = np.zeros((met.shape[0], met.shape[1] + 1, met.shape[2], met.shape[3] + 1), dtype=np.int64)
        total[:, 1:, :, 1:] = met.cumsum(1).cumsum(3)
        first = inside.argmax(1)
        last = first + np.count_nonzero(inside, axis=1)
        rows = total[:, last] - total[:, first]
        held = rows[..., last] > rows[..., first]
        held |= never[:, None, :, None]
        found[:-1, :-1] = held.reshape(shape[0] - 1, shape[1] - 1)
    return found
