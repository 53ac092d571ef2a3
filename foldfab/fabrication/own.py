"""The furniture's own shape: panels and plates cut to the outlines of the parts that they stand for.

What folds has to stay as thick as its place in the stack, so a curved part keeps its outline, seen along the normal of
its panel or plate, and not its relief. Around hinges the plain plate stays. Where too little would be left, or what is
left would fall apart or be too thin to print, the plain plate is kept and a finding says so.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.model import Finding
from foldfab.fabrication.plates import axis_of
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, cut, placed, prism
from foldfab.fabrication.solids import Outline
from foldfab.fabrication.walls import thin_sides
from foldfab.folding.anatomy import RIM
from foldfab.folding.mechanism import frames
from foldfab.folding.model import Chain, FoldSolution
from foldfab.geometry.arrays import Array, Indices
from foldfab.scaffold.model import Scaffold

KEPT = 0.8
"""The least share of its plate that an outline has to leave: with less, it is no longer the part that was analysed."""
SMALL = 2.0
"""Bits of less than this are not cut away, mm²."""
FINE = 0.05
"""How far an outline may be from the part's own, mm."""
WEB = 2.0
"""Of the plain plate stays this much beyond what a hinge takes, mm."""
TIP = 0.8
"""Half the width at which a tip ends, mm."""
FAR = 500.0
"""Beyond every plate, mm."""


@dataclass(frozen=True, slots=True, eq=False)
class _Plane:
    """Where an outline lies: points = origin + u · rows[0] + v · rows[2], cut along rows[1]."""

    origin: Array
    rows: Array
    """(3, 3), right-handed."""
    reach: tuple[float, float]
    """Between which heights along rows[1] it is cut, mm."""

    def flat(self, points: Array) -> Array:
        """(n, 2) of points (n, 3)."""
        return np.asarray((points - self.origin) @ self.rows[[0, 2]].T)


def own_shapes(solution: FoldSolution, plain: dict[str, Shape]) -> tuple[dict[str, Shape], list[Finding]]:
    """By body, the plain shape cut to the outline of its parts where they have one of their own."""
    made, findings = dict(plain), list[Finding]()
    shaped = {part.name for part in solution.scaffold.recipe.parts if part.shape is not None}
    for chain in solution.chains:
        parts = solution.scaffold.patch(chain.patch).parts
        origins, axes = frames(chain, np.zeros(1))
        for i, name in enumerate(chain.panels if shaped & set(parts) else ()):
            along, normal, up = axes[0, i, 1], axes[0, i, 0], axes[0, i, 2]
            plane = _Plane(origins[0, i], np.stack([up, normal, along]), (-FAR, FAR))
            _try(solution.scaffold, name, parts, plane, _around_hinges(solution, chain, i), made, findings)
    for base in solution.scaffold.bases:
        if shaped & set(base.parts):
            plane = _Plane(np.zeros(3), np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]), (-FAR, FAR))
            feet = [box for chain in solution.chains for box in _feet(chain, base.name)]
            _try(solution.scaffold, base.name, base.parts, plane, feet, made, findings)
    return made, findings


def _try(
    scaffold: Scaffold, name: str, parts: tuple[str, ...], plane: _Plane, kept: list[Array], made: dict[str, Shape],
    findings: list[Finding],
) -> None:  # fmt: skip
    """Cuts one body to its outline, or says why not."""
    body = printed(made[name])
    seen = _outline([plane.flat(solids.mesh(body)[0])[solids.mesh(body)[1]]])
    wanted = _outline([plane.flat(points)[faces] for points, faces in _meshes(scaffold, parts)])
    zones = [solids.rectangle((low + high) / 2, high - low) for low, high in kept]
    stays = wanted
    for zone in zones:
        stays = stays + zone
    # Tips that run out thinner than a few lines are left out with what is cut away.
    left = solids.grown(solids.grown(seen ^ stays, -TIP), TIP)
    share = left.area() / max(seen.area(), 1e-9)
    if share < KEPT:
        findings.append(Finding("plain", f"{name} stays a plain plate: its own outline would leave {share:.0%} of it"))
        return
    bits = [bit for bit in _around(seen, left) if (bit ^ seen).area() > SMALL and len(bit.to_polygons()) == 1]
    if not bits:
        return
    holes = [_hole(plane, bit) for bit in bits]
    shape = cut(made[name], holes)
    solid = solids.tidied(printed(shape))
    if solids.pieces(solid) != 1 or not solids.stays_closed(solid) or thin_sides(solid) > thin_sides(body):
        findings.append(Finding("plain", f"{name} stays a plain plate: its own outline falls apart, or is too thin"))
        return
    made[name] = shape


