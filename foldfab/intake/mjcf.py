"""MJCF, the models of MuJoCo: bodies become rigid bodies where they stand before anything moves.

Default classes of geoms and meshes hold; joints, free ones too, are passed over. Where a body has geoms that nothing
collides with, those are what it looks like, and only they are taken. Planes and height fields are ground.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.intake import primitives, turns
from foldfab.intake.limits import check_depth, fail
from foldfab.intake.markup import Attributes, Element, numbers
from foldfab.intake.meshes import placed, product
from foldfab.intake.referenced import References
from foldfab.intake.rigid import Geom, Link
from foldfab.recipe.model import Mesh
from foldfab.recipe.problems import shown

_ELSEWHERE = ("include", "attach", "replicate", "composite", "flexcomp")
"""Elements that make more of a model than stands in it."""
_GROUND = ("plane", "hfield")
_MAIN = "main"

Defaults = Mapping[str, Mapping[str, Attributes]]
"""By class, by tag: its attributes, those of the classes around it included."""


@dataclass(frozen=True, slots=True, eq=False)
class _Settings:
    """What holds for the whole model."""

    path: Path
    degrees: bool
    sequence: str
    defaults: Defaults
    meshes: Mapping[str, Element]
    folder: str
    """Before the names of mesh files."""
    files: References


@dataclass(slots=True, eq=False)
class _Body:
    """A body whose geoms are being gathered."""

    name: str
    matrix: Array
    geoms: list[Geom] = field(default_factory=list)
    bare: list[Geom] = field(default_factory=list)
    """Those that nothing collides with."""


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    """An element whose contents are to be read: a body, or a frame within one."""

    element: Element
    body: _Body
    inner: Array
    """(4, 4) from its own frame to the body's."""
    klass: str
    depth: int


def links(path: Path, model: Element) -> list[Link]:
    """The bodies of a model in the order of the file, in the world's frame.

    Raises:
        RecipeError: a shape, a class or a mesh cannot be read.
    """
    settings = _settings(path, model)
    world = _Body("", np.eye(4))
    found = [world]
    pending = [_Place(top, world, np.eye(4), _MAIN, 0) for top in reversed(model.all("worldbody"))]
    while pending:
        place = pending.pop()
        check_depth(path, place.depth)
        inner = []
        for child in place.element.children:
            if child.tag in _ELSEWHERE:
                fail(path, _needs(child), child.place)
            if child.tag == "geom":
                _gather(settings, place, child)
            elif child.tag in ("body", "frame"):
                inner.append(_within(settings, place, child))
        found += [one.body for one in inner if one.body is not place.body]
        pending += reversed(inner)
    return [Link(body.name, tuple(body.bare or body.geoms), body.matrix) for body in found]


def _settings(path: Path, model: Element) -> _Settings:
    for child in model.children:
        if child.tag in _ELSEWHERE:
            fail(path, _needs(child), child.place)
    compiler: Attributes = {}
    for element in model.all("compiler"):
        compiler |= element.given
    sequence = compiler.get("eulerseq", "xyz")
    if (
        len(sequence) != 3
        or not set(sequence.lower()) <= set("xyz")
        or sequence.lower() != sequence != sequence.upper()
    ):
        fail(
            path, f"should be three of x, y and z, all small or all capital, not {shown(sequence)}", "compiler.eulerseq"
        )
    defaults: dict[str, Mapping[str, Attributes]] = {_MAIN: {}}
    for element in model.all("default"):
        _add_defaults(path, element, defaults, {})
    meshes: dict[str, Element] = {}
    for mesh in [mesh for asset in model.all("asset") for mesh in asset.all("mesh")]:
        name = mesh.given.get("name") or Path(mesh.given.get("file", "")).stem
        if name in meshes:
            fail(path, "is given twice", f"mesh {shown(name)}")
        meshes[name] = mesh
    folder = compiler.get("meshdir") or compiler.get("assetdir") or ""
    degrees = compiler.get("angle", "degree") != "radian"
    return _Settings(path, degrees, sequence, defaults, meshes, folder, References(path))


def _needs(element: Element) -> str:
    told = f"{element.tag} makes parts that do not stand in the file"
    return f"{told}; save the model as MuJoCo compiles it (mj_saveLastXML)"


def _add_defaults(
    path: Path, element: Element, found: dict[str, Mapping[str, Attributes]], outer: Mapping[str, Attributes]
) -> None:
    """Enters the classes of a tree of defaults; the depth of the file bounds that of the calls."""
    own = dict(outer)
    for child in element.all("geom", "mesh"):
        own[child.tag] = own.get(child.tag, {}) | child.given
    found[element.given.get("class", _MAIN)] = own
    for child in element.all("default"):
        _add_defaults(path, child, found, own)


def _with_defaults(settings: _Settings, element: Element, klass: str) -> Element:
    """The element with what its class says where it says nothing itself."""
    name = element.given.get("class", klass)
    if name not in settings.defaults:
        fail(settings.path, f"names the class {shown(name)}, and there is no such default", element.place)
    given = settings.defaults[name].get(element.tag, {}) | element.given
    return replace(element, given={key: value for key, value in given.items() if key != "class"})


