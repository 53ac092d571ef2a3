"""What a solution says about time: how far each patch is folded and where each base is. Read from its data alone."""

from __future__ import annotations

import numpy as np

from foldfab.folding.model import Chain, FoldSolution, Step
from foldfab.geometry.arrays import Array
from foldfab.validity.model import Body, Hinge

SAME_MOMENT = 1e-12
"""Times closer than this are one."""


def sampled(step: Step, values: Array, times: Array) -> Array:
    """Values (k,) or (k, 3) of a step at any times, held before and after it."""
    local = (times - step.start) / (step.end - step.start)
    columns = values.reshape(len(step.samples), -1).T
    found = np.stack([np.interp(local, step.samples, column) for column in columns], axis=1)
    return found[:, 0] if values.ndim == 1 else found


def step_of(solution: FoldSolution, patch: str) -> Step:
    """The step that folds a patch.

    Raises:
        StopIteration: no step does.
    """
    return next(step for step in solution.steps if patch in step.fold)


def moments(solution: FoldSolution) -> Array:
    """All times (k,) at which the solution samples its motion, 0 and 1 included."""
    times = [step.start + step.samples * (step.end - step.start) for step in solution.steps]
    return apart(np.concatenate([*times, [0.0, 1.0]]).clip(0.0, 1.0))


def apart(times: Array) -> Array:
    """Times in ascending order, each once; steps meet in the same moment up to rounding."""
    found: Array = np.unique(times)
    kept: Array = found[np.append(True, np.diff(found) > SAME_MOMENT)]
    kept[-1] = found[-1]
    return kept


def bases_at(solution: FoldSolution, times: Array) -> dict[str, Array]:
    """By base, the translation (k, 3) since the open posture that the solution states, mm."""
    found = {base.name: np.zeros((len(times), 3)) for base in solution.scaffold.bases}
    for step in solution.steps:
        for base in found:
            if base in step.travel:
                found[base] += sampled(step, step.travel[base], times)
    return found


def axes_of(root: Array, chain: Chain, lengths: Array, offsets: Array, lean: float) -> Array:
    """(m + 1, 3) points on the hinge axes of an open chain, the tip of a T last, mm."""
    normal, up = frame(chain, lean)
    steps = np.diff(offsets)[:, None] * normal + lengths[:, None] * up
    points: Array = root + np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    return points


def frame(chain: Chain, lean: float) -> tuple[Array, Array]:
    """(3,) face normal and (3,) direction from the anchor on, of an open panel."""
    sin, cos = np.sin(lean), np.cos(lean)
    return cos * chain.across - sin * chain.rise, sin * chain.across + cos * chain.rise


def hinges_of(chain: Chain, points: Array, base_room: float, room: float) -> list[Hinge]:
    """The hinges of a chain from the anchor to the far base, at points (m + 1, 3)."""
    names = chain.panels
    found = [Hinge(chain.anchor, names[0], points[0], chain.along, base_room)]
    found += [Hinge(names[i], names[i + 1], points[i + 1], chain.along, room) for i in range(len(names) - 1)]
    if chain.far is not None:
        found.append(Hinge(chain.far, names[-1], points[-1], chain.along, base_room))
    return found


def angles_of(chain: Chain, tilts: Array, lean: float) -> Array:
    """Angles (k, h) of the hinges of a chain, in the order of `hinges_of`, for tilts (k, m) of its panels."""
    against = np.concatenate([np.full((len(tilts), 1), lean), tilts], axis=1)
    found = np.diff(against, axis=1)
    far = tilts[:, -1:] - lean
    made: Array = np.concatenate([found, far], axis=1) if chain.far is not None else found
    return made


def root_first(solution: FoldSolution, bodies: list[Body]) -> tuple[Body, ...]:
    """The bodies with the lowest base, which stays where it is, in front."""
    root = solution.scaffold.bases[0].name
    return tuple(sorted(bodies, key=lambda body: body.name != root))
