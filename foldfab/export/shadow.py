"""Shadows: a soft one on the ground, and those that bodies cast on each other in the light of one lamp."""

from __future__ import annotations

import numpy as np

from foldfab.export import raster
from foldfab.export.camera import Camera, Window, fitted, pixels, projection
from foldfab.geometry.arrays import Array, Bools, Indices

LAMP_AZIMUTH, LAMP_ELEVATION = -40.0, 62.0
"""Degrees: how far the lamp stands to the eye's left, and above the horizon."""
LAMP_PIXELS = 900
"""Width and height of the lamp's own picture."""
BIAS_MM, BIAS_PIXELS = 0.25, 1.5
"""How far off its surface a point is lifted, so that a surface does not shade itself."""
SOFTNESS = 3
"""Pixels by which a shadow's edge is blurred to either side."""
GROUND_DARKNESS = 0.26
"""How dark the middle of the ground's shadow is."""
GROUND_LEAN = 0.5
"""Share of its true length that the ground's shadow is cast: a long one would leave the frame."""
GROUND_BLUR = 1 / 110
"""Radius of its blur over the width of the picture."""


def lamp(camera: Camera) -> Camera:
    """Where the light comes from, for an eye."""
    return Camera(camera.azimuth + LAMP_AZIMUTH, LAMP_ELEVATION)


def is_lit(
    faces: Indices, points: Array, normals: Array, seen: Indices, depth: Array, camera: Camera, window: Window
) -> Array:
    """(height, width) share of the lamp's light that reaches each pixel, its own slope aside; 1 on the background."""
    from PIL import Image, ImageFilter

    light = lamp(camera)
    view = fitted(points, light, width=LAMP_PIXELS, height=LAMP_PIXELS, margins=(4, 4))
    _, nearest = raster.visible(pixels(points, light, view)[faces], view.height, view.width)
    rows, columns = np.nonzero(seen != raster.NOTHING)
    matrix, offset = _crossing((camera, window), (light, view))
    lift = (normals @ light.rows().T) * (BIAS_MM * view.scale + BIAS_PIXELS)
    # Axis by axis: numpy multiplies tall matrices of three columns far slower.
    x, y, z = (
        columns * a + rows * b + depth[rows, columns] * c + lift[seen[rows, columns], axis] + offset[axis]
        for axis, (a, b, c) in enumerate(matrix.T)
    )
    column, row = (np.clip(value + 0.5, 0, LAMP_PIXELS - 1).astype(np.int64) for value in (x, y))
    share = np.full(seen.shape, 255, dtype=np.uint8)
    share[rows, columns] = np.where(z >= nearest[row, column], 255, 0)
    soft = Image.fromarray(share).filter(ImageFilter.BoxBlur(SOFTNESS))
    return np.asarray(soft, dtype=np.float64) / 255


def _crossing(first: tuple[Camera, Window], second: tuple[Camera, Window]) -> tuple[Array, Array]:
    """(3, 3) matrix and (3,) offset from the pixel coordinates of one view to those of another."""
    (matrix, offset), (other, beyond) = projection(*first), projection(*second)
    step = np.linalg.inv(matrix) @ other
    return step, beyond - offset @ step


def ground_shadow(faces: Indices, points: Array, camera: Camera, window: Window, ground: float) -> Array:
    """(height, width) how much light the plane z = ground loses, in [0, 1]."""
    from PIL import Image, ImageFilter

    mask = _cast(faces, points, camera, window, ground)
    blur = ImageFilter.GaussianBlur(window.width * GROUND_BLUR)
    blurred = Image.fromarray(mask.astype(np.uint8) * 255).filter(blur)
    return np.asarray(blurred, dtype=np.float64) * (GROUND_DARKNESS / 255)


def _cast(faces: Indices, points: Array, camera: Camera, window: Window, ground: float) -> Bools:
    light = lamp(camera).rows()[2]
    flat = points - np.maximum(points[:, 2] - ground, 0.0)[:, None] * (light / light[2] * GROUND_LEAN)
    flat[:, 2] = ground
    return raster.covered(pixels(flat, camera, window)[faces], window.height, window.width)
