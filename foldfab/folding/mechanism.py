"""How one chain moves: tilts of its panels, places of its hinge axes and poses, by fold progress s in [0, 1].

A chain lives in its own vertical plane, x along `across` and y along `rise`. A panel of tilt θ has its length along
(sin θ, cos θ) and its face normal along (cos θ, -sin θ). Base hinges have their axis in the mid-plane of the panel,
inserted hinges (K + g)/2 off it on alternating faces, so that an axis on the +x face sends the elbow to -x.

In-place folding from a slanted start (section 5.3, figure 9): of N_h + 1 panels, N_h are a long and one is a + Δ,
where Δ is how far the far end stands beyond the root. The long one is the last where the first panel folds against
the lean, and the first where it folds with it; both are the same motion, turned by half a turn. With ψ the tilt of
the short panels, first all in line (a two-bar linkage) until they stand upright, then in a zig-zag, the tilt β of the
long panel follows from the far end coming straight down: ℓ sin β - h cos β = Δ - h cos ψ - n a sin ψ.
All formulas are closed; cost O(samples · panels).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from foldfab.folding.model import Chain, Shape
from foldfab.geometry.arrays import Array
from foldfab.geometry.rotation import sine_and_cosine

QUARTER = np.pi / 2
TABLE = 385
"""Samples of the table by which a motion is inverted."""
REMEMBERED = 4096
"""Shapes whose tables are kept: furniture is made of a few, over and over again."""

_MIRROR = np.array([-1.0, 1.0])
"""What turns places of a chain that folds to the right into those of one that folds to the left."""


def tilts(chain: Chain | Shape, progress: Array) -> Array:
    """Tilts (k, m) of the panels at each fold progress (k,), radians."""
    s = np.asarray(progress, dtype=np.float64)[:, None]
    shape = chain if isinstance(chain, Shape) else chain.shape
    if not shape.comes_down:
        flat = shape.turn * np.where(np.arange(len(shape.lengths)) % 2 == 0, 1.0, -1.0)
        return shape.lean + s * (flat - shape.lean)
    return _in_place(shape, s)


def joints(chain: Chain | Shape, angles: Array) -> Array:
    """Hinge axes (k, m + 1, 2) in the plane of the chain relative to the root, for tilts (k, m); a tip last."""
    return joined(chain, *directions(angles))


def joined(chain: Chain | Shape, normal: Array, length: Array) -> Array:
    """The same for panels with these face normals and length directions (k, m, 2)."""
    offsets, lengths = np.asarray(chain.offsets), np.asarray(chain.lengths)
    found = np.zeros((len(normal), len(lengths) + 1, 2))
    steps = (offsets[1:] - offsets[:-1])[:, None] * normal + lengths[:, None] * length
    np.cumsum(steps, axis=1, out=found[:, 1:])
    return found


def directions(angles: Array) -> tuple[Array, Array]:
    """Face normals and length directions (k, m, 2) of panels with tilts (k, m), in the plane of the chain."""
    normal, length = np.empty((*angles.shape, 2)), np.empty((*angles.shape, 2))
    length[..., 0], length[..., 1] = sine_and_cosine(angles)
    normal[..., 0], normal[..., 1] = length[..., 1], -length[..., 0]
    return normal, length


def reach(chain: Chain | Shape, progress: Array) -> Array:
    """Where the last axis stands relative to the root, (k, 2) in the plane of the chain, mm."""
    last: Array = joints(chain, tilts(chain, progress))[:, -1]
    return last


def frames(chain: Chain, progress: Array) -> tuple[Array, Array]:
    """Poses of the panels relative to the anchor's position in the open posture.

    Returns:
        origins (k, m, 3), the middle of each panel's mid-plane at its first axis, mm; and axes (k, m, 3, 3) whose rows
        are the face normal, the hinge direction and the length direction.
    """
    angles = tilts(chain, progress)
    normal, length = directions(angles)
    flat = joints(chain, angles)[:, :-1] - chain.offsets[:-1, None] * normal
    plane = chain.plane
    along = np.broadcast_to(chain.along, (*angles.shape, 3))
    return chain.root + flat @ plane, np.stack([normal @ plane, along, length @ plane], axis=2)


def peak(chain: Chain) -> tuple[float, float]:
    """The snap of a thick accordion: how far the far end rises before it falls (mm), and at which progress.

    The rise is about N_h (K + g)²/(2 a) · N_h/(N_h + 1) for an upright accordion; 0 where there is none.
    """
    return _peak(chain.to_the_right) if chain.shape.comes_down else (0.0, 0.0)


def descent(chain: Chain) -> tuple[Array, Array, int]:
    """Progress (n,) and height over the open posture (n,) of the far end along the whole fold, and the snap's place."""
    return _descent(chain.to_the_right)


