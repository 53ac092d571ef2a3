"""A choice played through once more as the paper's own sheets (sections 4 and 5.4): thickness only adds constraints.

Thick panels reach from face to face, the sheets of the scaffold from mid-sheet to mid-sheet, hinges at equal intervals:
they are up to K + g longer a panel. Where elbows come as near as that, a fold is free with thickness and is none of the
paper's. All that matters is how high the press stands: no snaps, no plinths. Copies of one sheet that fold alike
between the same bases are the same curve over its height, moved aside, and never cross. T-scaffolds are held against
what stands on their base.

Cost: bounds of all sheets of a unit against each other; frames are made only of those that share ground.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from foldfab.folding.closeness import DEPTH, STEPS, crossing, depth
from foldfab.folding.mechanism import frames
from foldfab.folding.model import Chain
from foldfab.folding.press import follow_down
from foldfab.folding.site import Site
from foldfab.folding.space import Batch, batch, meetings, still
from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes, bounds, near_pairs, stacked
from foldfab.geometry.rotation import cross
from foldfab.scaffold.model import BasePatch, Scaffold

UP = np.array([0.0, 0.0, 1.0])
RIM = 0.5
"""What is left out along all edges where nothing may be ruled out that is not that deep, mm: in their last few degrees
sheets share little, however far they cross."""
FRAMES = 48
"""Instants at which sheets are looked at while those between two bases fold, by even turns."""
LAYER = 1e-6
"""Sheets that lie folded in one plane, as the paper's all do in the end, are stacked this far apart, mm."""
ALIKE = 1e-6
"""Heights that differ by less are one, mm."""
DIGITS = 6
"""To how many digits directions agree that are the same."""


def crossings(scaffold: Scaffold, chains: Sequence[Chain]) -> tuple[tuple[str, str], ...]:
    """The pairs of patches of one unit that fold in place and cross as sheets, each in the order of names, sorted."""
    held = [c for c in chains if c.far is not None and c.mechanism == "in-place"]
    played = sheets(scaffold, held) if len(held) > 1 else None
    found: set[tuple[str, str]] = set()
    if played is not None:
        many, never = played
        for frame, i, j in meetings(many, many, never):
            deep = depth(many.boxes[frame, i], many.boxes[frame, j]) > DEPTH
            pairs = set(zip(many.lane[i[deep]].tolist(), many.lane[j[deep]].tolist(), strict=True))
            found |= {(held[a].patch, held[b].patch) for a, b in pairs}
    return tuple(sorted((min(pair), max(pair)) for pair in found))


def swings_into(
    scaffold: Scaffold, chain: Chain, standing: Sequence[Site], bases: Sequence[BasePatch] = ()
) -> tuple[str, ...]:
    """The patches, sorted, that stand unfolded on the base of a T-scaffold and that it crosses as a sheet; and bases
    that do not move against its own.

    What lies folded there lies in the plane in which the T ends. Whatever the base does, they move with it.
    """
    beside = [*((s.patch.name, _open(s)) for s in standing), *((b.name, plate) for b in bases for plate in _split(b))]
    if not beside:
        return ()
    stood = stacked([boxes for _, boxes in beside])
    least, most = _swept(scaffold, chain)
    low, high = bounds(stood)
    near = np.nonzero(((least + DEPTH < high) & (low < most - DEPTH)).all(1))[0]
    if not len(near):
        return ()
    own, stood = sheet(scaffold, chain), stood[near]
    met = crossing(lambda s: panels(own, s), lambda s: still(stood, len(s)), np.linspace(0.0, 1.0, STEPS + 1))
    return tuple(sorted({beside[j][0] for j in near[met.any(0)].tolist()}))


def _swept(scaffold: Scaffold, chain: Chain) -> tuple[Array, Array]:
    """Lower and upper corner (3,) of all that a T-scaffold passes as a sheet."""
    low, tip = ends_of(scaffold, chain)
    length, foot = abs(tip - low) / np.cos(chain.lean), _foot(chain, low)
    sides = [0.0, np.sign(chain.turn) * length / len(chain.lengths)] if chain.lean == 0 else [-length, length]
    corners = np.array([foot + side * chain.across + end * chain.along for side in sides for end in chain.span])
    corners = np.concatenate([corners, corners + chain.rise * length])
    return corners.min(0), corners.max(0)


