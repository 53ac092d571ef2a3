"""URDF: links become rigid bodies where the joints at zero place them.

Visuals are taken, and collision shapes where a link has none: those are often hulls of several boards.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.intake import primitives
from foldfab.intake.limits import check_depth, fail
from foldfab.intake.markup import Element, numbers
from foldfab.intake.meshes import placed, product
from foldfab.intake.referenced import References
from foldfab.intake.rigid import Geom, Link
from foldfab.intake.turns import by_angles, rigid
from foldfab.recipe.model import Mesh
from foldfab.recipe.problems import shown

_FIXED = "XYZ"
"""Roll, pitch and yaw are about axes that stand still."""


def links(path: Path, robot: Element) -> list[Link]:
    """The links of a robot in the order of the file, in the frame of the one that hangs on no joint.

    Raises:
        RecipeError: links repeat, are missing or hang in a circle, or a shape cannot be read.
    """
    if any(child.tag.startswith("xacro:") for child in robot.children):
        fail(path, "is a template for xacro; run it first: xacro FILE > furniture.urdf")
    named: dict[str, Element] = {}
    for link in robot.all("link"):
        name = link.given.get("name", "")
        if not name or name in named:
            fail(path, "is given twice" if name else "has no name", link.place)
        named[name] = link
    files = References(path)
    places = _places(path, robot, named)
    return [Link(name, _geoms(path, link, files), places[name]) for name, link in named.items()]


def _places(path: Path, robot: Element, named: dict[str, Element]) -> dict[str, Array]:
    """(4, 4) by link, from its frame to that of the furniture."""
    carried: dict[str, list[tuple[str, Array]]] = defaultdict(list)
    hung: set[str] = set()
    for joint in robot.all("joint"):
        parent, child = (_end(path, joint, tag, named) for tag in ("parent", "child"))
        if child in hung:
            fail(path, f"is the second joint that {shown(child)} hangs on; keep one", joint.place)
        hung.add(child)
        carried[parent].append((child, _origin(path, joint)))
    pending = [(name, np.eye(4), 0) for name in reversed(named) if name not in hung]
    places: dict[str, Array] = {}
    while pending:
        name, matrix, depth = pending.pop()
        check_depth(path, depth)
        places[name] = matrix
        pending += [(child, product(matrix, origin), depth + 1) for child, origin in carried[name]]
    lost = [name for name in named if name not in places]
    if lost:
        fail(path, f"{', '.join(map(shown, lost[:5]))} hang on each other in a circle", "joint")
    return places


def _end(path: Path, joint: Element, tag: str, named: dict[str, Element]) -> str:
    end = joint.first(tag)
    name = end.given.get("link", "") if end else ""
    if name not in named:
        fail(path, f"names the {tag} {shown(name)}, and there is no such link", joint.place)
    return name


def _origin(path: Path, element: Element) -> Array:
    origin = element.first("origin") or Element("origin", {})
    angles = numbers(path, origin, "rpy", (3,), "0 0 0")
    return rigid(by_angles(_FIXED, angles), numbers(path, origin, "xyz", (3,), "0 0 0"))


def _geoms(path: Path, link: Element, files: References) -> tuple[Geom, ...]:
    shown_ones = [element for element in link.all("visual") if element.first("geometry")]
    found = []
    for element in shown_ones or link.all("collision"):
        mesh = placed(_mesh(path, link, element, files), _origin(path, element))
        found.append(Geom(element.given.get("name", ""), mesh))
    return tuple(found)


def _mesh(path: Path, link: Element, element: Element, files: References) -> Mesh:
    geometry = element.first("geometry")
    where = f"{link.place}.{element.tag}"
    if geometry is None or not geometry.children:
        fail(path, f"has no shape; give {_SHAPES}", where)
    shape = geometry.children[0]
    if shape.tag == "mesh":
        scale = numbers(path, shape, "scale", (3,), "1 1 1")
        return files.mesh(shape.given.get("filename", ""), scale, f"{where}.mesh")
    if shape.tag not in _PRIMITIVES:
        fail(path, f"has {shown(shape.tag)} for its shape; give {_SHAPES}", where)
    return _PRIMITIVES[shape.tag](path, shape)


_SHAPES = "a box, cylinder, capsule, sphere or mesh"
_PRIMITIVES: dict[str, Callable[[Path, Element], Mesh]] = {
    "box": lambda path, shape: primitives.box(_lengths(path, shape, "size", 3) / 2),
    "cylinder": lambda path, shape: primitives.cylinder(*_round(path, shape)),
    "capsule": lambda path, shape: primitives.capsule(*_round(path, shape)),
    "sphere": lambda path, shape: primitives.ellipsoid(np.full(3, _lengths(path, shape, "radius", 1)[0])),
}


def _round(path: Path, shape: Element) -> tuple[float, float]:
    """Radius and half length."""
    return float(_lengths(path, shape, "radius", 1)[0]), float(_lengths(path, shape, "length", 1)[0]) / 2


def _lengths(path: Path, shape: Element, key: str, count: int) -> Array:
    """Lengths above 0."""
    found = numbers(path, shape, key, (count,))
    if not (found > 0).all():
        fail(path, f"should be above 0, not {shown(shape.given[key])}", f"{shape.place}.{key}")
    return found
