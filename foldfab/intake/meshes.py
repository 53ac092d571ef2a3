"""Triangles as files have them: judged, placed, joined and taken apart. Never repaired."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array, Indices, handed
from foldfab.intake.limits import FARTHEST, fail
from foldfab.intake.model import Body
from foldfab.recipe.model import Mesh
from foldfab.recipe.problems import shown

WELD_DIGITS = 6
"""Vertices are the same where they agree to so many digits of the body's size: exports write each face's own."""


def body(path: Path | str, name: str, vertices: Array, faces: Indices) -> Body:
    """A body of triangles that can be furniture; vertices (n, 3) that no face uses are dropped.

    Raises:
        RecipeError: it has a face beyond its vertices, or a vertex beyond reach.
    """
    where = f"body {shown(name)}"
    if len(faces) and (faces.min() < 0 or faces.max() >= len(vertices)):
        fail(path, f"has a face that names a vertex beyond its {len(vertices)}; the file is damaged", where)
    used = np.zeros(len(vertices), dtype=bool)
    used[faces.reshape(-1)] = True
    # Compared so that NaN is out of reach too; all at once takes no memory, and is enough as a rule.
    if len(vertices) and not (vertices.min() >= -FARTHEST and vertices.max() <= FARTHEST):
        wild = used & ~(np.abs(vertices) <= FARTHEST).all(1)
        if wild.any():
            seen = ", ".join(f"{value:g}" for value in vertices[int(np.argmax(wild))])
            fail(path, f"has a vertex at ({seen}), which is no place for furniture; export it again", where)
    if used.all():
        return Body(name, Mesh(vertices, faces))
    return Body(name, Mesh(handed(vertices[used]), handed((np.cumsum(used) - 1)[faces])))


def product(outer: Array, inner: Array) -> Array:
    """The matrix (4, 4) of both; without finite numbers where they are too large together, which `body` refuses."""
    with np.errstate(over="ignore", invalid="ignore"):
        found: Array = outer @ inner
    return found


def placed(mesh: Mesh, matrix: Array) -> Mesh:
    """The mesh under an affine (4, 4) matrix that acts on columns."""
    if (matrix == np.eye(4)).all():
        return mesh
    with np.errstate(over="ignore", invalid="ignore"):
        moved = mesh.vertices @ matrix[:3, :3].T
        moved += matrix[:3, 3]
        return Mesh(handed(np.nan_to_num(moved, copy=False, nan=2 * FARTHEST)), mesh.faces)


def joined(meshes: list[Mesh]) -> Mesh:
    """All as one mesh."""
    if len(meshes) == 1:
        return meshes[0]
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])[:-1]
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    faces = np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)])
    return Mesh(handed(vertices), handed(faces))


def shells(mesh: Mesh) -> list[Mesh]:
    """The pieces that hang together by common vertices, in the order of their first face."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    corners = _welded(mesh)[mesh.faces]
    count = int(corners.max(initial=-1)) + 1
    rows, columns = corners[:, [0, 1]].reshape(-1), corners[:, [1, 2]].reshape(-1)
    links = coo_array((np.ones(len(rows), dtype=bool), (rows, columns)), shape=(count, count))
    _, label = connected_components(links, directed=False)
    of_face = label[corners[:, 0]]
    _, first = np.unique(of_face, return_index=True)
    order = np.argsort(of_face, kind="stable")
    runs = np.split(order, np.nonzero(np.diff(of_face[order]))[0] + 1)
    if len(first) < 2:
        return [mesh]
    return [_only(mesh, mesh.faces[run]) for run in sorted(runs, key=lambda run: int(run[0]))]


def distinct(rows: Array) -> tuple[Array, Indices]:
    """The distinct rows (k, 3) of (n, 3), sorted, and which of them each row is (n,).

    As `np.unique` along an axis, in a third of the time.
    """
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    starts = np.concatenate([np.ones(min(1, len(rows)), dtype=bool), (ordered[1:] != ordered[:-1]).any(1)])
    found = ordered[starts]
    del ordered
    count = np.cumsum(starts)
    count -= 1
    which = np.empty(len(rows), dtype=np.int64)
    which[order] = count
    return found, handed(which)


def _welded(mesh: Mesh) -> Indices:
    """(n,) the same number for vertices that lie on each other."""
    reach = float(np.ptp(mesh.vertices, axis=0).max(initial=0.0)) or 1.0
    grid = np.round((mesh.vertices - mesh.vertices.min(0)) / reach, WELD_DIGITS)
    return distinct(grid)[1]


def _only(mesh: Mesh, faces: Indices) -> Mesh:
    used, renumbered = np.unique(faces, return_inverse=True)
    return Mesh(mesh.vertices[used], renumbered.reshape(-1, 3))
