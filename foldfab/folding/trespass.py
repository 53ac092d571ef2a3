"""The whole fold played through once more as the paper's own sheets: what those of one unit cross of all the others.

Within a unit that is a matter of its conflict graph (`sheets`); here bases and the sheets of other units take part
where they are at that moment. While a unit folds in place, a chain between heights a and f meets what a base at height
k > f carries as if that stood k - f lower; what a slanting unit carries along is held against what stays behind too.

What crosses is learned by the pieces of the way of folding that is to blame. Cost: for each unit, bounds of what its
chains pass against those of all sheets; boxes over time only of what is near.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from foldfab.folding.basic import Variant
from foldfab.folding.closeness import DEPTH, STEPS, Moving, crossing
from foldfab.folding.model import Chain
from foldfab.folding.press import follow_down
from foldfab.folding.problem import Crossed, Problem, as_sheet
from foldfab.folding.sheets import ends_of, panels, sheet
from foldfab.folding.spread import Spread, spread
from foldfab.folding.unit_fold import UnitFold
from foldfab.geometry.arrays import Array, Bools, Indices
from foldfab.geometry.boxes import Boxes, near_pairs

Found = dict[tuple[str, Variant], Crossed]
"""By patch and way of folding, what it crosses."""


@dataclass(frozen=True, slots=True, eq=False)
class _Step:
    """A unit about to fold."""

    fold: UnitFold
    own: Indices
    """Places of its chains among all."""
    ends: Indices
    """(chains, 2) place of each chain's bases among the unit's; the same twice for a T-scaffold."""
    height: Array
    """(bases,) how far each comes straight down, mm."""
    slants: Chain | None
    """A chain by which it carries its upper base aside, if it does."""
    length: float
    """Of that chain's sheet, mm."""
    cluster: Indices
    """(n,) of each sheet of the furniture, with which base of the unit it moves."""
    shift: Array
    """(n, 3) how far each sheet has come in relation to the unit, mm."""


def trespasses(problem: Problem, folds: tuple[UnitFold, ...]) -> Found:
    """What the sheets of the first unit in which any do cross of others; nothing if none do."""
    chains = [c for fold in folds for c in fold.chains]
    if not chains or (len(folds) == 1 and len(folds[0].unit.bases) < 3):
        return {}
    table, start = spread(problem.scaffold, chains), 0
    for fold in folds:
        end = start + len(fold.chains)
        step = _step(problem, table, fold, np.arange(start, end))
        found = _crossed(problem, table, step)
        if found:
            return found
        table.lay(step.own)
        table.shift += _moves(step, np.ones(1))[0][fold.cluster]
        start = end
    return {}


def _step(problem: Problem, table: Spread, fold: UnitFold, own: Indices) -> _Step:
    scaffold, place = problem.scaffold, {base: i for i, base in enumerate(fold.unit.bases)}
    ends = np.array([[place[c.anchor], place[c.far or c.anchor]] for c in fold.chains], dtype=np.int64).reshape(-1, 2)
    slants = next((c for c in fold.chains if c.far is not None and c.mechanism == "slanted"), None)
    height, length = np.zeros(len(place)), 0.0
    if slants is not None:
        low, high = ends_of(scaffold, slants)
        length = abs(high - low) / float(np.cos(slants.lean))
    elif len(place) > 1:
        height = np.array([scaffold.base(base).bottom for base in fold.unit.bases])
        height -= height.min()
    cluster = fold.cluster[table.base]
    shift = table.shift - table.shift[problem.tree.number[fold.unit.bases[0]]]
    return _Step(fold, own, ends, height, slants, length, cluster, shift[table.base])


def _moves(step: _Step, local: Array) -> Array:
    """How far each base of a unit has come (k, bases, 3) by the unit's own time (k,), mm.

    Each section from one base's start to the next one's takes as long, and what folds in it turns evenly.
    """
    found = np.zeros((len(local), len(step.height), 3))
    edge, count = np.append(np.unique(step.height)[::-1], 0.0), _sections(step)
    section = np.minimum(local * count, count - 1).astype(np.int64)
    press = edge[section + 1] + (edge[section] - edge[section + 1]) * np.cos((local * count - section) * np.pi / 2)
    found[..., 2] = -np.maximum(step.height - press[:, None], 0.0)
    if step.slants is not None:
        lean, plane = step.slants.lean, step.slants.plane * step.length
        tilt = lean + local * (step.slants.turn - lean)
        (far,) = set(step.ends[:, 1].tolist()) - set(step.ends[:, 0].tolist())
        found[:, far] = np.stack([np.sin(tilt) - np.sin(lean), np.cos(tilt) - np.cos(lean)], axis=1) @ plane
    return found


def _moments(step: _Step) -> Array:
    """The unit's own time (k,) from 0 to 1."""
    return np.linspace(0.0, 1.0, STEPS * _sections(step) + 1)


def _sections(step: _Step) -> int:
    return max(len(np.unique(step.height)) - 1, 1)


def _crossed(problem: Problem, table: Spread, step: _Step) -> Found:
    """What the sheets of a unit, and what it carries along, cross of others."""
    first, second = _near(problem, table, step)
    found: Found = {}
    for i in np.unique(first).tolist():
        found |= _crossed_by(problem, table, step, step.fold.chains[i], second[first == i])
    if not found and step.slants is not None:
        found = _carried_into(problem, table, step)
    return found


