"""One picture of the bodies in one pose: flat shading, drawn edges, a soft shadow on the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from foldfab.export import raster, shadow
from foldfab.export.camera import Camera, Window, pixels
from foldfab.export.colours import COLOURS, NAMES, materials
from foldfab.export.frames import moved
from foldfab.export.shell import Shell
from foldfab.geometry.arrays import Array, Bools, Indices

Pixels = NDArray[np.uint8]
"""(height, width, 3) sRGB."""

BACKGROUND = np.array([250.0, 250.0, 251.0])
EDGE = np.array([58.0, 60.0, 66.0])
"""Colour that edges are drawn in, sRGB."""
EDGE_STRENGTH = 0.75
"""How much of that colour covers what is beneath."""
CREASE_COSINE = float(np.cos(np.radians(30.0)))
"""Faces of one body that meet at more than this are parted by an edge; a knuckle's facets are not."""
STEP_MM, STEP_PIXELS = 0.7, 1.5
"""How far a surface must jump behind itself for an edge."""
AMBIENT, LAMP, SKY = 0.67, 0.28, 0.12
"""How bright a face is of itself, turned to the lamp, and turned up."""
SHADE = 0.6
"""How much of the lamp's light is lost in the shadow of another body."""


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """All triangles of all bodies in one heap, in the order of the bodies."""

    points: Array
    """(n, 3) mm, open posture, sheet frame."""
    owner: Indices
    """(n,) body of each point."""
    faces: Indices
    """(m, 3)"""
    body: Indices
    """(m,) body of each face."""
    colour: Array
    """(m, 3) sRGB of each face."""
    is_foldable: Bools
    """(m,) whether each face is a foldable panel's or an added hinge's."""


def model(shells: tuple[Shell, ...]) -> Model:
    """One heap of the shells' triangles."""
    sizes = [len(shell.vertices) for shell in shells]
    starts = np.cumsum(sizes) - sizes
    numbers = np.arange(len(shells))
    index = np.concatenate([materials(shell) for shell in shells])
    return Model(
        points=np.vstack([shell.vertices for shell in shells]),
        owner=np.repeat(numbers, sizes),
        faces=np.vstack([shell.faces + start for shell, start in zip(shells, starts, strict=True)]),
        body=np.repeat(numbers, [len(shell.faces) for shell in shells]),
        colour=np.array(COLOURS, dtype=float)[index],
        is_foldable=index != NAMES.index("base"),
    )


def posed(heap: Model, poses: Array) -> Array:
    """(n, 3) points with each body moved by its (b, 4, 4) pose."""
    points = np.empty_like(heap.points)
    for number, pose in enumerate(poses):
        own = heap.owner == number
        points[own] = moved(heap.points[own], pose)
    return points


def draw(heap: Model, points: Array, camera: Camera, window: Window, ground: float) -> Pixels:
    """A picture of the model with its (n, 3) posed points, standing on the plane z = ground."""
    seen, depth = raster.visible(pixels(points, camera, window)[heap.faces], window.height, window.width)
    normals = _normals(heap, points)
    light = shadow.is_lit(heap.faces, points, normals, seen, depth, camera, window)
    image = BACKGROUND * (1 - shadow.ground_shadow(heap.faces, points, camera, window, ground)[..., None])
    is_solid = seen != raster.NOTHING
    image[is_solid] = _shaded(heap, normals, seen[is_solid], light[is_solid], camera)
    edges = _edges(seen, depth, heap.body, normals, window.scale)
    image[edges] = image[edges] * (1 - EDGE_STRENGTH) + EDGE * EDGE_STRENGTH
    return np.asarray(image + 0.5).astype(np.uint8)


def foldable_share(heap: Model, points: Array, camera: Camera, window: Window) -> float:
    """Share of the picture's pixels in which foldable parts are seen."""
    seen, _ = raster.visible(pixels(points, camera, window)[heap.faces], window.height, window.width)
    return float(heap.is_foldable[seen[seen != raster.NOTHING]].sum() / seen.size)


def _normals(heap: Model, points: Array) -> Array:
    a, b, c = (points[heap.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30))


def _shaded(heap: Model, normals: Array, triangle: Indices, light: Array, camera: Camera) -> Array:
    """(k, 3) colours of the pixels that see those triangles, given the share of the lamp's light that reaches them."""
    lamp = np.clip(normals @ shadow.lamp(camera).rows()[2], 0.0, 1.0)
    still = AMBIENT + SKY * (0.5 + 0.5 * normals[:, 2])
    strength = still[triangle] + LAMP * lamp[triangle] * (1 - SHADE * (1 - light))
    return np.asarray(np.minimum(heap.colour[triangle] * strength[:, None], 254.5))


def _edges(seen: Indices, depth: Array, body: Indices, normals: Array, scale: float) -> Bools:
    """Pixels on an outline, between two bodies, on a crease or where one surface hides another."""
    edges = np.zeros(seen.shape, dtype=bool)
    for near, far in (_SIDE_BY_SIDE, _ONE_OVER_THE_OTHER):
        places = np.nonzero(seen[near] != seen[far])
        is_edge = _is_parted(seen[near][places], seen[far][places], body, normals)
        for side in (near, far):
            edges[side][places] |= is_edge
    for first, second in _ACROSS:
        middle = seen[_INNER]
        places = np.nonzero((seen[first] != middle) | (seen[second] != middle))
        triangles = [seen[side][places] for side in (first, _INNER, second)]
        depths = [depth[side][places] for side in (first, _INNER, second)]
        edges[_INNER][places] |= _is_step(triangles, depths, body, scale)
    return edges


_SIDE_BY_SIDE = np.s_[:, :-1], np.s_[:, 1:]
_ONE_OVER_THE_OTHER = np.s_[:-1, :], np.s_[1:, :]
_INNER = np.s_[1:-1, 1:-1]
_ACROSS = (np.s_[:-2, 1:-1], np.s_[2:, 1:-1]), (np.s_[1:-1, :-2], np.s_[1:-1, 2:])


def _is_parted(first: Indices, second: Indices, body: Indices, normals: Array) -> Bools:
    """(k,) whether two different triangles, or a triangle and nothing, meet in an edge."""
    is_outline = (first == raster.NOTHING) | (second == raster.NOTHING)
    is_other = body[first] != body[second]
    is_crease = np.einsum("ij,ij->i", normals[first], normals[second]) < CREASE_COSINE
    return np.asarray(is_outline | is_other | is_crease)


def _is_step(triangles: list[Indices], depths: list[Array], body: Indices, scale: float) -> Bools:
    """(k,) where a body's own surface jumps by over half a millimetre; depth bends there, on a slope it does not."""
    is_solid = np.all([triangle != raster.NOTHING for triangle in triangles], axis=0)
    is_own = is_solid & (body[triangles[0]] == body[triangles[1]]) & (body[triangles[2]] == body[triangles[1]])
    before, here, after = (np.where(is_own, depth, 0.0) for depth in depths)
    return np.asarray(np.abs(before + after - 2 * here) > STEP_MM * scale + STEP_PIXELS)
