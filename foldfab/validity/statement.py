"""Whether a solution starts at the modified furniture (definition 4), and says one thing everywhere (condition i)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from foldfab.folding.model import Chain, FoldSolution, Modification, Thickness
from foldfab.geometry.arrays import Array
from foldfab.scaffold.model import Patch
from foldfab.validity.claim import axes_of, frame
from foldfab.validity.model import Violation
from foldfab.validity.pockets import unsound
from foldfab.validity.thick import faces

EXACT = 1e-3
"""How far lengths may be from what is stated, mm: the grid of places in print."""
FACTOR = 1e-9
"""How far shares, directions and times may be from what is stated."""


def contradictions(solution: FoldSolution) -> tuple[Violation, ...]:
    """What in a solution contradicts itself or its scaffold, before anything moves."""
    found = [*_of_modifications(solution), *_of_steps(solution), *_of_pockets(solution)]
    changes = {change.patch: change for change in solution.modifications}
    patches = {patch.name: patch for patch in solution.scaffold.patches}
    for chain in solution.chains:
        if chain.patch in changes and chain.patch in patches and not changes[chain.patch].is_deleted:
            for amount, told in _of_chain(solution, chain, changes[chain.patch], patches[chain.patch]):
                found.append((chain.patch, amount, told))
    return tuple(
        Violation("start", "", 0.0, (patch,), float(amount), f"at t = 0: {patch} {told}")
        for patch, amount, told in found
    )


def _of_modifications(solution: FoldSolution) -> Iterator[tuple[str, float, str]]:
    """Each foldable patch is modified once, and has a chain unless it is deleted."""
    chains, changed = [c.patch for c in solution.chains], [m.patch for m in solution.modifications]
    known = {patch.name for patch in solution.scaffold.patches}
    gone = {m.patch for m in solution.modifications if m.is_deleted}
    for patch in sorted(known | set(chains) | set(changed)):
        if patch not in known:
            yield patch, 0.0, "is no patch of the scaffold"
        elif changed.count(patch) != 1:
            yield patch, 0.0, f"has {changed.count(patch)} modifications instead of one"
        elif chains.count(patch) != (patch not in gone):
            yield patch, 0.0, f"is {'deleted' if patch in gone else 'kept'} but has {chains.count(patch)} chains"


def _of_steps(solution: FoldSolution) -> Iterator[tuple[str, float, str]]:
    """The steps follow one another from 0 to 1, each patch folds in one of them, from open to folded."""
    end = 0.0
    for step in solution.steps:
        if abs(step.start - end) > FACTOR or step.end <= step.start:
            yield step.unit, abs(step.start - end), f"begins to fold at t = {step.start:.3f} instead of {end:.3f}"
        if step.samples[0] != 0 or step.samples[-1] != 1 or (np.diff(step.samples) <= 0).any():
            yield step.unit, 0.0, "has samples that do not ascend from 0 to 1"
        for patch, fold in step.fold.items():
            if fold.min() < -FACTOR or fold.max() > 1 + FACTOR:
                yield patch, 0.0, "is said to be folded beyond flat or open"
        end = step.end
    if abs(end - 1) > FACTOR:
        yield solution.steps[-1].unit if solution.steps else "the fold", abs(end - 1), f"ends at t = {end:.3f}"
    for chain in solution.chains:
        times = sum(chain.patch in step.fold for step in solution.steps)
        if times != 1:
            yield chain.patch, 0.0, f"folds in {times} steps instead of one"


def _of_pockets(solution: FoldSolution) -> Iterator[tuple[str, float, str]]:
    """What chains sink into stays sound."""
    yield from unsound(solution, {b.name: faces(b, solution.thickness) for b in solution.scaffold.bases})


def _of_chain(solution: FoldSolution, chain: Chain, change: Modification, patch: Patch) -> Iterator[tuple[float, str]]:
    """A chain is its modified patch."""
    count, is_t = len(chain.lengths) - 1, chain.far is None
    if (chain.mechanism, count) != (change.mechanism, change.hinges):
        yield 0.0, f"is stated {change.mechanism} with {change.hinges} hinges but is {chain.mechanism} with {count}"
    if np.sign(chain.turn) != {"l": -1, "r": 1}.get(change.side or "") or abs(abs(chain.turn) - np.pi / 2) > FACTOR:
        yield 0.0, "folds to another side than is stated"
    if {chain.anchor, chain.far} - {None} != set(patch.bases):
        yield 0.0, "is held by other bases than in the scaffold"
        return
    if count > (solution.scaffold.recipe.fold.max_hinges if patch.hingeable else 0):
        yield 0.0, f"has {count} hinges, more than it may"
    if not is_t and count % 2 != (chain.mechanism == "in-place"):
        yield 0.0, f"is {chain.mechanism} with {count} hinges between two bases"
    yield from _of_window(chain, change, patch, solution.thickness)
    yield from _of_breaks(chain, solution.thickness.of(chain.panel).hinge_width)
    yield from _of_place(solution, chain, patch)
    yield from _of_intervals(chain, is_t=is_t)


def _of_window(chain: Chain, change: Modification, patch: Patch, thickness: Thickness) -> Iterator[tuple[float, str]]:
    """The panels lie in their window; a whole patch may be widened to one hinge."""
    low, high = (share * patch.width - patch.width / 2 for share in change.window)
    over = max(low - chain.span[0], chain.span[1] - high)
    width = float(np.ptp(chain.span))
    is_widened = change.window == (0, 1) and width <= thickness.of(chain.panel).hinge_width + EXACT
    if not (0 <= change.window[0] < change.window[1] <= 1) or width < EXACT or (over > EXACT and not is_widened):
        yield float(over), f"reaches {max(over, 0.0):.2f} mm out of its window"


def _of_breaks(chain: Chain, least: float) -> Iterator[tuple[float, str]]:
    """Breaks follow one another, and leave each hinge a stretch that holds it."""
    ends = [end for mark in chain.breaks for end in mark]
    if sorted(ends) != ends:
        yield 0.0, "has breaks in its hinges that do not ascend"
        return
    for name, (low, high) in zip(chain.bodies[1:], chain.hinge_spans.tolist(), strict=False):
        free = [low, *(min(max(end, low), high) for end in ends), high]
        widest = max(b - a for a, b in zip(free[::2], free[1::2], strict=True))
        if chain.breaks and widest < least - EXACT:
            yield least - widest, f"has no more than {widest:.2f} mm of the hinge at {name}, too little to hold it"


def _of_place(solution: FoldSolution, chain: Chain, patch: Patch) -> Iterator[tuple[float, str]]:
    """The open chain lies in its patch, and its first and last axis stand as high as their feet and plinths."""
    normal, up = frame(chain, chain.lean)
    if abs(abs(up @ patch.up) - 1) > FACTOR or abs(abs(chain.along @ patch.along) - 1) > FACTOR:
        yield float(np.arccos(np.clip(abs(up @ patch.up), -1, 1))), "does not lie in its patch"
    aside = chain.root - patch.center
    off = float(np.hypot(aside @ normal, aside @ chain.along))
    if off > EXACT:
        yield off, f"stands {off:.2f} mm beside its patch"
    ends = axes_of(chain.root, chain, chain.lengths, chain.offsets, chain.lean)[[0, -1], 2]
    for base, height, pad, out in zip(
        (chain.anchor, chain.far), ends, chain.pads, (chain.rise[2], -chain.rise[2]), strict=True
    ):
        wanted = _axis_height(solution, base, chain, patch, float(out), pad)
        if abs(height - wanted) > EXACT or (base is None and pad < 0):
            where = f"over {base}" if base else "at its tip"
            yield abs(height - wanted), f"ends {abs(height - wanted):.2f} mm off its place {where}"


def _axis_height(solution: FoldSolution, base: str | None, chain: Chain, patch: Patch, out: float, pad: float) -> float:
    """Where a hinge axis on that base belongs, or the tip of a T, mm."""
    if base is None:
        return float(patch.center[2] - out * abs(patch.up[2]) * patch.length / 2)
    low, high = faces(solution.scaffold.base(base), solution.thickness)
    return (high if out > 0 else low) + out * (solution.thickness.of(chain.panel).axis_height + pad)


def _of_intervals(chain: Chain, *, is_t: bool) -> Iterator[tuple[float, str]]:
    """Hinges at equal intervals, but for one panel where the patch leans (section 5.3, figure 9)."""
    aside = 0.0 if is_t or chain.mechanism == "slanted" else float(chain.lengths.sum()) * abs(np.sin(chain.lean))
    equal: Array = chain.lengths.copy()
    equal[0 if chain.turn * chain.lean > 0 else -1] -= aside
    if np.ptp(equal) > EXACT or (chain.lengths <= 0).any():
        yield float(np.ptp(equal)), "has its hinges at unequal intervals"
