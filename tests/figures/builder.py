"""Furniture as the paper draws it: named sheets between coordinates, as good as without thickness.

The paper's patches have no thickness and ours have. So the furniture of the figures is some hundred millimetres large,
made of plates of one millimetre and printed one to one: knuckles, feet and stacks are about a hundredth of a patch, and
what a figure says about zero thickness must hold. The limits of the recipe's form do not apply to dataclasses.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from foldfab.folding.basic import Variant, chain, variants
from foldfab.folding.kinematics import configuration
from foldfab.folding.model import Chain, FoldSolution, Modification, Thickness
from foldfab.folding.site import sites
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import FoldOptions, Part, Printer, PrintOptions, Recipe
from foldfab.scaffold.abstract import abstract
from foldfab.scaffold.model import Scaffold

K, GAP = 1.0, 0.1
NEARLY = 6 * K
"""What feet, knuckles and stacks may take from, or add to, a length of the paper, mm."""
DOWN, ACROSS = (0.0, 0.0, -1.0), (-1.0, 0.0, 0.0)

Reach = float | tuple[float, float]
"""From where to where, or the middle of a sheet, mm."""


def sheet(name: str, x: Reach, y: Reach, z: Reach, *, hingeable: bool = True) -> Part:
    """A part that fills a box; a coordinate that is a single number is where the middle of the sheet lies."""
    ends = np.array([r if isinstance(r, tuple) else (r - K / 2, r + K / 2) for r in (x, y, z)])
    return Part(name, ends.mean(1), np.ptp(ends, axis=1), np.eye(3), hingeable)


def leaning(name: str, foot: tuple[float, float], top: tuple[float, float], y: tuple[float, float]) -> Part:
    """A sheet that leans along x, from (x, z) at its foot to (x, z) at its top."""
    (x0, z0), (x1, z1) = foot, top
    length = float(np.hypot(x1 - x0, z1 - z0))
    sin, cos = (x1 - x0) / length, (z1 - z0) / length
    axes = np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
    center = np.array([(x0 + x1) / 2, (y[0] + y[1]) / 2, (z0 + z1) / 2])
    return Part(name, center, np.array([K, y[1] - y[0], length]), axes)


def recipe(*parts: Part, along: tuple[float, float, float] = DOWN, **options: Any) -> Recipe:
    """The recipe of parts, one to one, with options of the fold."""
    printing = PrintOptions(printer=Printer("any", (5e3, 5e3, 5e3)), thickness=K, clearance=GAP, scale=1.0)
    return Recipe("figure", np.array(along), parts, FoldOptions(**options), printing)


def scaffold(*parts: Part) -> Scaffold:
    """The scaffold of parts along -z."""
    return abstract(recipe(*parts), np.array(DOWN), 1.0)


def ways_to_fold(name: str, *parts: Part, **options: Any) -> tuple[Variant, ...]:
    """The folding solutions of a patch in isolation, whatever their window (section 5.3)."""
    site = next(s for s in sites(scaffold(*parts), Thickness(K, GAP)) if s.patch.name == name)
    return variants(site, FoldOptions(**options), Thickness(K, GAP), may_slant=True)


def folded_as(variant: Variant, name: str, *parts: Part) -> Chain:
    """A whole patch as it folds in that way."""
    site = next(s for s in sites(scaffold(*parts), Thickness(K, GAP)) if s.patch.name == name)
    made = chain(site, variant, site.span, Thickness(K, GAP))
    assert made is not None
    return made


def changes(solution: FoldSolution) -> dict[str, Modification]:
    """Modifications by patch."""
    return {m.patch: m for m in solution.modifications}


def kept(modification: Modification) -> float:
    """The share of its width that a patch keeps, 1 - R_s."""
    return modification.window[1] - modification.window[0]


def shrunk(solution: FoldSolution) -> set[str]:
    """The patches that lose some of their width, or all."""
    return {m.patch for m in solution.modifications if kept(m) < 1 - 1e-9}


def way(solution: FoldSolution, body: str, times: int = 61) -> Array:
    """(times, 3) the translation of a base from where it stands open, mm in the canonical frame."""
    found: Array = configuration(solution, np.linspace(0.0, 1.0, times))[body][:, :3, 3]
    return found


def interval(solution: FoldSolution, patch: str) -> tuple[float, float]:
    """[t0, t1] in which a patch folds, as shares of the time of its unit."""
    step = next(step for step in solution.steps if patch in step.fold)
    moving = np.nonzero(np.abs(np.diff(step.fold[patch])) > 1e-6)[0]
    return float(step.samples[moving[0]]), float(step.samples[moving[-1] + 1])
