"""The picture shows six frames, in colours that tell the parts apart."""

import io

import numpy as np
from PIL import Image

from foldfab.export.page import CELL, HEAD
from foldfab.export.preview import caption, label, preview_png
from foldfab.export.shell import sheet_shells
from foldfab.fabrication.model import Assembly


def _pixels(assembly: Assembly) -> "np.ndarray[tuple[int, ...], np.dtype[np.uint8]]":
    return np.asarray(Image.open(io.BytesIO(preview_png(assembly, sheet_shells(assembly)))).convert("RGB"))


def test_bases_panels_and_hinges_are_seen_in_every_frame(assembly: Assembly) -> None:
    pixels = _pixels(assembly).astype(int)
    assert pixels.shape == (900, 1500, 3)
    red, _, blue = np.moveaxis(pixels, 2, 0)
    orange, bluish = (red - blue > 90), (blue - red > 60)
    grey = (abs(red - blue) < 25) & (red > 90) & (red < 215)
    for row in range(2):
        for column in range(3):
            top, left = HEAD + row * CELL[1], column * CELL[0]
            cell = np.s_[top : top + CELL[1], left : left + CELL[0]]
            assert orange[cell].sum() > 800 and grey[cell].sum() > 5000 and bluish[cell].sum() > 20


def test_the_last_frame_is_flatter_than_the_first(assembly: Assembly) -> None:
    pixels = _pixels(assembly).astype(int)
    heights = []
    for corner in ((HEAD + 1, 0), (HEAD + CELL[1], 2 * CELL[0])):
        cell = pixels[corner[0] : corner[0] + CELL[1] - 40, corner[1] : corner[1] + CELL[0]]
        rows = np.flatnonzero((cell.min(axis=2) < 200).any(axis=1))
        heights.append(rows.max() - rows.min())
    assert heights[1] < 0.7 * heights[0]


def test_words(assembly: Assembly) -> None:
    assert [label(time) for time in (0.0, 0.2, 1.0)] == ["open", "20 %", "flat"]
    text = caption(assembly, sheet_shells(assembly))
    assert "saves 77 %" in text and "1 hinge added" in text and "125 x 50 x 73 to 125 x 50 x 17 mm" in text