def sheet(scaffold: Scaffold, chain: Chain) -> Chain:
    """The chain as a sheet, from the plane of its base to that of its far base or to the tip of its patch."""
    low, high = ends_of(scaffold, chain)
    if chain.far is not None and chain.mechanism == "in-place":
        return _sheet(chain, {chain.anchor: low, chain.far: high})
    count = len(chain.lengths)
    lengths = np.full(count, abs(high - low) / np.cos(chain.lean) / count)
    return replace(chain, root=_foot(chain, low), lengths=lengths, offsets=np.zeros(count + 1), pads=(0.0, 0.0))


def ends_of(scaffold: Scaffold, chain: Chain) -> tuple[float, float]:
    """Heights of a chain's base and of its far base or its tip as a sheet, mm."""
    low = scaffold.base(chain.anchor).bottom
    if chain.far is not None:
        return low, scaffold.base(chain.far).bottom
    patch = scaffold.patch(chain.patch)
    return low, float(patch.center[2] + chain.rise[2] * abs(patch.up[2]) * patch.length / 2)


def sheets(scaffold: Scaffold, held: Sequence[Chain], rim: float = 0.0) -> tuple[Batch, Bools] | None:
    """Those chains (n,) that may cross others played as sheets, numbered as they come, and which (n, n) need no look.

    None where no two of different patches share ground. All of them fold in place in one unit; `rim` mm are left out
    along the edges of every panel.
    """
    height = {name: scaffold.base(name).bottom for c in held for name in (c.anchor, c.far or "")}
    meet = _share_room(held, height)
    near = np.nonzero(meet.any(0) | meet.any(1))[0].tolist()
    if not near:
        return None
    low = min(height.values())
    down = {name: z - low for name, z in height.items()}
    return _played({i: _sheet(held[i], height) for i in near}, down, rim), ~meet


def outlines(base: BasePatch) -> Boxes:
    """The outlines (n,) of a base in its plane."""
    center = np.array([[*outline.center, base.bottom] for outline in base.outlines])
    half = np.array([[*outline.half, 0.0] for outline in base.outlines])
    axes = np.array([[[x, y, 0.0], [-y, x, 0.0], UP] for x, y in (outline.along for outline in base.outlines)])
    return Boxes(center, axes, half)


def _split(base: BasePatch) -> list[Boxes]:
    """The outlines (1,) of a base."""
    whole = outlines(base)
    return [whole[i : i + 1] for i in range(len(whole))]


def _share_room(held: Sequence[Chain], height: Mapping[str, float]) -> Bools:
    """(n, n) which chains may cross as sheets, each pair once; storeys stay above each other."""
    ends = np.array([[height[c.anchor], height[c.far or ""]] for c in held])
    longest = [float(_lengths(c, high - low).max()) for c, (low, high) in zip(held, ends.tolist(), strict=True)]
    sides = [[0.0, np.sign(c.turn) * a] if c.lean == 0 else [-a, a] for c, a in zip(held, longest, strict=True)]
    root, across, along = (np.array([getattr(c, of) for c in held]) for of in ("root", "across", "along"))
    span = np.array([c.span for c in held])
    corners = (root[:, None] + np.array(sides)[..., None] * across[:, None])[:, :, None]
    corners = (corners + span[:, None, :, None] * along[:, None, None]).reshape(len(held), 4, 3)
    low, high = corners.min(1), corners.max(1)
    low[:, 2], high[:, 2] = ends[:, 0], ends[:, 1] - ALIKE
    found = np.zeros((len(held), len(held)), dtype=bool)
    found[near_pairs((low, high), (low, high))] = True
    kinds = [(c.anchor, c.far, len(c.lengths), *_folded_to(c)) for c in held]
    for i, j in zip(*np.nonzero(np.triu(found)), strict=True):
        found[i, j] = held[i].patch != held[j].patch and kinds[i] != kinds[j]
    return np.triu(found)


