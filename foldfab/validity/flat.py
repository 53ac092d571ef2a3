"""A solution as the paper's own scaffold: patches without thickness (sections 4 and 5.3).

The modifications and the widths that chains keep decide: hinges stand at equal intervals (figure 9), units fold in the
order of the steps. Within a unit a press comes down and takes each base with it as it gets there, so that
higher ones start first (figure 11a). A chain in place follows its bases exactly; where it leans at first it is one
long panel against the others, which turn in line until they stand upright and in a zig-zag from there.

Bases of parts at several heights are no patches in the paper's sense: their parts are laid into one plane, the lowest,
and what stands on them reaches down to it. Plinths are a matter of thickness, so that there are none.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from foldfab.folding.model import Chain, FoldSolution, Modification, Step
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, stacked
from foldfab.scaffold.model import BasePatch
from foldfab.validity.claim import angles_of, apart, axes_of, frame, hinges_of, root_first, step_of
from foldfab.validity.model import Body, Folding, Hinge, Linkage, no_slip

UP = np.array([0.0, 0.0, 1.0])
INTERVALS = 24
"""Moments of each section of a unit's fold, between the starts of two bases."""
ROUNDS = 60
"""Bisections by which a tilt is found: all digits."""
QUARTER = np.pi / 2


@dataclass(frozen=True, slots=True, eq=False)
class Strip:
    """A patch without thickness as it folds."""

    chain: Chain
    """For its plane, its bases and the names of its panels."""
    step: Step
    root: Array
    """(3,) on the first hinge, open posture, mm."""
    lean: float
    side: float
    """+1 where the first panel folds towards `across`, -1 where away from it."""
    is_slanted: bool
    lengths: Array
    """(m,) mm."""
    clear: float
    """Height from the anchor to the far base, or to the tip, mm."""


def folding(solution: FoldSolution) -> Folding:
    """The folding transform of the same modifications without thickness."""
    down = {step.unit: ways(solution, step) for step in solution.steps}
    strips = [_strip(solution, chain) for chain in solution.chains]
    bodies = [Body(base.name, _sheet(base), UP, is_base=True) for base in solution.scaffold.bases]
    hinges: list[Hinge] = []
    for strip in strips:
        points = axes_of(strip.root, strip.chain, strip.lengths, np.zeros(len(strip.lengths) + 1), strip.lean)
        hinges += hinges_of(strip.chain, points, 0.0, 0.0)
        bodies += _panels(strip, points)

    def angles(times: Array) -> Array:
        made = [angles_of(s.chain, tilts(s, down[s.step.unit], times), s.lean) for s in strips]
        return np.concatenate([np.zeros((len(times), 0)), *made], axis=1)

    linkage = Linkage(root_first(solution, bodies), tuple(hinges))
    where = apart(np.concatenate([[0.0, 1.0], *(_moments(s, down[s.unit]) for s in solution.steps)]))
    return Folding("without thickness", linkage, where, angles, lambda times: no_slip(times, len(hinges)))


def ways(solution: FoldSolution, step: Step) -> dict[str, float]:
    """How far each base of a unit comes down until all lie in the plane of the lowest one, mm."""
    held = [chain for chain in solution.chains if chain.patch in step.fold and chain.far is not None]
    own = {base for chain in held for base in (chain.anchor, chain.far)}
    height = {base.name: base.bottom for base in solution.scaffold.bases if base.name in own}
    return {name: z - min(height.values()) for name, z in height.items()}


def tilts(strip: Strip, down: Mapping[str, float], times: Array) -> Array:
    """Tilts (k, m) of a strip's panels, radians."""
    local = np.clip((times - strip.step.start) / (strip.step.end - strip.step.start), 0.0, 1.0)
    far = strip.chain.far
    if strip.is_slanted or far is None:
        zigzag = strip.side * QUARTER * np.where(np.arange(len(strip.lengths)) % 2 == 0, 1.0, -1.0)
        turned: Array = strip.lean + local[:, None] * (zigzag - strip.lean)
        return turned
    level = _press(down, local)
    drop = np.maximum(down[far] - level, 0.0) - np.maximum(down[strip.chain.anchor] - level, 0.0)
    return in_place(strip, strip.clear - drop)


