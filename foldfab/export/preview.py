"""`preview.png`: six key frames of the fold from open to flat, after Fig. 18 of the paper."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from foldfab.export import scene
from foldfab.export.camera import Camera, Window, fitted
from foldfab.export.colours import COLOURS
from foldfab.export.frames import pose_at, sheet_poses
from foldfab.export.sheet import extents, space_saving
from foldfab.export.shell import Shell
from foldfab.fabrication.model import Assembly
from foldfab.geometry.arrays import Array

if TYPE_CHECKING:
    from PIL import Image, ImageDraw, ImageFont

CAMERAS = tuple(Camera(azimuth, elevation=21.0) for azimuth in (-34.0, 34.0, 146.0, -146.0))
"""The four three-quarter views, the favourite first."""
MUCH_BETTER = 1.2
"""How much more of the foldable parts another view than the favourite must show to be taken."""
COLUMNS, ROWS = 3, 2
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


def preview_png(assembly: Assembly, shells: tuple[Shell, ...]) -> bytes:
    """The picture of (sheet frame, open posture) shells, about 1500 by 900 px."""
    from PIL import Image

    times = [float(time) for time in np.linspace(0.0, 1.0, COLUMNS * ROWS)]
    sheet = Image.new("RGB", (CELL[0] * COLUMNS, HEAD + CELL[1] * ROWS + FOOT), PAPER)
    for number, (time, frame) in enumerate(zip(times, _frames(assembly, shells, times), strict=True)):
        corner = (number % COLUMNS * CELL[0], HEAD + number // COLUMNS * CELL[1])
        sheet.paste(frame, corner)
        _label(sheet, corner, label(time))
    _caption(sheet, assembly, shells)
    buffer = io.BytesIO()
    sheet.save(buffer, "PNG", optimize=False, compress_level=6)
    return buffer.getvalue()


def label(time: float) -> str:
    """What stands under the frame at a folding time."""
    return {0.0: "open", 1.0: "flat"}.get(time, f"{100 * time:.0f} %")


def caption(assembly: Assembly, shells: tuple[Shell, ...]) -> str:
    """The facts of the fold in one line."""
    hinges = sum(modification.hinges for modification in assembly.solution.modifications)
    steps = len(assembly.solution.steps)
    before, after = (" x ".join(f"{size:.0f}" for size in extents(assembly, shells, key)) for key in (0, -1))
    return (
        f"saves {100 * space_saving(assembly, shells):.0f} % of its space   ·   "
        f"{hinges} hinge{'s' * (hinges != 1)} added   ·   folds in {steps} step{'s' * (steps != 1)}   ·   "
        f"{before} to {after} mm"
    )


def _frames(assembly: Assembly, shells: tuple[Shell, ...], times: list[float]) -> list[Image.Image]:
    from PIL import Image

    heap = scene.model(shells)
    keys = [sheet_poses(assembly, shell.name) for shell in shells]
    points = [scene.posed(heap, np.array([pose_at(assembly.times, key, time) for key in keys])) for time in times]
    camera = _camera(heap, points)
    window = _window(camera, np.vstack(points), SAMPLES)
    ground = float(min(p[:, 2].min() for p in points))
    pictures = (Image.fromarray(scene.draw(heap, p, camera, window, ground)) for p in points)
    return [picture.resize(CELL, Image.Resampling.BOX) for picture in pictures]


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


def _caption(sheet: Image.Image, assembly: Assembly, shells: tuple[Shell, ...]) -> None:
    draw, font = _pen(sheet, 30)
    name = assembly.solution.scaffold.recipe.name
    draw.text((MARGIN, 30), name, fill=INK, font=font, anchor="lm")
    _, small = _pen(sheet, 18)
    draw.text((MARGIN, 62), caption(assembly, shells), fill=FAINT, font=small, anchor="lm")
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
