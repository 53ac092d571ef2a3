"""Where the plate of each body lies: its plane, the layer that it folds in, and what of it its hinges need."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.plates import axis_of
from foldfab.fabrication.shapes import Shape, cut, placed, prism
from foldfab.fabrication.solids import Outline, Solid
from foldfab.folding.anatomy import RIM, faces
from foldfab.folding.mechanism import frames
from foldfab.folding.model import Chain, FoldSolution
from foldfab.geometry.arrays import Array, Indices
from foldfab.recipe.hinges import STYLES

WEB = 2.0
"""Of the plain plate stays this much beyond what a hinge takes, mm."""
FAR = 500.0
"""Beyond every plate, mm."""
FLAT = 1e-9
"""A triangle that covers less is seen from its edge, mm²."""
FINE = 0.05
"""How far an outline may be from the part's own, mm."""
ROUNDING = 0.01
"""Holes reach this much beyond what they are cut from, mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """A plane with points = origin + u · across[0] + v · across[1] + w · across[2]; its plate lies in u and v."""

    origin: Array
    """(3,) mm."""
    across: Array
    """(3, 3) right-handed rows u, v and w."""

    def local(self, points: Array) -> Array:
        """(n, 3) u, v and w of points (n, 3)."""
        return np.asarray((points - self.origin) @ self.across.T)

    def laid(self, body: Solid) -> Solid:
        """The body with its u, v and w along x, y and z."""
        return solids.placed(body, -self.across @ self.origin, self.across.T)

    def silhouette(self, points: Array, faces: Indices) -> Outline:
        """What a mesh, (n, 3) and (m, 3), covers in u and v, whatever the sense of its faces."""
        corners = self.local(points)[:, :2][faces]
        one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        turned = np.where((area < 0)[:, None, None], corners[:, ::-1], corners)[np.abs(area) > FLAT]
        return solids.covered(turned).simplify(FINE)

    def columns(self, outline: Outline, low: float, high: float) -> list[Shape]:
        """What stands over an outline in u and v, from `low` to `high` in w."""
        return [self._column(piece, low, high) for piece in solids.islands(outline)]

    def _column(self, piece: Outline, low: float, high: float) -> Shape:
        rings = sorted(piece.to_polygons(), key=lambda ring: -float(np.ptp(ring[:, 0]) * np.ptp(ring[:, 1])))
        # A prism is drawn in x and z along +y, which is -w here.
        rows = np.stack([self.across[0], -self.across[2], self.across[1]])
        whole = prism(map(tuple, rings[0]), -high, -low)
        holes = [prism(map(tuple, ring), -high - ROUNDING, -low + ROUNDING) for ring in rings[1:]]
        return placed(cut(whole, holes), self.origin, rows)


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """Where one body has its plate. Rectangles are (2, 2): their lower and upper corners in u and v."""

    name: str
    parts: tuple[str, ...]
    """The recipe's parts that it stands for."""
    plane: Plane
    layer: tuple[float, float]
    """From where to where in w the plate reaches: nothing else ever folds there."""
    kept: tuple[Array, ...]
    """Around hinges, where the plain plate stays."""
    shy: tuple[Array, ...]
    """Within these, where hinges have cut into the layer and nothing else may fill it."""
    bare: tuple[tuple[Array, ...], tuple[Array, ...]]
    """Where hinges stand below and above the layer, so that nothing may beside it."""

    @property
    def normal(self) -> Array:
        """(3,) unit."""
        rows: Array = self.plane.across[2]
        return rows


def places(solution: FoldSolution) -> Iterator[Place]:
    """The place of every panel and of every base."""
    for chain in solution.chains:
        parts = solution.scaffold.patch(chain.patch).parts
        origins, axes = frames(chain, np.zeros(1))
        half = chain.panel / 2
        for i, name in enumerate(chain.panels):
            normal, along, up = axes[0, i]
            plane = Plane(origins[0, i], np.stack([up, along, -normal]))
            kept, shy = (_around_hinges(solution, chain, i, web) for web in (WEB, 0.0))
            yield Place(name, parts, plane, (-half, half), kept, shy, (shy, shy))
    for base in solution.scaffold.bases:
        face = faces(base, solution.thickness)
        ends = [(c, end) for c in solution.chains for end, n in enumerate((c.anchor, c.far)) if n == base.name]
        kept = tuple(_foot(solution, chain, end, WEB) for chain, end in ends)
        sides: tuple[list[Array], list[Array]] = ([], [])
        for chain, end in ends:
            is_above = (chain.rise[2] > 0) == (end == 0)
            sides[int(is_above)].append(_foot(solution, chain, end, 0.0))
        plane = Plane(np.zeros(3), np.eye(3))
        bare = (tuple(sides[0]), tuple(sides[1]))
        yield Place(base.name, base.parts, plane, (face.bottom, face.top), kept, (), bare)


def reaching(place: Place, low: float, high: float) -> Place:
    """A panel whose plain plate stays from its hinges to where its part begins and ends in u; a base as it is."""
    if not place.shy:
        return place
    kept = [rectangle.copy() for rectangle in place.kept]
    for rectangle in kept:
        if rectangle[0, 0] <= -FAR:
            rectangle[1, 0] = max(rectangle[1, 0], low + WEB)
        else:
            rectangle[0, 0] = min(rectangle[0, 0], high - WEB)
    return replace(place, kept=tuple(kept))


def zone(rectangles: tuple[Array, ...]) -> Outline:
    """What rectangles cover together."""
    found = solids.nothing()
    for low, high in rectangles:
        found = found + solids.rectangle((low + high) / 2, high - low)
    return found


def _around_hinges(solution: FoldSolution, chain: Chain, i: int, web: float) -> tuple[Array, ...]:
    """Rectangles of a panel within `web` mm of what its hinges take from it."""
    thick, last = solution.thickness.of(chain.panel), len(chain.lengths) - 1
    low, high = float(chain.span[0]), float(chain.span[1])
    length, room = float(chain.lengths[i]), thick.foot_room + web
    found = [np.array([[-FAR, low - 1], [room, high + 1]])]
    if i < last or chain.far is not None:
        found.append(np.array([[length - room, low - 1], [FAR, high + 1]]))
    return tuple(found)


def _foot(solution: FoldSolution, chain: Chain, end: int, web: float) -> Array:
    """The rectangle of a base on which the foot of a chain stands, with `web` mm around it.

    Pins that are put in later come along the axis, so that nothing may stand there.
    """
    is_pinned = STYLES[solution.thickness.hinge].has_loose_pin and web == 0
    side = chain.across * (chain.panel / 2 + RIM + solution.thickness.gap)
    span = chain.span if chain.pads[end] > 0 else chain.hinge_spans[-end]
    reach = np.array([-1.0, 1.0]) * (FAR if is_pinned else RIM)
    middle = axis_of(chain, end)
    corners = np.array([middle + chain.along * at + way * side for at in span + reach for way in (-1.0, 1.0)])[:, :2]
    return np.stack([corners.min(0) - web, corners.max(0) + web])
