"""A shape for CAD: true cylinders and cones where the print has facets, by build123d.

The kernel reports a failure by what it returns, so each solid is looked at: one body, closed, of positive volume.
build123d takes seconds and hundreds of megabytes to import, and is imported only when something is asked for here.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, assert_never

import numpy as np

from foldfab.errors import FabricationError, MissingLibraryError
from foldfab.fabrication import solids
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Box, Common, Cone, Cut, Facets, Hull, Placed, Prism, Rod, Shape, Union, Wrap
from foldfab.geometry.arrays import Array, Indices

if TYPE_CHECKING:
    import build123d

SYSTEM_LIBRARY = re.compile(r"\blib[\w+-]+\.so[.\d]*")
"""How the loader names a library of the system that it does not find."""


def require() -> None:
    """Imports build123d.

    Raises:
        MissingLibraryError: it, or a system library that it needs, is absent; the message says how to install it.
    """
    try:
        import build123d  # noqa: F401
    except ImportError as error:
        system = SYSTEM_LIBRARY.search(str(error))
        advice = (
            f"the system library {system[0]}, which is absent; apt-get install libgl1"
            if system
            else f"the library build123d, which cannot be imported ({error}); pip install build123d"
        )
        raise MissingLibraryError(f"solids for CAD need {advice}") from error


def analytic(shape: Shape, known: dict[Shape, build123d.Shape] | None = None) -> build123d.Solid:
    """The CAD solid of a body; `known` keeps what was made, so that a shape which comes again is not made again.

    The result is a copy of its own: it may be labelled, coloured and moved.

    Raises:
        FabricationError: the kernel could not make it.
        MissingLibraryError: build123d, or a system library that it needs, is absent.
    """
    require()
    return _one(_solid(shape, {} if known is None else known))


def faceted(vertices: Array, faces: Indices) -> build123d.Solid:
    """The CAD solid of a closed mesh, (n, 3) and (m, 3): flat faces are one, round ones stay facets.

    Raises:
        FabricationError: the kernel could not make it.
        MissingLibraryError: build123d, or a system library that it needs, is absent.
    """
    require()
    return _one(_sewn(vertices, faces))


def _one(found: build123d.Shape) -> build123d.Solid:
    bodies = found.solids()
    if len(bodies) != 1 or not bodies[0].is_valid or bodies[0].volume <= 0:
        text = f"the CAD kernel failed and left {len(bodies)} bodies where there should be one"
        raise FabricationError(f"{text}; try another scale or thickness")
    return copy.deepcopy(bodies[0])


def _solid(shape: Shape, known: dict[Shape, build123d.Shape]) -> build123d.Shape:
    if shape not in known:
        known[shape] = _made(shape, known)
    return known[shape]


def _made(shape: Shape, known: dict[Shape, build123d.Shape]) -> build123d.Shape:
    import build123d as b3d

    def all_of(shapes: Iterable[Shape]) -> list[build123d.Shape]:
        return [_solid(s, known) for s in shapes]

    match shape:
        case Box(low, high):
            size = np.subtract(high, low)
            return b3d.Solid.make_box(*size.tolist(), b3d.Plane(low))
        case Rod(radius, start, end, x, z):
            return b3d.Solid.make_cylinder(radius, end - start, b3d.Plane((x, start, z), z_dir=(0, 1, 0)))
        case Cone(radius, base, tip, x, z):
            way = 1 if tip > base else -1
            return b3d.Solid.make_cone(radius, 0.0, abs(tip - base), b3d.Plane((x, base, z), z_dir=(0, way, 0)))
        case Prism(outline, start, end):
            face = b3d.Face(b3d.Wire.make_polygon([(x, start, z) for x, z in outline], close=True))
            return b3d.Solid.extrude(face, b3d.Vector(0, end - start, 0))
        case Union(parts):
            first, *others = all_of(parts)
            return first.fuse(*others)
        case Cut(body, holes):
            return _solid(body, known).cut(*all_of(holes))
        case Common(one, other):
            return b3d.Compound(_solid(one, known).intersect(_solid(other, known)).solids())
        case Hull() | Wrap() | Facets():
            # This kernel wraps nothing, and what has facets anyway is what is printed.
            return _sewn(*solids.mesh(printed(shape)))
        case Placed(body, origin, axes):
            return _solid(body, known).moved(b3d.Location(b3d.Plane(origin, x_dir=axes[0], z_dir=axes[2])))
        case _:
            assert_never(shape)


def _sewn(vertices: Array, faces: Indices) -> build123d.Solid:
    import build123d as b3d

    sides = [b3d.Face(b3d.Wire.make_polygon(vertices[face].tolist(), close=True)) for face in faces]
    return b3d.Solid(b3d.Shell(sides)).clean()


def has_facets(shape: Shape) -> bool:
    """Whether a body is partly a mesh that came with the furniture."""
    match shape:
        case Facets():
            return True
        case Union(parts) | Hull(parts):
            return any(map(has_facets, parts))
        case Cut(body, _) | Placed(body, _, _):
            return has_facets(body)
        case Common(first, second):
            return has_facets(first) or has_facets(second)
        case _:
            return False
