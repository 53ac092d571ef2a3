"""A check of the STEP file, where a print folder has one: the same bodies as are printed, at the same places."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from foldfab.export.read_files import read_stl
from foldfab.export.report import Row, listed
from foldfab.export.stated import Stated, StatedPart, inside
from foldfab.fabrication.analytic import require

if TYPE_CHECKING:
    import build123d

VOLUME_SHARE = 0.01
"""By how much a CAD solid may differ from the printed one: facets take a little."""
PLACE_MM = 0.1
"""How far its bounds may be off: facets and simplified slivers take a little."""
READERS_NAMES = str.maketrans(" .()", "____")
"""What build123d makes of names when it reads them."""


def check_step(folder: Path, stated: Stated) -> list[Row]:
    """Every part is in the STEP file, coloured, of the volume that is printed within 1 %, where it is printed.

    No row where there is no such file: it is only written on request.

    Raises:
        MissingLibraryError: build123d, or a system library that it needs, is absent.
    """
    path = inside(folder, f"{stated.name}.step")
    if not path.is_file():
        return []
    require()
    import build123d as b3d

    found: defaultdict[str, list[build123d.Shape]] = defaultdict(list)
    for child in b3d.import_step(path).children:
        if child.solids():
            found[child.label].append(child)
    wanted: defaultdict[str, list[StatedPart]] = defaultdict(list)
    for part in stated.parts:
        wanted[part.name.translate(READERS_NAMES)].append(part)
    problems = [f"{name} is no part of the sheet" for name in found if name not in wanted]
    for label, parts in wanted.items():
        # Names that are read alike are told apart by their order, which is that of the sheet.
        bodies = found[label] if len(found[label]) == len(parts) else [None] * len(parts)
        for part, body in zip(parts, bodies, strict=True):
            problems += _problems(folder, part, body)
    return [Row("step", not problems, listed(problems) or f"{len(stated.parts)} named solids, as they are printed")]


def _problems(folder: Path, part: StatedPart, body: build123d.Shape | None) -> list[str]:
    if body is None:
        return [f"{part.name} is missing, or is there twice"]
    if len(body.solids()) != 1 or not body.is_valid:
        return [f"{part.name} is not one valid solid"]
    problems = [] if body.color is not None else [f"{part.name} has no colour"]
    if not abs(body.volume - part.volume) <= VOLUME_SHARE * part.volume:
        problems.append(f"{part.name}: volume {body.volume:.2f} mm³, printed {part.volume:.2f}")
    box, (vertices, _) = body.bounding_box(), read_stl(inside(folder, part.stl))
    off = np.abs([[*box.min] - vertices.min(axis=0), [*box.max] - vertices.max(axis=0)]).max()
    if not off <= PLACE_MM:
        problems.append(f"{part.name} stands {off:.2f} mm off the printed one")
    return problems
