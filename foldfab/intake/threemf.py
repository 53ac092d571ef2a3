"""3MF: build items, components and objects become bodies where their transforms place them."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.intake.limits import (
    LARGEST_UNPACKED,
    MOST_EXPANDED,
    check_bodies,
    check_depth,
    check_nodes,
    check_triangles,
    content,
    fail,
)
from foldfab.intake.meshes import body, placed, product
from foldfab.intake.model import Body, Shapes
from foldfab.intake.threemf_xml import ModelFile, Object, Use, parse
from foldfab.recipe.problems import shown

_START = "3D/3dmodel.model"
"""Where the model lies by custom, whatever its relations say."""
_UNREADABLE = (
    zipfile.BadZipFile, zlib.error, struct.error, EOFError, NotImplementedError, RuntimeError, OSError, ValueError,
)  # fmt: skip
"""What `zipfile` raises over archives that are damaged or encrypted."""
_TINY = 100_000
"""Bytes unpacked that are let through whatever their ratio: little text packs well."""
MILLIMETRES = {"micron": 1e-3, "millimeter": 1.0, "centimeter": 10.0, "inch": 25.4, "foot": 304.8, "meter": 1000.0}


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    """An object that waits to be shown."""

    file: str
    use: Use
    outer: Array
    depth: int
    above: str
    path: frozenset[tuple[str, str]]
    """The objects that it lies within."""


def read(path: Path) -> Shapes:
    """The bodies of a 3MF file, in the unit that it states, Z up.

    Raises:
        RecipeError: it is no 3MF file, is damaged, unpacks to far more than it is, or is too large.
    """
    data = content(path)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            files = _Files(path, archive, len(data), {})
            main = _start(path, archive)
            model = files.model(main)
            bodies = _bodies(path, files, main)
    except _UNREADABLE as error:
        fail(path, f"is no 3MF file, or damaged: it cannot be unpacked ({str(error)[:80]})")
    if model.unit not in MILLIMETRES:
        fail(path, f"should be one of {', '.join(MILLIMETRES)}, not {shown(model.unit)}", "model.unit")
    return Shapes(bodies, millimetres=MILLIMETRES[model.unit])


@dataclass(frozen=True, slots=True, eq=False)
class _Files:
    """The models of an archive, each read once."""

    path: Path
    archive: zipfile.ZipFile
    size: int
    read: dict[str, ModelFile]

    def model(self, name: str) -> ModelFile:
        """The model file of that name."""
        if name not in self.read:
            check_nodes(self.path, len(self.read))
            try:
                info = self.archive.getinfo(name)
            except KeyError:
                fail(self.path, f"has no {shown(name)} in it; the file is damaged")
            if info.flag_bits & 1:
                fail(self.path, "is encrypted; save it without a password")
            self._allow(info)
            with self.archive.open(info) as stream:
                self.read[name] = parse(self.path, stream)
        return self.read[name]

    def _allow(self, info: zipfile.ZipInfo) -> None:
        unpacked = info.file_size + sum(self.archive.getinfo(name).file_size for name in self.read)
        if unpacked > max(_TINY, MOST_EXPANDED * self.size) or unpacked > LARGEST_UNPACKED:
            text = f"unpacks to {unpacked / 1e6:.0f} MB, far more than a model of its {self.size / 1e6:.2g} MB does"
            fail(self.path, f"{text}; it is not read")


def _start(path: Path, archive: zipfile.ZipFile) -> str:
    names = archive.namelist()
    check_nodes(path, len(names))
    if _START in names:
        return _START
    models = [name for name in names if name.lower().endswith(".model")]
    if not models:
        fail(path, "is a ZIP archive without a 3D model; is it a 3MF file?")
    return models[0]


def _bodies(path: Path, files: _Files, main: str) -> tuple[Body, ...]:
    uses = files.model(main).items or _unused(files.model(main))
    pending = [_Place(main, use, np.eye(4), 0, "", frozenset()) for use in reversed(uses)]
    found: list[Body] = []
    triangles = steps = 0
    while pending:
        place = pending.pop()
        steps += 1
        check_nodes(path, steps)
        check_depth(path, place.depth)
        thing, file, matrix = _shown(path, files, place)
        name = thing.name or place.use.name or place.above
        if len(thing.faces):
            triangles += len(thing.faces)
            check_triangles(path, triangles)
            check_bodies(path, len(found) + 1)
            # Judged before it is placed: a matrix would hide a NaN among its own.
            whole = body(path, name, thing.vertices, thing.faces)
            moved = placed(whole.mesh, matrix)
            found.append(body(path, name, moved.vertices, moved.faces))
        within = place.path | {(file, place.use.object)}
        inner = [_Place(file, use, matrix, place.depth + 1, name, within) for use in thing.components]
        pending += reversed(inner)
    if not found:
        fail(path, "holds no triangles")
    return tuple(found)


def _shown(path: Path, files: _Files, place: _Place) -> tuple[Object, str, Array]:
    """The object of a place, its file, and its matrix (4, 4)."""
    file = place.use.file.lstrip("/") or place.file
    thing = files.model(file).objects.get(place.use.object)
    if thing is None:
        fail(path, "names an object that is not there; the file is damaged", f"object {shown(place.use.object)}")
    if (file, place.use.object) in place.path:
        fail(path, "is a component of itself; the file is damaged", f"object {shown(place.use.object)}")
    return thing, file, product(place.outer, place.use.matrix)


def _unused(model: ModelFile) -> tuple[Use, ...]:
    """All objects that no other one uses, for files without a build."""
    used = {use.object for thing in model.objects.values() for use in thing.components}
    return tuple(Use(key, np.eye(4)) for key in model.objects if key not in used)