def _near(problem: Problem, table: Spread, step: _Step) -> tuple[Indices, Indices]:
    """Chains of a unit and other sheets (k,) that they may come near."""
    low, high = table.low + step.shift, table.high + step.shift
    lift = np.maximum(step.height[step.cluster] - step.height[step.ends[:, 1:]], 0.0)
    near = np.ones(lift.shape, dtype=bool)
    near[:, table.first + step.own] = False
    least, most = ([np.broadcast_to(end[step.own][:, None, k], lift.shape) for k in range(3)] for end in table.swept)
    if step.slants is not None:
        far = (step.cluster == step.ends[:, 1:]) & (step.ends[:, :1] != step.ends[:, 1:])
        least, most = (
            [np.where(far, end[step.own][:, None, k], near) for k, near in enumerate(many)]
            for end, many in zip(table.hung, (least, most), strict=True)
        )
    for k in range(3):
        down = lift if k == 2 else 0.0
        near &= (least[k] + DEPTH < high[:, k] - down) & (low[:, k] - down < most[k] - DEPTH)
    number, plates, patches = problem.tree.number, table.base[: table.first], table.base[table.first :]
    for i, chain in enumerate(step.fold.chains):
        near[i, : table.first] &= (plates != number[chain.anchor]) & (plates != number[chain.far or chain.anchor])
        if chain.far is None:
            # Those that stand on its own base were asked when it was chosen (`sheets.swings_into`).
            near[i, table.first :] &= patches != number[chain.anchor]
    first, second = np.nonzero(near)
    return first, second


def _crossed_by(problem: Problem, table: Spread, step: _Step, chain: Chain, others: Indices) -> Found:
    """What a chain crosses of some sheets, if anything."""
    met = _meets(problem, table, step, chain, others).any(0)
    if not met.any():
        return {}
    within = (c for c in _pieces(problem, chain))
    pieces = tuple(c is not None and bool(_meets(problem, table, step, c, others[met]).any()) for c in within)
    owners = {table.owner[j] for j in others[met]}
    # Where the unit's own bases are is up to nothing else.
    is_always = any(pieces) and owners <= set(step.fold.unit.bases)
    if not any(pieces):
        # No piece alone is wide enough for it.
        pieces = (True,) * len(pieces)
    return _blamed(step, [chain], Crossed(pieces, tuple(sorted(owners)), is_always))


def _meets(problem: Problem, table: Spread, step: _Step, chain: Chain, others: Indices) -> Bools:
    """(panels, n) which panels of a chain of the unit cross which sheets."""
    near, far = step.ends[[c.patch for c in step.fold.chains].index(chain.patch)]
    own = sheet(problem.scaffold, chain)
    comes_down = chain.far is not None and chain.mechanism == "in-place"

    def swung(local: Array) -> Boxes:
        moves = _moves(step, local)
        boxes = panels(own, follow_down(own, moves[:, near, 2] - moves[:, far, 2]) if comes_down else local)
        return Boxes(boxes.center + moves[:, near, None], boxes.axes, boxes.half)

    return crossing(swung, _carried(table, step, others), _moments(step))


def _blamed(step: _Step, chains: Iterable[Chain], crossed: Crossed) -> Found:
    found: Found = {}
    for chain in chains:
        variant = step.fold.chosen[chain.patch].variant
        assert variant is not None
        found[chain.patch, as_sheet(variant)] = crossed
    return found


def _carried_into(problem: Problem, table: Spread, step: _Step) -> Found:
    """What crosses that a unit carries aside and that stays behind; all that carries it is to blame."""
    moves = _moves(step, _moments(step))
    low, high = table.low + step.shift, table.high + step.shift
    is_other = np.ones(len(table.base), dtype=bool)
    is_other[table.first + step.own] = False
    far = int(step.ends[step.ends[:, 0] != step.ends[:, 1], 1][0])
    least, most = moves[:, far].min(0) + DEPTH, moves[:, far].max(0) - DEPTH
    a, b = np.nonzero(is_other & (step.cluster == far))[0], np.nonzero(is_other & (step.cluster != far))[0]
    p, q = near_pairs((low[a] + least, high[a] + most), (low[b], high[b]))
    for i in np.unique(p).tolist():
        others = b[q[p == i]]
        met = crossing(_carried(table, step, a[i : i + 1]), _carried(table, step, others), _moments(step))[0]
        if met.any():
            owners = {table.owner[a[i]], *(table.owner[j] for j in others[met])}
            holding = [c for c in step.fold.chains if c.far is not None]
            whole = (True,) * problem.options.shrink_steps
            return _blamed(step, holding, Crossed(whole, tuple(sorted(owners))))
    return {}


def _carried(table: Spread, step: _Step, others: Indices) -> Moving:
    """Sheets that move with a base of the unit."""
    boxes, start = table.boxes[others], table.boxes.center[others] + step.shift[others]

    def at(local: Array) -> Boxes:
        center = start + _moves(step, local)[:, step.cluster[others]]
        return Boxes(center, np.broadcast_to(boxes.axes, (*center.shape, 3)), np.broadcast_to(boxes.half, center.shape))

    return at


def _pieces(problem: Problem, chain: Chain) -> Iterator[Chain | None]:
    """The chain with each piece of its patch alone, as it is at the end of a window; None where that is cut away."""
    width, steps = problem.sites[chain.patch].patch.width, problem.options.shrink_steps
    cuts, gap = width * (np.arange(steps + 1) / steps - 0.5), problem.thickness.gap / 2
    for span in np.clip(np.stack([cuts[:-1] + gap, cuts[1:] - gap], axis=1), *chain.span):
        yield replace(chain, span=span) if span[1] > span[0] else None
