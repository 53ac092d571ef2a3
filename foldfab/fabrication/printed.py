"""A shape as it is printed: facets inscribed where material is added, circumscribed where it is taken away."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.shapes import Box, Common, Cone, Cut, Facets, Hull, Placed, Prism, Rod, Shape, Union, Wrap
from foldfab.fabrication.solids import Solid


def printed(shape: Shape, known: dict[Shape, Solid] | None = None) -> Solid:
    """The solid of a shape; `known` keeps what was made, so that a shape which comes again is not made again.

    Raises:
        FabricationError: the kernel could not make it.
    """
    known = {} if known is None else known
    if shape not in known:
        known[shape] = _made(shape, known)
    return known[shape]


def _made(shape: Shape, known: dict[Shape, Solid]) -> Solid:
    def all_of(shapes: Iterable[Shape]) -> list[Solid]:
        return [printed(s, known) for s in shapes]

    match shape:
        case Box(low, high):
            return solids.box(low, high)
        case Rod(radius, start, end, x, z, is_hole):
            return solids.rod(radius, start, end, x, z, is_hole=is_hole)
        case Cone(radius, base, tip, x, z, is_hole):
            return solids.cone(radius, base, tip, x, z, is_hole=is_hole)
        case Prism(outline, start, end):
            return solids.prism(outline, start, end)
        case Facets(vertices, faces):
            return solids.from_mesh(
                np.frombuffer(vertices).reshape(-1, 3), np.frombuffer(faces, np.int64).reshape(-1, 3)
            )
        case Wrap(points):
            return solids.hull_of(np.array(points))
        case Union(parts):
            return solids.union(all_of(parts))
        case Cut(body, holes):
            return solids.cut(printed(body, known), all_of(holes))
        case Common(first, second):
            return solids.common(printed(first, known), printed(second, known))
        case Hull(parts):
            return solids.hull(all_of(parts))
        case Placed(body, origin, axes):
            return solids.placed(printed(body, known), np.array(origin), np.array(axes))
        case _:
            assert_never(shape)