def turn(chain: Chain) -> float | None:
    """The progress at which a leaning accordion turns from a two-bar linkage to a zig-zag; None where it does not lean.

    Its speed leaps there, so it has to be sampled at that very place.
    """
    return _turn(chain.shape)


def ends(chain: Chain) -> Array:
    """(3,) how far the last axis comes from open to folded, mm."""
    first, last = _far_axis(chain)
    way: Array = (last - first) @ chain.plane
    return way


def start(chain: Chain) -> Array:
    """(3,) where the last axis stands open, from the root, mm."""
    place: Array = _far_axis(chain)[0] @ chain.plane
    return place


@lru_cache(REMEMBERED)
def open_and_folded(shape: Shape) -> Array:
    """(2, 2) where the last axis stands open and folded, from the root in the plane of the chain, mm."""
    return reach(shape, np.array([0.0, 1.0]))


def open_height(chain: Chain) -> float:
    """How high the last axis stands above the root in the open posture, mm."""
    return float(open_and_folded(chain.to_the_right)[0, 1])


def _far_axis(chain: Chain) -> Array:
    """(2, 2) where the last axis stands open and folded, in the plane of the chain."""
    places = open_and_folded(chain.to_the_right)
    return places if chain.turn > 0 else places * _MIRROR


@lru_cache(REMEMBERED)
def _descent(shape: Shape) -> tuple[Array, Array, int]:
    s = np.linspace(0.0, 1.0, TABLE)
    place = _turn(shape)
    s = np.unique(np.append(s, place)) if place is not None else s
    height = reach(shape, s)[:, 1]
    height -= height[0]
    return s, height, int(np.argmax(height))


def _turn(shape: Shape) -> float | None:
    lean = abs(shape.lean)
    return lean / (QUARTER + lean) if shape.comes_down and lean > 0 and len(shape.lengths) > 2 else None


@lru_cache(REMEMBERED)
def _peak(shape: Shape) -> tuple[float, float]:
    s = np.linspace(0.0, 0.5, 257)
    height = reach(shape, s)[:, 1]
    top = int(np.argmax(height))
    return (float(height[top] - height[0]), float(s[top])) if top else (0.0, 0.0)


def _in_place(shape: Shape, s: Array) -> Array:
    side, lengths, offsets = float(np.sign(shape.turn)), np.array(shape.lengths), np.array(shape.offsets)
    if side * shape.lean > 0:
        return _against(-side, abs(shape.lean), lengths[::-1], offsets, s)[:, ::-1]
    return _against(side, abs(shape.lean), lengths, offsets, s)


def _against(side: float, lean: float, lengths: Array, offsets: Array, s: Array) -> Array:
    """Tilts where the first panel folds against the lean and the last panel is the long one."""
    hinges = len(lengths) - 1
    short, long, off = lengths[0], lengths[-1], abs(offsets[1])
    shift = lengths.sum() * np.sin(lean)
    psi = lean + s * (-QUARTER - lean)
    bars = np.where(psi >= 0, hinges, 1)
    beta = np.arcsin((shift - off * np.cos(psi) - bars * short * np.sin(psi)) / np.hypot(long, off))
    beta = np.where(s == 1.0, QUARTER, beta + np.arctan2(off, long))
    zigzag = np.where(np.arange(hinges) % 2 == 0, 1.0, -1.0)
    bent = np.where(psi >= 0, psi, psi * zigzag)
    tilt: Array = -side * np.concatenate([bent, beta], axis=1)
    return tilt
