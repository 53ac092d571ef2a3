"""A coupon becomes a print folder: one print file, an STL a body, a picture, and a sheet of what it is."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np

from foldfab.errors import MissingLibraryError, PrintFolderError
from foldfab.export import scene
from foldfab.export.camera import Camera, fitted
from foldfab.export.mesh_files import file_stems, stl_bytes
from foldfab.export.shell import Shell, bounds, snapped
from foldfab.export.swap import replace_folder
from foldfab.export.threemf import threemf_bytes
from foldfab.export.version import foldfab_version
from foldfab.fabrication.coupon import Coupon
from foldfab.recipe.model import Printer

NAME = "coupon"
VIEW = Camera(azimuth=-62.0, elevation=42.0)
"""From where its numbers are read."""
SIZE = (1500, 900)
"""Of the picture, px."""
SAMPLES = 2
"""Pixels drawn along each side of a pixel shown."""


def write_coupon(made: Coupon, printer: Printer, folder: Path) -> Path:
    """Writes `coupon/` into a folder, in place of an older one, and returns it.

    Raises:
        PrintFolderError: it does not fit the printer, or cannot be written.
    """
    shells = _on_bed(made, printer)
    stems = file_stems(shell.name for shell in shells)
    files = {f"stl/{stems[shell.name]}.stl": stl_bytes(shell) for shell in shells}
    files |= {f"{NAME}.3mf": threemf_bytes(NAME, shells), "preview.png": _picture(shells)}
    files["sheet.json"] = _sheet(made, printer, shells)

    def save(fresh: Path) -> None:
        (fresh / "stl").mkdir()
        for name, data in files.items():
            (fresh / name).write_bytes(data)

    return replace_folder(folder / NAME, save)


def _on_bed(made: Coupon, printer: Printer) -> tuple[Shell, ...]:
    """The bodies in the middle of the bed, turned a quarter where they only fit so."""
    points = [body.vertices for body in made.bodies]
    bed = np.array(printer.build_volume)
    size = np.ptp(np.vstack(points), axis=0)
    if not (size <= bed).all():
        points = [np.column_stack([-p[:, 1], p[:, 0], p[:, 2]]) for p in points]
        if not (size[[1, 0, 2]] <= bed).all():
            told = " x ".join(f"{side:.0f}" for side in size)
            raise PrintFolderError(
                f"the coupon is {told} mm and does not fit the {printer.name}; try a smaller thickness"
            )
    middle = (np.vstack(points).min(axis=0) + np.vstack(points).max(axis=0)) / 2
    shift = np.array([bed[0] / 2 - middle[0], bed[1] / 2 - middle[1], 0.0])
    return tuple(snapped(body, p + shift) for body, p in zip(made.bodies, points, strict=True))


def _sheet(made: Coupon, printer: Printer, shells: tuple[Shell, ...]) -> bytes:
    low, high = bounds(shells)
    facts = {
        "name": NAME,
        "version": foldfab_version(),
        "posture": made.posture,
        "thickness_mm": made.thickness,
        "clearances_mm": list(made.clearances),
        "printer": {"name": printer.name, "build_volume_mm": list(printer.build_volume)},
        "print_files": [f"{NAME}.3mf"],
        "size_mm": [round(float(side), 3) for side in high - low],
        "bodies": [body.name for body in made.bodies],
    }
    return (json.dumps(facts, indent=1) + "\n").encode()


def _picture(shells: tuple[Shell, ...]) -> bytes:
    try:
        from PIL import Image
    except ImportError as error:
        raise MissingLibraryError("drawing the preview needs the library Pillow; pip install pillow") from error

    heap = scene.model(shells)
    width, height = (SAMPLES * side for side in SIZE)
    window = fitted(heap.points, VIEW, width=width, height=height, margins=(120.0, 120.0))
    picture = Image.fromarray(scene.draw(heap, heap.points, VIEW, window, 0.0))
    buffer = io.BytesIO()
    picture.resize(SIZE, Image.Resampling.BOX).save(buffer, "PNG", optimize=False, compress_level=6)
    return buffer.getvalue()
