"""Where everything is at any time t of the fold, with the true hinge axes of the thick mechanism.

A folding transform (definition 3) over the whole furniture: the steps follow one another, and within a step bases
translate and panels turn about their hinge axes. The furniture's lowest base stays where it is.
"""

from __future__ import annotations

import numpy as np

from foldfab.folding.anatomy import anchor_feet, base_boxes, far_feet, moving_boxes
from foldfab.folding.mechanism import frames
from foldfab.folding.model import Chain, FoldSolution, Step
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, bounds, grown, stacked

FOOT_RIM = 0.5
"""How far plates may reach beyond the feet on them, mm."""


def key_times(solution: FoldSolution) -> Array:
    """Times (k,) from 0 to 1 between which the motion may be interpolated."""
    times = [np.array([0.0])]
    times += [step.start + step.samples[1:] * (step.end - step.start) for step in solution.steps]
    times.append(np.array([1.0]))
    found: Array = np.unique(np.concatenate(times))
    return found


def configuration(solution: FoldSolution, times: Array) -> dict[str, Array]:
    """Rigid motions (k, 4, 4) from the open posture of every base and every panel, by name, at times (k,)."""
    t = np.asarray(times, dtype=np.float64)
    bases = {base.name: _travelled(solution, base.name, t) for base in solution.scaffold.bases}
    found = {name: _translations(way) for name, way in bases.items()}
    for chain in solution.chains:
        found.update(_panels(chain, *_progress(solution, chain, t), bases[chain.anchor]))
    return found


def size_at(solution: FoldSolution, time: float, turn: Array) -> Array:
    """(3,) size of everything at a time, in axes turned from the canonical frame by `turn` (3, 3), mm.

    Feet and knuckles are boxes here, so that it is never less than the size of the solids.
    """
    thickness, t = solution.thickness, np.array([time])
    ends = {b.name: _travelled(solution, b.name, t)[0] for b in solution.scaffold.bases}
    parts = [(base_boxes(b, thickness), ends[b.name]) for b in solution.scaffold.bases]
    for chain in solution.chains:
        progress, _ = _progress(solution, chain, t)
        parts.append((moving_boxes(chain, thickness, progress)[0], ends[chain.anchor]))
        parts.append((grown(anchor_feet(chain, thickness), FOOT_RIM), ends[chain.anchor]))
        if chain.far is not None:
            parts.append((grown(far_feet(chain, thickness), FOOT_RIM), ends[chain.far]))
    every = stacked([boxes for boxes, _ in parts])
    shift = np.repeat([way for _, way in parts], [len(boxes) for boxes, _ in parts], axis=0)
    low, high = bounds(Boxes((every.center + shift) @ turn.T, every.axes @ turn.T, every.half))
    size: Array = high.max(0) - low.min(0)
    return size


def _travelled(solution: FoldSolution, base: str, t: Array) -> Array:
    """(k, 3) translation of a base since the open posture."""
    total = np.zeros((len(t), 3))
    for step in solution.steps:
        if base in step.travel:
            total += _sampled(step, step.travel[base], t)
    return total


def _progress(solution: FoldSolution, chain: Chain, t: Array) -> tuple[Array, Array]:
    """Fold progress (k,) of a chain, and (k,) mm that the play in its hinges covers."""
    step = next(s for s in solution.steps if chain.patch in s.fold)
    return _sampled(step, step.fold[chain.patch], t), _sampled(step, step.play[chain.patch], t)


def _sampled(step: Step, values: Array, t: Array) -> Array:
    """Values (k, …) of a step at global times, held before it starts and after it ends."""
    local = (t - step.start) / (step.end - step.start)
    if values.ndim == 1:
        return np.interp(local, step.samples, values)
    return np.stack([np.interp(local, step.samples, column) for column in values.T], axis=1)


def _panels(chain: Chain, progress: Array, play: Array, base: Array) -> dict[str, Array]:
    """Motions of the chain's panels; the play is shared evenly by its hinges."""
    origins, axes = frames(chain, progress)
    open_origins, open_axes = frames(chain, np.zeros(1))
    found = {}
    for i, name in enumerate(chain.panels):
        turn = np.einsum("kaj,ai->kji", axes[:, i], open_axes[0, i])
        share = (i + 1) / (len(chain.lengths) + 1)
        place = origins[:, i] + base + share * play[:, None] * chain.rise
        pose = np.tile(np.eye(4), (len(progress), 1, 1))
        pose[:, :3, :3] = turn
        pose[:, :3, 3] = place - turn @ open_origins[0, i]
        found[name] = pose
    return found


def _translations(way: Array) -> Array:
    pose = np.tile(np.eye(4), (len(way), 1, 1))
    pose[:, :3, 3] = way
    return pose
