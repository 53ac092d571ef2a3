"""Solids of a CAD kernel become bodies: triangles under the names of their products, where assemblies place them.

STEP is read by the kernel of build123d and not by `build123d.import_step`, which writes `_` for blanks and dots in
names and takes two seconds more to import.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from foldfab.errors import MissingLibraryError, RecipeError
from foldfab.geometry.arrays import Array, Indices
from foldfab.intake.limits import check_bodies, check_depth, check_nodes, check_triangles, fail
from foldfab.intake.meshes import body
from foldfab.intake.model import Body, Shapes
from foldfab.intake.naming import is_nameless

if TYPE_CHECKING:
    import build123d

COARSEST = 0.05
"""mm; triangles are no further than this from a curved face."""
TURN = 0.3
"""Radians between the triangles of a curved face."""
_ELSEWHERE = frozenset({"StepBasic_DocumentFile", "StepAP214_AppliedExternalIdentificationAssignment"})
"""Without these in a file the kernel follows no reference out of it."""
_SYSTEM_LIBRARY = re.compile(r"\blib[\w+-]+\.so[.\d]*")

Placed = tuple[str, Any]
"""A name, and a shape of the kernel where it stands."""


def read_step(path: Path) -> tuple[Body, ...]:
    """The solids in a STEP file, in mm. It may end the process over a damaged one.

    Raises:
        RecipeError: it cannot be read, or holds no solids, or too many.
        MissingLibraryError: build123d's kernel, or a system library that it needs, is absent.
    """
    try:
        import OCP.STEPCAFControl  # noqa: F401
    except ImportError as error:
        system = _SYSTEM_LIBRARY.search(str(error))
        advice = "apt-get install libgl1" if system else "pip install build123d"
        what = f"the system library {system[0]}" if system else f"the kernel of build123d ({error})"
        raise MissingLibraryError(f"STEP files need {what}, which is absent; {advice}") from error
    return _bodies(_assembly(path), path)


def read(shape: build123d.Shape, source: str) -> Shapes:
    """The solids of a build123d object, in mm, Z up.

    Raises:
        RecipeError: it holds no solids, or too many.
    """
    return Shapes(_bodies(_labelled(shape, source), source), millimetres=1.0)


def _bodies(placed: Iterator[Placed], source: Path | str) -> tuple[Body, ...]:
    """A body for each solid."""
    found: list[Body] = []
    triangles = 0
    for name, shape in placed:
        for solid in _solids(shape):
            made = body(source, name, *_triangles(solid))
            triangles += len(made.mesh.faces)
            check_triangles(source, triangles)
            check_bodies(source, len(found) + 1)
            found.append(made)
    if not found:
        fail(source, "holds no solids; export the furniture as solids, not as surfaces or lines")
    return tuple(found)


def _labelled(shape: build123d.Shape, source: str) -> Iterator[Placed]:
    """The leaves of a tree of build123d objects, named by their labels or by that of what they stand in."""
    import build123d

    pending = [(shape, build123d.Location(), 0, "")]
    while pending:
        node, outer, depth, above = pending.pop()
        check_depth(source, depth)
        if node.is_null:
            continue
        name = above if is_nameless(node.label or "") else node.label
        inner = outer * node.location
        pending += [(child, inner, depth + 1, name) for child in reversed(node.children)]
        if not node.children:
            yield name, node.moved(outer).wrapped


def _assembly(path: Path) -> Iterator[Placed]:
    """The leaves of a STEP file's assembly, named by their product or by that of the assembly that they stand in."""
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XCAF"))
    _transfer(path, document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    pending = [(label, TopLoc_Location(), 0, "") for label in reversed(_labels(tool.GetFreeShapes))]
    steps = 0
    while pending:
        label, outer, depth, above = pending.pop()
        steps += 1
        check_depth(path, depth)
        check_nodes(path, steps)
        product = _product(tool, label)
        here = outer.Multiplied(tool.GetLocation_s(label))
        name = next((name for name in (_name(product), _name(label)) if not is_nameless(name)), above)
        if tool.IsAssembly_s(product):
            inner = _labels(lambda found, of=product: tool.GetComponents_s(of, found))
            pending += [(component, here, depth + 1, name) for component in reversed(inner)]
        else:
            yield name, tool.GetShape_s(product).Moved(here)


def _transfer(path: Path, document: Any) -> None:
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    try:
        is_read = reader.ReadFile(str(path)) == IFSelect_RetDone
        if is_read:
            # Transferring reads what is referred to, wherever it lies.
            _require_whole(path, reader.Reader().Model())
            is_read = reader.Transfer(document)
    except (MemoryError, RecipeError):
        raise
    except Exception as error:
        # The kernel's exceptions have no common base of their own.
        fail(path, f"is no STEP file that can be read ({' '.join(str(error).split())[:120] or 'it is damaged'})")
    if not is_read:
        fail(path, "is no STEP file that can be read; it is truncated or damaged, export it again")


def _require_whole(path: Path, model: Any) -> None:
    """Raises: RecipeError: the file names files that hold a part of it."""
    kinds = {model.Value(index).DynamicType().Name() for index in range(1, model.NbEntities() + 1)}
    if not kinds.isdisjoint(_ELSEWHERE):
        fail(path, "refers to other files; export the furniture as one STEP file")


def _labels(fill: Any) -> list[Any]:
    from OCP.collections import Sequence_TDF_Label

    found = Sequence_TDF_Label()
    fill(found)
    return [found.Value(index + 1) for index in range(found.Length())]


def _product(tool: Any, label: Any) -> Any:
    """What a label refers to, itself where it refers to nothing."""
    from OCP.TDF import TDF_Label

    if not tool.IsReference_s(label):
        return label
    product = TDF_Label()
    tool.GetReferredShape_s(label, product)
    return product


def _name(label: Any) -> str:
    """The name of a label; where each byte of its UTF-8 was taken for a letter (build123d), mended."""
    from OCP.TDataStd import TDataStd_Name

    name = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), name):
        return ""
    text = str(name.Get().ToExtString())
    try:
        return text.encode("latin-1").decode("utf-8")
    except UnicodeError:
        return text


def _solids(shape: Any) -> Iterator[Any]:
    from OCP.TopAbs import TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, TopAbs_SOLID)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def _triangles(solid: Any) -> tuple[Array, Indices]:
    """Vertices (n, 3) and faces (m, 3), each face of the solid with vertices of its own."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    BRepMesh_IncrementalMesh(solid, COARSEST, False, TURN, False)
    points: list[Array] = [np.empty((0, 3))]
    faces: list[Indices] = [np.empty((0, 3), dtype=np.int64)]
    explorer, start = TopExp_Explorer(solid, TopAbs_FACE), 0
    while explorer.More():
        place = TopLoc_Location()
        face = explorer.Current()
        mesh = BRep_Tool.Triangulation_s(TopoDS.Face(face), place)
        explorer.Next()
        if mesh is None:
            continue
        nodes = np.array([mesh.Node(index).Coord() for index in range(1, mesh.NbNodes() + 1)])
        corners = np.array([mesh.Triangle(index).Get() for index in range(1, mesh.NbTriangles() + 1)])
        turn = place.Transformation()
        rows = np.array([[turn.Value(row, column) for column in range(1, 5)] for row in range(1, 4)])
        points.append(nodes @ rows[:, :3].T + rows[:, 3])
        faces.append((corners[:, ::-1] if face.Orientation() == TopAbs_REVERSED else corners) + start - 1)
        start += len(nodes)
    return np.concatenate(points), np.concatenate(faces)
