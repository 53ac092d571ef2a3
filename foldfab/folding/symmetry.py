"""Parts that mirror each other, treated alike where that is asked for (section 7 names it as future work).

The plane is the upright one through the middle of the furniture in which most patches have their mirror image. Two
patches are treated alike where they fold by the same mechanism with as many hinges and keep mirrored windows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from foldfab.folding.basic import Option
from foldfab.folding.options import Options
from foldfab.folding.problem import Problem
from foldfab.folding.site import Site
from foldfab.geometry.arrays import Array, Bools

TOLERANCE = 0.05
"""mm by which a mirror image may be off."""

Signature = tuple[str, int, tuple[int, int]]
"""Mechanism, hinges and window of an option."""


@dataclass(frozen=True, slots=True)
class Twin:
    """The mirror image of a patch."""

    patch: str
    is_reversed: bool
    """Whether its width is counted from the other end."""


def twins(problem: Problem) -> dict[str, Twin]:
    """By patch that has one, its mirror image; nothing where the recipe does not ask for symmetry."""
    if not problem.options.symmetry:
        return {}
    middle = (problem.outline[0] + problem.outline[1]) / 2
    sites = list(problem.sites.values())
    normals = [v for s in sites for v in (s.across, s.along)]
    distinct = list({tuple(np.round(v * np.sign(v[np.argmax(np.abs(v))]), 6)): v for v in normals}.values())
    return max((_images(sites, middle, n) for n in distinct), key=len, default={})


def signature(option: Option) -> Signature:
    """What counts as alike in an option."""
    v = option.variant
    return (v.mechanism, v.hinges, option.window) if v is not None else ("deleted", 0, (0, 0))


def is_less(first: Signature, second: Signature) -> bool:
    """Whether the first is the second, or only leaves less of the patch."""
    (how, hinges, (low, high)), (other, more, (least, most)) = first, second
    return how == "deleted" or ((how, hinges) == (other, more) and least <= low and high <= most)


def mirrored(own: Signature, steps: int, *, is_reversed: bool) -> Signature:
    """The signature that the mirror image has to have."""
    mechanism, hinges, (low, high) = own
    return (mechanism, hinges, (steps - high, steps - low)) if is_reversed and mechanism != "deleted" else own


def unlike(first: Options, second: Options, steps: int, *, is_reversed: bool) -> Bools:
    """Which options of two mirrored patches are not alike (n, m)."""
    a = [mirrored(signature(first[i]), steps, is_reversed=is_reversed) for i in range(len(first.price))]
    b = [signature(second[j]) for j in range(len(second.price))]
    numbers: dict[Signature, int] = {}
    for found in (*a, *b):
        numbers.setdefault(found, len(numbers))
    different: Bools = np.array([numbers[s] for s in a])[:, None] != np.array([numbers[s] for s in b])
    return different


def bound(problem: Problem, chosen: Mapping[str, Option], patch: str) -> Signature | None:
    """What a patch has to be like because its mirror image is folded already."""
    twin = problem.twins.get(patch)
    if twin is None or twin.patch not in chosen:
        return None
    return mirrored(signature(chosen[twin.patch]), problem.options.shrink_steps, is_reversed=twin.is_reversed)


def _images(sites: list[Site], middle: Array, normal: Array) -> dict[str, Twin]:
    """The patches whose mirror image in a plane through the middle is another patch."""
    found = {}
    centers = np.array([s.patch.center for s in sites])
    for site in sites:
        image = _mirror(site.patch.center - middle, normal) + middle
        along, up = _mirror(site.patch.along, normal), _mirror(site.patch.up, normal)
        for i in np.nonzero(np.abs(centers - image).max(1) < TOLERANCE)[0]:
            other = sites[i].patch
            is_same = (
                abs(other.width - site.patch.width) < TOLERANCE and abs(other.length - site.patch.length) < TOLERANCE
            )
            parallel = abs(abs(other.along @ along) - 1) < 1e-6 and abs(other.up @ up - 1) < 1e-6
            if is_same and parallel and other.name != site.patch.name:
                found[site.patch.name] = Twin(other.name, bool(sites[i].along @ _mirror(site.along, normal) < 0))
    return found


def _mirror(vector: Array, normal: Array) -> Array:
    image: Array = vector - 2 * (vector @ normal) * normal
    return image
