"""The XML of a 3MF model, read as a stream: no document types, no entities, no depth, counts as it goes."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array, Indices
from foldfab.intake.limits import DEEPEST_XML, check_nodes, check_triangles, check_vertices, fail
from foldfab.intake.markup import Attributes, Stream
from foldfab.intake.markup import parse as read_xml

_EVERY = 4096
"""Triangles or vertices between two counts."""
_SHOWN = ("model", "solidsupport", "surface")
"""Types of objects that are furniture; supports are not."""


@dataclass(frozen=True, slots=True, eq=False)
class Use:
    """A build item or a component: an object, placed."""

    object: str
    matrix: Array
    """(4, 4) acting on columns."""
    file: str = ""
    """The model within the archive that holds the object, where it is another."""
    name: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Object:
    """An object with its mesh or its components."""

    name: str
    vertices: Array
    faces: Indices
    components: tuple[Use, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ModelFile:
    """One model of an archive."""

    unit: str
    objects: dict[str, Object]
    items: tuple[Use, ...]


@dataclass(slots=True, eq=False)
class _State:
    """What was read so far."""

    path: Path
    unit: str = "millimeter"
    current: Attributes | None = None
    places: array[float] = field(default_factory=lambda: array("d"))
    corners: array[int] = field(default_factory=lambda: array("q"))
    components: list[Use] = field(default_factory=list)
    objects: dict[str, Object] = field(default_factory=dict)
    items: list[Use] = field(default_factory=list)
    triangles: int = 0
    uses: int = 0


def parse(path: Path, stream: Stream) -> ModelFile:
    """The model in a stream of XML.

    Raises:
        RecipeError: it is not XML, has a document type, is damaged or too large.
    """
    state = _State(path)
    read_xml(
        path, stream, partial(_start, state), partial(_end, state),
        kind="3MF", place="3dmodel.model", deepest=DEEPEST_XML,
    )  # fmt: skip
    return ModelFile(state.unit, state.objects, tuple(state.items))


def _start(state: _State, name: str, given: Attributes) -> None:
    handler = _HANDLERS.get(name.rpartition(":")[2])
    if handler is not None:
        handler(state, given)


def _end(state: _State, name: str) -> None:
    if name.rpartition(":")[2] == "object" and state.current is not None:
        _finish(state, state.current)


def _model(state: _State, given: Attributes) -> None:
    state.unit = given.get("unit", "millimeter")


def _object(state: _State, given: Attributes) -> None:
    check_nodes(state.path, len(state.objects) + 1)
    state.current = given
    state.places, state.corners, state.components = array("d"), array("q"), []


def _vertex(state: _State, given: Attributes) -> None:
    state.places.extend((float(given["x"]), float(given["y"]), float(given["z"])))
    if not len(state.places) // 3 % _EVERY:
        check_vertices(state.path, len(state.places) // 3)


def _triangle(state: _State, given: Attributes) -> None:
    state.corners.extend((int(given["v1"]), int(given["v2"]), int(given["v3"])))
    state.triangles += 1
    if not state.triangles % _EVERY:
        check_triangles(state.path, state.triangles)


def _component(state: _State, given: Attributes) -> None:
    state.components.append(_use(state, given))


def _item(state: _State, given: Attributes) -> None:
    state.items.append(_use(state, given))


_HANDLERS: dict[str, Callable[[_State, Attributes], None]] = {
    "model": _model, "object": _object, "vertex": _vertex, "triangle": _triangle, "component": _component,
    "item": _item,
}  # fmt: skip


def _finish(state: _State, given: Attributes) -> None:
    key = given["id"]
    vertices = np.frombuffer(state.places).reshape(-1, 3)
    faces = np.frombuffer(state.corners, dtype=np.int64).reshape(-1, 3)
    if given.get("type", "model") not in _SHOWN:
        faces = faces[:0]
    if key in state.objects:
        fail(state.path, "is given twice; the file is damaged", f"object {key[:20]!r}")
    state.objects[key] = Object(given.get("name", ""), vertices, faces, tuple(state.components))
    state.current = None


def _use(state: _State, given: Attributes) -> Use:
    state.uses += 1
    check_nodes(state.path, state.uses)
    file = next((value for key, value in given.items() if key.rpartition(":")[2] == "path"), "")
    name = given.get("partnumber", "")
    return Use(given["objectid"], _matrix(state, given.get("transform", "")), file, name)


def _matrix(state: _State, text: str) -> Array:
    """(4, 4) of twelve numbers, which 3MF gives for rows."""
    matrix = np.eye(4)
    if text:
        numbers = np.array([float(word) for word in text.split()])
        if len(numbers) != 12 or not (np.abs(numbers) < 1e12).all():
            fail(state.path, "should be twelve finite numbers", "transform")
        matrix[:3] = numbers.reshape(4, 3).T
    return matrix
