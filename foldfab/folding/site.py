"""Where each foldable patch stands in the thick model: between which faces, how wide, how far from its neighbours.

Section 5.6: with thickness a panel reaches from base face to base face instead of from base to base, and two panels
that meet in an edge need a gap between them. Cutting that gap costs nothing in eq. 3; it is the price of material.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from foldfab.folding.anatomy import RIM, Face, base_boxes, faces
from foldfab.folding.model import Thickness
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, close_pairs, grown, stacked
from foldfab.geometry.rotation import cross
from foldfab.scaffold.model import BasePatch, Patch, Scaffold

EDGE_THICKNESSES = 2.0
"""Patches that overlap by more than this many K cross each other; the search has to shrink one of them at its cost."""
PROBES = 5
"""Points of a foot's line at which it is asked whether it stands on its plate."""
SIDE_BY_SIDE = np.cos(np.radians(5.0))
"""Patches this parallel meet edge to edge; others meet edge to face."""


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """A foldable patch with thickness, in its open posture."""

    patch: Patch
    importance: float
    """λ."""
    anchor: str
    """The base that carries it: the lower one, or the upper one where it hangs."""
    far: str | None
    """The other base, None for a T-scaffold."""
    across: Array
    """(3,) unit horizontal normal."""
    along: Array
    """(3,) unit hinge direction, across × along = rise."""
    rise: Array
    """(3,) ±Z."""
    lean: float
    """Tilt of the patch, radians."""
    foot: Array
    """(3,) where its middle line meets the anchor's face, mm."""
    clear: float
    """Height from the anchor's face to the far face, or to the tip of a T, mm."""
    span: Array
    """(2,) extent along `along` that neighbours leave free, mm."""
    held: tuple[tuple[float, float], tuple[float, float]]
    """Extent along `along` that the anchor and the far base cover, mm."""
    panel: float
    """K of its panels, mm."""


def sites(scaffold: Scaffold, thickness: Thickness) -> tuple[Site, ...]:
    """The sites of all foldable patches, in their order, trimmed so that no two touch."""
    total = sum(patch.area for patch in scaffold.patches)
    plates = {base.name: _Plate(base, thickness) for base in scaffold.bases}
    made = [_site(patch, patch.area / total, plates, thickness) for patch in scaffold.patches]
    return tuple(_apart(made, thickness))


def slab(site: Site, thickness: Thickness) -> Boxes:
    """The plain open panel (1,) of a patch that nothing was decided about yet."""
    direction = np.sin(site.lean) * site.across + np.cos(site.lean) * site.rise
    length = site.clear / np.cos(site.lean)
    gap, (low, high) = thickness.gap, site.span.tolist()
    reach = (length - gap * (1 if site.far is None else 2)) / 2
    center = site.foot + direction * (gap + reach) + site.along * ((low + high) / 2)
    normal = cross(site.along, direction)
    half = np.array([[site.panel / 2, (high - low) / 2, max(reach, 0.0)]])
    return Boxes(center[None], np.array([[normal, site.along, direction]]), half)


def plate_boxes(base: BasePatch, held: Iterable[Site], thickness: Thickness) -> Boxes:
    """The plate of a base (n,), with what it needs below the feet of patches that stand beside its outlines.

    So does a wall that a shelf meets with its edge.
    """
    plate, found = base_boxes(base, thickness), []
    for site in held:
        for end, name in ((0.0, site.anchor), (site.clear, site.far)):
            if name == base.name:
                foot = site.foot + np.tan(site.lean) * end * site.across
                ends = foot[:2] + np.linspace(site.span[0], site.span[1], PROBES)[:, None] * site.along[:2]
                if not _is_on(ends, plate):
                    found.append((ends.mean(axis=0), site))
    if not found:
        return plate
    center = np.array([[*middle, plate.center[0, 2]] for middle, _ in found])
    axes = np.array([[site.across, site.along, cross(site.across, site.along)] for _, site in found])
    half = [[site.panel / 2 + RIM, float(np.ptp(site.span)) / 2, plate.half[0, 2]] for _, site in found]
    return stacked([plate, Boxes(center, axes, np.array(half))])


def _is_on(points: Array, plate: Boxes) -> bool:
    """Whether any of points (k, 2) lies on any box of a plate, seen from above."""
    offset = points[:, None] - plate.center[:, :2]
    reach = np.abs(np.einsum("nij,knj->kni", plate.axes[:, :2, :2], offset))
    return bool((reach <= plate.half[:, :2]).all(axis=2).any())


