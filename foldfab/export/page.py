"""A page of pictures: furniture in several poses from one view, in a grid under a caption, each with a label."""

from __future__ import annotations

import io
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from foldfab.export import scene
from foldfab.export.camera import Camera, Window, fitted
from foldfab.export.colours import COLOURS
from foldfab.geometry.arrays import Array

if TYPE_CHECKING:
    from PIL import Image, ImageDraw, ImageFont

CAMERAS = tuple(Camera(azimuth, elevation=21.0) for azimuth in (-34.0, 34.0, 146.0, -146.0))
"""The four three-quarter views, the favourite first."""
MUCH_BETTER = 1.2
"""How much more of the foldable parts another view than the favourite must show to be taken."""
CELL = (500, 395)
"""Width and height of a frame, px."""
HEAD = 84
"""Height of the caption above the frames, px."""
FOOT = 26
"""Height of the margin below them, px."""
MARGIN = 30
"""px left free around the furniture in each frame."""
SAMPLES = 2
"""Supersampling: pixels drawn along each side of a pixel shown."""
SCOUTING = 0.25
"""The same for pictures that only choose the view."""
INK, FAINT, RULE = (38, 40, 46), (112, 116, 124), (226, 227, 230)
PAPER = (250, 250, 251)


@dataclass(frozen=True, slots=True, eq=False)
class Frames:
    """The pictures of some poses, and from where they are seen."""

    pictures: tuple[Image.Image, ...]
    camera: Camera


def frames(heap: scene.Model, points: list[Array]) -> Frames:
    """A picture for each pose of the model: (n, 3) points, all at one scale, from where most of the fold is seen."""
    from PIL import Image

    camera = _camera(heap, points)
    window = _window(camera, np.vstack(points), SAMPLES)
    ground = float(min(p[:, 2].min() for p in points))
    pictures = (Image.fromarray(scene.draw(heap, p, camera, window, ground)) for p in points)
    return Frames(tuple(picture.resize(CELL, Image.Resampling.BOX) for picture in pictures), camera)


def page_png(frames: tuple[Image.Image, ...], labels: list[str], columns: int, title: str, line: str) -> bytes:
    """The pictures row by row, each over its label; above them a title, a line of facts and what the colours mean."""
    from PIL import Image

    rows = -(-len(frames) // columns)
    sheet = Image.new("RGB", (CELL[0] * columns, HEAD + CELL[1] * rows + FOOT), PAPER)
    for number, (frame, text) in enumerate(zip(frames, labels, strict=True)):
        corner = (number % columns * CELL[0], HEAD + number // columns * CELL[1])
        sheet.paste(frame, corner)
        _label(sheet, corner, text)
    _caption(sheet, title, line)
    buffer = io.BytesIO()
    sheet.save(buffer, "PNG", optimize=False, compress_level=6)
    return buffer.getvalue()


def _camera(heap: scene.Model, points: list[Array]) -> Camera:
    """The view that shows most of the foldable parts, open, halfway and flat."""
    shown = []
    for camera in CAMERAS:
        window = _window(camera, np.vstack(points), SCOUTING)
        shares = [
            scene.foldable_share(heap, p, camera, window) for p in (points[0], points[len(points) // 2], points[-1])
        ]
        # Seen in all frames is better than seen well in one.
        shown.append(float(np.sum(np.sqrt(shares))))
    best = int(np.argmax(shown))
    return CAMERAS[best] if shown[best] > MUCH_BETTER * shown[0] else CAMERAS[0]


def _window(camera: Camera, points: Array, samples: float) -> Window:
    """One window for all frames, with room for the labels below."""
    width, height = (round(side * samples) for side in CELL)
    margins = (samples * MARGIN, samples * MARGIN * 1.5)
    window = fitted(points, camera, width=width, height=height, margins=margins)
    right, down = window.middle
    return replace(window, middle=(right, down + samples * MARGIN / 2 / window.scale))


def _label(sheet: Image.Image, corner: tuple[int, int], text: str) -> None:
    draw, font = _pen(sheet, 22)
    place = (corner[0] + CELL[0] // 2, corner[1] + CELL[1] - 20)
    draw.text(place, text, fill=INK, font=font, anchor="mm")


def _caption(sheet: Image.Image, title: str, line: str) -> None:
    draw, font = _pen(sheet, 30)
    draw.text((MARGIN, 30), title, fill=INK, font=font, anchor="lm")
    _, small = _pen(sheet, 18)
    draw.text((MARGIN, 62), line, fill=FAINT, font=small, anchor="lm")
    draw.line([(MARGIN, HEAD), (sheet.width - MARGIN, HEAD)], fill=RULE, width=1)
    right = sheet.width - MARGIN
    for text, colour in zip(("hinge added", "foldable panel", "base"), reversed(COLOURS), strict=True):
        draw.text((right, 30), text, fill=FAINT, font=small, anchor="rm")
        right -= round(draw.textlength(text, font=small)) + 24
        draw.rounded_rectangle([(right, 22), (right + 16, 38)], radius=3, fill=colour)
        right -= 26


def _pen(sheet: Image.Image, size: int) -> tuple[ImageDraw.ImageDraw, ImageFont.FreeTypeFont | ImageFont.ImageFont]:
    from PIL import ImageDraw, ImageFont

    return ImageDraw.Draw(sheet), ImageFont.load_default(size=size)