def _around(seen: Outline, left: Outline) -> list[Outline]:
    """What lies around an outline, by quarters, and beyond the edges of what is seen: no skin is left along them."""
    x0, y0, x1, y1 = seen.bounds()
    middle, size = np.array([x0 + x1, y0 + y1]) / 2, np.array([x1 - x0, y1 - y0])
    rest = solids.grown(seen, TIP) - left
    quarters = [middle + size * (np.array([x, y]) - 0.5) for x in (0, 1) for y in (0, 1)]
    sides = size + FINE
    return [bit for quarter in quarters for bit in (rest ^ solids.rectangle(quarter, sides)).decompose()]


def _hole(plane: _Plane, bit: Outline) -> Shape:
    grown = solids.grown(bit, FINE / 5).to_polygons()[0]
    return placed(prism([(float(u), float(v)) for u, v in grown], *plane.reach), plane.origin, plane.rows)


def _outline(many: list[Array]) -> Outline:
    """What triangles (n, 3, 2) cover, whatever their sense."""
    corners = np.concatenate(many)
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    turned = np.where((area < 0)[:, None, None], corners[:, ::-1], corners)[np.abs(area) > 1e-9]
    return solids.covered(turned).simplify(FINE)


def _meshes(scaffold: Scaffold, names: tuple[str, ...]) -> list[tuple[Array, Indices]]:
    """The parts in the canonical frame at print scale: vertices and faces; boxes where they have no shape."""
    found: list[tuple[Array, Indices]] = []
    for part in scaffold.recipe.parts:
        if part.name in names and part.shape is not None:
            found.append((part.shape.vertices, part.shape.faces))
        elif part.name in names:
            box = solids.box(-part.size / 2, part.size / 2)
            vertices, faces = solids.mesh(box)
            found.append((part.center + vertices @ part.axes, faces))
    return [(scaffold.scale * vertices @ scaffold.rotation.T, faces) for vertices, faces in found]


def _around_hinges(solution: FoldSolution, chain: Chain, i: int) -> list[Array]:
    """Rectangles (2, 2) of a panel, along its length and its hinges, in which the plain plate stays."""
    thick, last = solution.thickness.of(chain.panel), len(chain.lengths) - 1
    low, high = float(chain.span[0]), float(chain.span[1])
    length = float(chain.lengths[i])
    found = [np.array([[-FAR, low - 1], [thick.foot_room + WEB, high + 1]])]
    if i < last or chain.far is not None:
        found.append(np.array([[length - thick.foot_room - WEB, low - 1], [FAR, high + 1]]))
    return found


def _feet(chain: Chain, base: str) -> list[Array]:
    """Rectangles (2, 2) of a base, in which the feet of a chain stand on the plain plate."""
    found = []
    for end, name in enumerate((chain.anchor, chain.far)):
        if name == base:
            side = chain.across * (chain.panel + RIM + WEB)
            span = chain.span if chain.pads[end] > 0 else chain.hinge_spans[-end]
            middle = axis_of(chain, end)
            corners = np.array([middle + chain.along * at + way * side for at in span for way in (-1.0, 1.0)])[:, :2]
            found.append(np.stack([corners.min(0) - WEB, corners.max(0) + WEB]))
    return found