def _site(patch: Patch, importance: float, plates: dict[str, _Plate], thickness: Thickness) -> Site:
    hangs = patch.lower is None
    anchor, far = (patch.upper, None) if hangs else (patch.lower, patch.upper)
    assert anchor is not None
    rise = np.array([0.0, 0.0, -1.0 if hangs else 1.0])
    along = -patch.along if hangs else patch.along
    across = cross(along, rise)
    up = -patch.up if hangs else patch.up
    start = plates[anchor].face.bottom if hangs else plates[anchor].face.top
    foot = patch.center + patch.up * (start - patch.center[2]) / patch.up[2]
    tip = patch.center[2] + abs(patch.up[2]) * patch.length / 2 * rise[2]
    clear = plates[far].face.bottom - start if far is not None else float((tip - start) * rise[2])
    lean = float(np.arctan2(up @ across, up @ rise))
    half = patch.width / 2
    covered = tuple(_covered(plates[b], foot, along, thickness) if b else (-half, half) for b in (anchor, far))
    return Site(
        patch, importance, anchor, far, across, along, rise, lean, foot, float(clear),
        np.array([-half, half]), (covered[0], covered[1]), thickness.of(patch.thickness).panel,
    )  # fmt: skip


class _Plate:
    """A base's faces, and its outlines in bulk."""

    def __init__(self, base: BasePatch, thickness: Thickness) -> None:
        self.face: Face = faces(base, thickness)
        along = np.array([outline.along for outline in base.outlines])
        half = np.array([outline.half for outline in base.outlines])
        self.center = np.array([outline.center for outline in base.outlines])
        """(n, 2) mm."""
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        self.sides = np.stack([along * half[:, :1], across * half[:, 1:]], axis=1)
        """(n, 2, 2) half sides as vectors, mm."""


def _covered(plate: _Plate, foot: Array, along: Array, thickness: Thickness) -> tuple[float, float]:
    """What the base covers of the horizontal line through `foot`, as one interval; everything where it covers none."""
    across = np.array([-along[1], along[0]])
    offset = (plate.center - foot[:2])[:, None]
    hit = np.abs(offset @ across)[:, 0] <= np.abs(plate.sides @ across).sum(1) + 1.5 * thickness.panel
    reach = np.abs(plate.sides @ along[:2]).sum(1)[hit]
    middle = (offset @ along[:2])[hit, 0]
    low, high = float((middle - reach).min(initial=np.inf)), float((middle + reach).max(initial=-np.inf))
    return (low, high) if low < high else (-np.inf, np.inf)


def _apart(made: list[Site], thickness: Thickness) -> list[Site]:
    """Trims spans pair by pair until no two open panels are closer than the gap."""
    if not made:
        return made
    solids = [grown(slab(site, thickness), thickness.gap / 2) for site in made]
    whole, trimmed = stacked(solids), set[int]()
    for i, j in zip(*(found.tolist() for found in close_pairs(whole, whole)), strict=True):
        if i < j and (not {i, j} & trimmed or len(close_pairs(solids[i], solids[j])[0])):
            for k, site in zip((i, j), _trimmed_pair(made[i], made[j], thickness), strict=True):
                if site is not made[k]:
                    made[k], solids[k] = site, grown(slab(site, thickness), thickness.gap / 2)
                    trimmed.add(k)
    return made


def _trimmed_pair(a: Site, b: Site, thickness: Thickness) -> tuple[Site, Site]:
    first, second = slab(a, thickness), slab(b, thickness)
    short_a, short_b = _trimmed(a, second, b, thickness), _trimmed(b, first, a, thickness)
    lost_a, lost_b = (float(np.ptp(old.span) - np.ptp(new.span)) for old, new in ((a, short_a), (b, short_b)))
    if min(lost_a, lost_b) > EDGE_THICKNESSES * max(a.panel, b.panel) + 3 * thickness.gap:
        return a, b
    share_a, share_b = lost_a / float(np.ptp(a.span)), lost_b / float(np.ptp(b.span))
    return (short_a, b) if (share_a, a.patch.area) <= (share_b, b.patch.area) else (a, short_b)


def _trimmed(site: Site, other: Boxes, neighbour: Site, thickness: Thickness) -> Site:
    """The site cut back along its span to clear the other's slab and, where they meet edge to face, its knuckles."""
    middle = float((other.center[0] - site.foot) @ site.along)
    reach = float(np.abs(other.axes[0] @ site.along) @ other.half[0])
    flush = abs(site.across @ neighbour.across) > SIDE_BY_SIDE
    room = thickness.gap if flush else 1.5 * thickness.gap + neighbour.panel / 2 + thickness.gap
    low, high = float(site.span[0]), float(site.span[1])
    keep_low, keep_high = middle - reach - room - low, high - (middle + reach + room)
    if keep_low >= keep_high:
        return replace(site, span=np.array([low, max(low + 1e-3, min(high, low + keep_low))]))
    return replace(site, span=np.array([min(high - 1e-3, max(low, high - keep_high)), high]))