def _within(settings: _Settings, place: _Place, child: Element) -> _Place:
    matrix = product(
        place.inner, turns.rigid(_turn(settings, child), numbers(settings.path, child, "pos", (3,), "0 0 0"))
    )
    klass = child.given.get("childclass", place.klass)
    if child.tag == "frame":
        return _Place(child, place.body, matrix, klass, place.depth + 1)
    body = _Body(child.given.get("name", ""), product(place.body.matrix, matrix))
    return _Place(child, body, np.eye(4), klass, place.depth + 1)


def _gather(settings: _Settings, place: _Place, element: Element) -> None:
    """Adds a geom to its body, if it is no ground."""
    geom = _with_defaults(settings, element, place.klass)
    kind = geom.given.get("type", "mesh" if "mesh" in geom.given else "sphere")
    if kind in _GROUND:
        return
    if "mesh" in geom.given:
        mesh, matrix = _asset(settings, geom), _pose(settings, geom)
    elif kind in _PRIMITIVES:
        mesh, matrix = _primitive(settings, geom, kind)
    else:
        fail(settings.path, f"is of type {shown(kind)}, which is not read; give {', '.join(_PRIMITIVES)}", geom.place)
    made = Geom(geom.given.get("name", ""), placed(mesh, product(place.inner, matrix)))
    is_bare = geom.given.get("contype") == geom.given.get("conaffinity") == "0"
    (place.body.bare if is_bare else place.body.geoms).append(made)


_PRIMITIVES = {"box": 3, "ellipsoid": 3, "cylinder": 2, "capsule": 2, "sphere": 1}
"""Types of geoms, and how many sizes each has."""


def _primitive(settings: _Settings, geom: Element, kind: str) -> tuple[Mesh, Array]:
    size = numbers(settings.path, geom, "size", (1, 2, 3))
    if "fromto" in geom.given and kind != "sphere":
        ends = numbers(settings.path, geom, "fromto", (6,)).reshape(2, 3)
        # MuJoCo looks back, which shows in how a box is turned about its length.
        way = ends[0] - ends[1]
        length = float(np.linalg.norm(way)) / 2
        if length == 0:
            fail(settings.path, "begins where it ends", f"{geom.place}.fromto")
        # The length replaces the last size, and what is across is the same both ways.
        size = np.array([size[0], length] if _PRIMITIVES[kind] == 2 else [size[0], size[0], length])
        matrix = turns.rigid(turns.upright_to(way), ends.mean(0))
    else:
        matrix = _pose(settings, geom)
    if len(size) < _PRIMITIVES[kind] or not (size[: _PRIMITIVES[kind]] > 0).all():
        fail(settings.path, f"should be {_PRIMITIVES[kind]} above 0 for a {kind}", f"{geom.place}.size")
    if kind in ("box", "ellipsoid"):
        return (primitives.box if kind == "box" else primitives.ellipsoid)(size[:3]), matrix
    if kind == "sphere":
        return primitives.ellipsoid(np.full(3, size[0])), matrix
    return (primitives.cylinder if kind == "cylinder" else primitives.capsule)(float(size[0]), float(size[1])), matrix


def _asset(settings: _Settings, geom: Element) -> Mesh:
    name = geom.given["mesh"]
    if name not in settings.meshes:
        fail(settings.path, f"shows the mesh {shown(name)}, and there is no such asset", geom.place)
    asset = _with_defaults(settings, settings.meshes[name], _MAIN)
    odd = next((key for key in ("refpos", "refquat", "builtin", "vertex") if key in asset.given), None)
    if odd or "file" not in asset.given:
        fail(settings.path, f"has {odd or 'no file'}, which is not read; give a mesh file as it stands", asset.place)
    scale = numbers(settings.path, asset, "scale", (3,), "1 1 1")
    file = f"{settings.folder.rstrip('/')}/{asset.given['file']}" if settings.folder else asset.given["file"]
    return settings.files.mesh(file, scale, f"{asset.place}.file")


def _pose(settings: _Settings, element: Element) -> Array:
    return turns.rigid(_turn(settings, element), numbers(settings.path, element, "pos", (3,), "0 0 0"))


def _turn(settings: _Settings, element: Element) -> Array:
    """(3, 3) of an element, however it is written."""
    path, unit = settings.path, np.pi / 180 if settings.degrees else 1.0
    given = [key for key in ("quat", "euler", "axisangle", "xyaxes", "zaxis") if key in element.given]
    if len(given) > 1:
        fail(path, f"is turned by {' and by '.join(given)}; keep one", element.place)
    key = given[0] if given else ""
    values = numbers(path, element, key, (_COUNTS[key],)) if key else np.zeros(0)
    parts = values.reshape(-1, 3) if key == "xyaxes" else values[None, :3] if key == "axisangle" else values[None]
    if key and key != "euler" and (np.linalg.norm(parts, axis=1) < 1e-9).any():
        fail(path, "should not be zero", f"{element.place}.{key}")
    match key:
        case "quat":
            return turns.by_quaternion(*values.tolist())
        case "euler":
            return turns.by_angles(settings.sequence, unit * values)
        case "axisangle":
            return turns.by_axis(values[:3], unit * float(values[3]))
        case "xyaxes":
            if np.linalg.norm(np.cross(values[:3], values[3:])) < 1e-9:
                fail(path, "should be two directions that differ", f"{element.place}.{key}")
            return turns.by_columns(values[:3], values[3:])
        case "zaxis":
            return turns.upright_to(values)
    return np.eye(3)


_COUNTS = {"quat": 4, "euler": 3, "axisangle": 4, "xyaxes": 6, "zaxis": 3}
"""How many numbers each way to write a turn has."""
