"""The picture in the 3MF shows the print as it lies."""

import io

import numpy as np
from PIL import Image

from foldfab.export.bed import on_bed
from foldfab.export.thumbnail import MARGIN, SIDE, thumbnail_png
from foldfab.fabrication.model import Assembly


def test_it_shows_all_of_the_print(assembly: Assembly, turned_assembly: Assembly) -> None:
    heights = []
    for one in (assembly, turned_assembly):
        pixels = np.asarray(Image.open(io.BytesIO(thumbnail_png(on_bed(one)))).convert("RGB")).astype(int)
        assert pixels.shape == (SIDE, SIDE, 3)
        red, _, blue = np.moveaxis(pixels, 2, 0)
        assert (red - blue > 90).sum() > 500, "foldable panels"
        rows, columns = np.nonzero(pixels.min(axis=2) < 170)
        assert min(rows.min(), columns.min()) >= MARGIN - 2 and max(rows.max(), columns.max()) <= SIDE - MARGIN + 2
        heights.append(np.ptp(rows) / np.ptp(columns))
    assert heights[1] < heights[0], "the second lies folded"
