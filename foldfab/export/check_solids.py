"""Checks of what will be printed: the STL files and the print file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from foldfab.export.read_files import PrintFile, read_stl, read_threemf
from foldfab.export.report import Row, listed
from foldfab.export.solid import Solid, close_pairs, solid
from foldfab.export.stated import Stated, StatedPart, inside
from foldfab.geometry.arrays import Array

OVERLAP_MM3 = 0.02
"""Penetration below this is rounding."""
VOLUME_SHARE, VOLUME_MM3 = 0.005, 0.01
"""By how much a volume may differ from the stated one."""
NARROWEST = 0.9
"""Share of the clearance that must be left between two bodies as printed."""
BED_MM = 1e-3
"""How far off the bed the print may stand."""


def check_stl(folder: Path, stated: Stated) -> list[Row]:
    """Every part's STL is watertight, one body, of the stated volume."""
    problems = [problem for part in stated.parts for problem in _stl_problems(folder, part)]
    text = listed(problems) or f"{len(stated.parts)} parts, watertight, one body each"
    return [Row("stl", not problems, text)]


def check_threemf(folder: Path, stated: Stated) -> list[Row]:
    """Each print file is strict 3MF of one item, names its bodies, fits the bed, stands on it and keeps its gaps."""
    is_loose = stated.posture == "plate"
    prints = [read_threemf(inside(folder, name), is_loose=is_loose) for name in stated.print_files]
    plates = [bodies_of(one) for one in prints]
    solids = [body for plate in plates for body in plate]
    problems = _print_problems(prints, stated)
    hanging = [b for b in solids if is_loose and abs(float(b.vertices[:, 2].min())) > BED_MM]
    problems += [f"{body.name} does not lie on the bed" for body in hanging]
    problems += [f"{body.name} is in several pieces" for body in solids if len(body.manifold.decompose()) != 1]
    text = listed(problems) or f"{len(stated.parts)} named bodies in {_where(stated)}, no warnings, fits the bed"
    return [Row("3mf", not problems, text), _gap(plates, stated.clearance)]


def same_volume(found: float, wanted: float) -> bool:
    """Whether two volumes, mm³, agree."""
    return abs(found - wanted) <= VOLUME_SHARE * wanted + VOLUME_MM3


def _stl_problems(folder: Path, part: StatedPart) -> list[str]:
    try:
        body = solid(part.name, *read_stl(inside(folder, part.stl))).manifold
    except OSError as error:
        return [f"{part.stl}: {error.strerror}"]
    except ValueError as error:
        return [str(error)]
    pieces = len(body.decompose())
    if pieces != 1:
        return [f"{part.name}: {pieces} bodies in one file"]
    if not same_volume(body.volume(), part.volume):
        return [f"{part.name}: volume {body.volume():.2f} mm³, the sheet says {part.volume:.2f}"]
    return []


def _print_problems(prints: list[PrintFile], stated: Stated) -> list[str]:
    problems = []
    names = sorted(name for one in prints for name, _, _ in one.volumes)
    if names != sorted(part.name for part in stated.parts):
        problems.append("the named bodies are not the parts of the sheet")
    for one in prints:
        low, high = one.vertices.min(axis=0), one.vertices.max(axis=0)
        if one.warnings:
            problems.append(f"{one.warnings} warnings in strict mode")
        if not one.is_sound:
            problems.append("the mesh is not closed")
        if not np.all(high - low <= stated.bed + BED_MM):
            problems.append(f"{_size(high - low)} mm do not fit the bed of {_size(stated.bed)} mm")
        if not abs(low[2]) <= BED_MM:
            problems.append(f"stands {low[2]:.3f} mm off the bed")
    return problems


def _size(values: Array) -> str:
    return " x ".join(f"{value:.1f}" for value in values)


def bodies_of(one: PrintFile) -> list[Solid]:
    """The named bodies of a print file.

    Raises:
        ValueError: one of them is not closed.
    """
    bodies = []
    for name, first, last in one.volumes:
        used, faces = np.unique(one.faces[first : last + 1], return_inverse=True)
        bodies.append(solid(name, one.vertices[used], faces.reshape(-1, 3)))
    return bodies


def _where(stated: Stated) -> str:
    count = len(stated.print_files)
    return "one mesh" if stated.posture != "plate" else f"{count} plate{'s' * (count != 1)}"


def _gap(plates: list[list[Solid]], clearance: float) -> Row:
    """O(pairs of near boxes)."""
    least, where = np.inf, ""
    for solids, i, j in ((s, *pair) for s in plates for pair in close_pairs([b.vertices for b in s], 2 * clearance)):
        a, b = solids[i], solids[j]
        overlap = (a.manifold ^ b.manifold).volume()
        gap = 0.0 if overlap > OVERLAP_MM3 else a.manifold.min_gap(b.manifold, 2 * clearance)
        if gap < least:
            least, where = gap, f"{a.name} and {b.name}"
    if not where:
        return Row("gap", True, "no two bodies come near each other")
    text = f"narrowest gap {least:.3f} mm, between {where}; clearance {clearance:g} mm"
    return Row("gap", bool(least >= NARROWEST * clearance), text)