def _folded_to(chain: Chain) -> tuple[float, ...]:
    """Its lean and its normal, both towards the side to which its first panel folds."""
    side = float(np.sign(chain.turn))
    return tuple(round(side * x, DIGITS) + 0.0 for x in (chain.lean, *chain.across.tolist()))


def _sheet(chain: Chain, height: Mapping[str, float]) -> Chain:
    """The chain as a sheet between the planes of its bases."""
    low, high = height[chain.anchor], height[chain.far or ""]
    offsets = np.zeros(len(chain.lengths) + 1)
    return replace(chain, root=_foot(chain, low), lengths=_lengths(chain, high - low), offsets=offsets, pads=(0.0, 0.0))


def _foot(chain: Chain, plane: float) -> Array:
    """(3,) where the middle line of an open chain goes through a plane at some height."""
    up = np.sin(chain.lean) * chain.across + np.cos(chain.lean) * chain.rise
    foot: Array = chain.root + up * (plane - chain.root[2]) / up[2]
    return foot


def _open(site: Site) -> Boxes:
    """The open sheet (1,) of a patch, between its neighbours."""
    up = np.sin(site.lean) * site.across + np.cos(site.lean) * site.rise
    middle = site.patch.center + site.along * (float(site.span.mean()) + (site.foot - site.patch.center) @ site.along)
    half = np.array([[0.0, float(np.ptp(site.span)) / 2, site.patch.length / 2]])
    return Boxes(middle[None], np.array([[cross(site.along, up), site.along, up]]), half)


def _lengths(chain: Chain, clear: float) -> Array:
    """(m,) of the panels of a sheet, mm: equal, but for the one that is longer by how far it leans aside (figure 9)."""
    length, count = clear / np.cos(chain.lean), len(chain.lengths)
    aside = length * abs(np.sin(chain.lean))
    lengths: Array = np.full(count, (length - aside) / count)
    lengths[0 if chain.turn * chain.lean > 0 else -1] += aside
    return lengths


def _played(sheets: Mapping[int, Chain], down: Mapping[str, float], rim: float) -> Batch:
    """The panels of sheets, by number, while a press comes down; its end, where all lies flat, left out."""
    press = _press(sorted({(down[sheet.anchor], down[sheet.far or ""]) for sheet in sheets.values()}))
    many: list[Boxes] = []
    for i, sheet in sheets.items():
        near, far = (np.maximum(down[name] - press, 0.0) for name in (sheet.anchor, sheet.far or ""))
        boxes = panels(sheet, follow_down(sheet, far - near), rim)
        boxes.center[..., 2] += i * LAYER - near[:, None]
        many.append(boxes)
    whole = Boxes(*(np.concatenate([getattr(b, of) for b in many], axis=1) for of in ("center", "axes", "half")))
    return batch(whole, np.repeat(list(sheets), [len(sheet.lengths) for sheet in sheets.values()]))


def panels(sheet: Chain, progress: Array, rim: float = 0.0) -> Boxes:
    """The panels (k, m) of a sheet at each progress (k,), seen from its anchor, `rim` mm narrower all around."""
    origin, turned = frames(sheet, progress)
    middle = origin + turned[:, :, 2] * (sheet.lengths[:, None] / 2) + sheet.along * float(sheet.span.mean())
    half = np.zeros_like(middle)
    half[..., 1], half[..., 2] = float(np.ptp(sheet.span)) / 2 - rim, sheet.lengths / 2 - rim
    return Boxes(middle, turned, half)


def _press(pairs: Sequence[tuple[float, float]]) -> Array:
    """Heights (k,) of the press, highest first, at which what folds between two heights turns evenly; not its end."""
    turn = np.cos(np.linspace(0.0, np.pi / 2, FRAMES + 1)[:-1])
    return np.unique([low + (high - low) * turn for low, high in pairs])[::-1]