def in_place(strip: Strip, height: Array) -> Array:
    """Tilts (k, m) of the panels where the far end stands straight below its open place at heights (k,) over the root.

    Seen from the side to which the long panel folds, the others start at tilt ψ = |lean| and end at -π/2. With n of
    them of length a, and ℓ the long one, ℓ sin β balances them: n a sin ψ while they are in line, a sin ψ in a zig-zag.
    """
    folds_with = strip.side * strip.lean > 0
    lengths = strip.lengths[::-1] if folds_with else strip.lengths
    n, a, long = len(lengths) - 1, float(lengths[0]), float(lengths[-1])
    shift = float(lengths.sum()) * np.sin(abs(strip.lean))
    is_moving = (height > 0) & (height < strip.clear)
    low, high = np.full(int(is_moving.sum()), -QUARTER), np.full(int(is_moving.sum()), abs(strip.lean))
    for _ in range(ROUNDS if is_moving.any() else 0):
        psi = (low + high) / 2
        is_low = n * a * np.cos(psi) + long * np.cos(_balance(psi, n, a, long, shift)) < height[is_moving]
        low, high = np.where(is_low, psi, low), np.where(is_low, high, psi)
    psi = np.where(height <= 0, -QUARTER, abs(strip.lean))
    psi[is_moving] = (low + high) / 2
    beta = np.where(height <= 0, QUARTER, _balance(psi, n, a, long, shift))
    turn = np.where(np.arange(n) % 2 == 0, 1.0, -1.0)
    short = np.where(psi[:, None] >= 0, psi[:, None], psi[:, None] * turn)
    found = np.concatenate([short, beta[:, None]], axis=1)
    return strip.side * found[:, ::-1] if folds_with else -strip.side * found


def _balance(psi: Array, n: int, a: float, long: float, shift: float) -> Array:
    """Tilt of the long panel."""
    found: Array = np.arcsin(np.minimum((shift - np.where(psi >= 0, n, 1) * a * np.sin(psi)) / long, 1.0))
    return found


def _press(down: Mapping[str, float], local: Array) -> Array:
    """Level of the press (k,) above the end, mm: each section from one base's start to the next turns evenly."""
    marks = _levels(down)
    section = np.clip(local * (len(marks) - 1), 0.0, len(marks) - 1.0)
    at = np.minimum(section.astype(np.int64), len(marks) - 2)
    edge = np.array(marks)
    level: Array = edge[at + 1] + (edge[at] - edge[at + 1]) * np.cos((section - at) * QUARTER)
    return np.where(local >= 1.0, 0.0, level)


def _levels(down: Mapping[str, float]) -> list[float]:
    """Where bases start, highest first, and 0."""
    marks = sorted({round(way, 6): way for way in down.values()}.values(), reverse=True)
    return [*(mark for mark in marks if mark > 1e-6), 0.0] if max(marks, default=0.0) > 1e-6 else [0.0, 0.0]


def _moments(step: Step, down: Mapping[str, float]) -> Array:
    count = INTERVALS * (len(_levels(down)) - 1)
    return step.start + (step.end - step.start) * np.arange(count + 1) / count


def _strip(solution: FoldSolution, chain: Chain) -> Strip:
    patch, step = solution.scaffold.patch(chain.patch), step_of(solution, chain.patch)
    change = solution.modification(chain.patch)
    plane = solution.scaffold.base(chain.anchor).bottom
    root = patch.center + patch.up * (plane - patch.center[2]) / patch.up[2]
    up = patch.up * np.sign(patch.up @ chain.rise)
    lean = float(np.arctan2(up @ chain.across, up @ chain.rise))
    clear = _clear(solution, chain)
    side = 1.0 if change.side == "r" else -1.0
    lengths = _intervals(clear / np.cos(lean), lean, side, change, ends_free=chain.far is None)
    return Strip(chain, step, root, lean, side, change.mechanism == "slanted", lengths, clear)


def _intervals(length: float, lean: float, side: float, change: Modification, *, ends_free: bool) -> Array:
    """Lengths of the panels: equal, but for the one that is longer by how far the far end stands aside (figure 9)."""
    count = change.hinges + 1
    aside = 0.0 if ends_free or change.mechanism == "slanted" else length * abs(np.sin(lean))
    lengths = np.full(count, (length - aside) / count)
    lengths[0 if side * lean > 0 else -1] += aside
    return lengths


def _clear(solution: FoldSolution, chain: Chain) -> float:
    """Height from a chain's anchor to its far base or its tip in the open posture, mm."""
    patch = solution.scaffold.patch(chain.patch)
    start = solution.scaffold.base(chain.anchor).bottom
    if chain.far is not None:
        return abs(solution.scaffold.base(chain.far).bottom - start)
    tip = patch.center[2] + np.sign(chain.rise[2]) * abs(patch.up[2]) * patch.length / 2
    return abs(float(tip) - start)


def _sheet(base: BasePatch) -> Boxes:
    """The outlines of a base in its plane."""
    made = []
    for outline in base.outlines:
        along = np.array([*outline.along, 0.0])
        axes = np.stack([along, np.cross(UP, along), UP])
        made.append(Boxes(np.array([[*outline.center, base.bottom]]), axes[None], np.array([[*outline.half, 0.0]])))
    return stacked(made)


def _panels(strip: Strip, points: Array) -> list[Body]:
    """The rectangles between the hinges of a strip."""
    chain, (normal, up) = strip.chain, frame(strip.chain, strip.lean)
    made = []
    for i, name in enumerate(chain.panels):
        center = (points[i] + points[i + 1]) / 2 + chain.along * float(chain.span.mean())
        half = np.array([[0.0, float(np.ptp(chain.span)) / 2, strip.lengths[i] / 2]])
        made.append(Body(name, Boxes(center[None], np.stack([normal, chain.along, up])[None], half), normal))
    return made
