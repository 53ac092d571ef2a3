"""The picture inside a 3MF that file managers and slicers show: the print as it lies on the bed."""

from __future__ import annotations

import io

from foldfab.export import scene
from foldfab.export.camera import Camera, fitted
from foldfab.export.shell import Shell

SIDE = 256
"""Width and height, px, as slicers write it."""
SAMPLES = 2
"""Supersampling along each side."""
MARGIN = 10
"""px left free around the print."""
VIEW = Camera(-34.0, elevation=30.0)


def thumbnail_png(shells: tuple[Shell, ...]) -> bytes:
    """The picture of shells as they will be printed."""
    from PIL import Image

    heap = scene.model(shells)
    side, margin = SIDE * SAMPLES, float(MARGIN * SAMPLES)
    window = fitted(heap.points, VIEW, width=side, height=side, margins=(margin, margin))
    picture = Image.fromarray(scene.draw(heap, heap.points, VIEW, window, float(heap.points[:, 2].min())))
    buffer = io.BytesIO()
    picture.resize((SIDE, SIDE), Image.Resampling.BOX).save(buffer, "PNG", optimize=False, compress_level=6)
    return buffer.getvalue()
