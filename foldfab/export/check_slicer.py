"""Checks by the printer's own program: what PrusaSlicer makes of the print files, exactly as they lie."""

from __future__ import annotations

import tempfile
from collections import Counter
from dataclasses import asdict
from pathlib import Path

import numpy as np

from foldfab.errors import SlicingError
from foldfab.export.apart import Clash, Hinge, Outlines, outlines
from foldfab.export.check_solids import bodies_of
from foldfab.export.mesh_files import stl_bytes
from foldfab.export.placed import is_within, placement
from foldfab.export.read_files import PrintFile, read_stl, read_threemf
from foldfab.export.read_glb import pose, read_glb
from foldfab.export.report import Row, listed
from foldfab.export.shell import Shell
from foldfab.export.stated import Stated, StatedJoint, inside
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Printer
from foldfab.slicing.gcode import layers
from foldfab.slicing.model import SliceReport
from foldfab.slicing.program import Sliced, run

SAME_AXIS_MM = 1.0
"""Halves of a hinge whose axes lie further apart are printed side by side, not in place."""
KINDS = {"fused": "{} share an outline", "laid": "{} are laid onto each other", "lost": "{} has no outline"}


def check_slicer(folder: Path, stated: Stated, slicer: str) -> list[Row]:
    """Time, material, support, repairs, warnings and the outlines at hinges, of every print file.

    Raises:
        MissingLibraryError: PrusaSlicer is not there.
    """
    return [row for name in stated.print_files for row in _check_file(folder, name, stated, slicer)]


def _check_file(folder: Path, name: str, stated: Stated, slicer: str) -> list[Row]:
    file = inside(folder, name)
    x, y, z = stated.bed.tolist()
    one = read_threemf(file, is_loose=stated.posture == "plate")
    printer = Printer("", (x, y, z))
    rows: list[Row] = []
    try:
        bare, held = (run(file, printer, support=wanted, slicer=slicer) for wanted in (False, True))
        rows += [_figures(bare.report), _mesh(one, bare.report), _support(bare, held)]
        return [*rows, _apart(folder, one, stated, _as_one(one, printer, slicer))]
    except (SlicingError, ValueError) as error:
        return [*rows, Row("apart" if rows else "slicer", False, str(error))]


def _as_one(one: PrintFile, printer: Printer, slicer: str) -> Sliced:
    """The print sliced as one mesh without names.

    PrusaSlicer closes narrow gaps only within what has one name; programs that do not read the names close them all.
    """
    nameless = Shell("print", "base", one.vertices, one.faces, np.zeros(len(one.faces), dtype=bool))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "print.stl"
        file.write_bytes(stl_bytes(nameless))
        return run(file, printer, support=False, slicer=slicer)


def _figures(report: SliceReport) -> Row:
    text = (
        f"{report.slicer}: {told(report.seconds)}, {report.filament_g:.1f} g ({report.filament_cm3:.1f} cm³), "
        f"{report.layers} layers, {report.height_mm:.1f} mm, no warnings"
    )
    return Row("slicer", not report.warnings, listed(list(report.warnings)) or text, asdict(report))


def _mesh(one: PrintFile, report: SliceReport) -> Row:
    problems = [f"{name} {count}" for name, count in report.repairs]
    if not report.is_manifold:
        problems.append("not manifold")
    if report.bodies != len(one.volumes):
        problems.append(f"{report.bodies} bodies, named are {len(one.volumes)}")
    return Row("repairs", not problems, listed(problems) or f"none: manifold, {report.bodies} bodies")


def _support(bare: Sliced, held: Sliced) -> Row:
    """Support is a fact and no fault; what the slicer warns of with it would be one."""
    grams = held.report.support_g
    more = held.report.seconds - bare.report.seconds
    needed = f"{grams:.1f} g wanted, {told(more)} longer: {told(held.report.seconds)} in all"
    facts = {"needed": grams > 0, "support_g": grams, "seconds": held.report.seconds}
    problems = list(held.report.warnings)
    return Row("support", not problems, listed(problems) or (needed if grams else "none needed"), facts)


def _apart(folder: Path, one: PrintFile, stated: Stated, bare: Sliced) -> Row:
    hinges, astray = _hinges(folder, one, stated)
    if astray:
        return Row("apart", False, f"not the STL's bodies moved rigidly: {listed(astray)}")
    if not hinges:
        return Row("apart", True, "no hinge is printed in place")
    seen = outlines(bodies_of(one), hinges, layers(bare.gcode))
    facts = {"layers": seen.layers, "hinges": seen.hinges, "bodies": seen.expected, "outlines": seen.found}
    problems = _told_clashes(seen)
    if seen.hinges < len(hinges):
        problems.append(f"{len(hinges) - seen.hinges} hinges are cut by no layer")
    text = f"{seen.found} outlines of {seen.expected} pieces in {seen.layers} layers that cut {seen.hinges} hinges"
    return Row("apart", not problems, listed(problems) or text, facts)


def _told_clashes(seen: Outlines) -> list[str]:
    where: dict[tuple[str, tuple[str, ...]], list[Clash]] = {}
    for clash in seen.clashes:
        where.setdefault((clash.kind, clash.bodies), []).append(clash)
    counted = Counter({key: len(clashes) for key, clashes in where.items()})
    return [
        f"{KINDS[kind].format(' and '.join(bodies))} at z = {where[kind, bodies][0].z:.2f} mm ({count} times)"
        for (kind, bodies), count in counted.most_common()
    ]


def _hinges(folder: Path, one: PrintFile, stated: Stated) -> tuple[list[Hinge], list[str]]:
    """The hinges that this file prints in place, as they lie, and parts that are not as their STL is."""
    meshes = {name: (one.vertices, one.faces[first : last + 1]) for name, first, last in one.volumes}
    stls = {part.name: inside(folder, part.stl) for part in stated.parts}
    wanted = sorted({name for joint in stated.joints for name in joint.parts if set(joint.parts) <= set(meshes)})
    parts = {name: read_stl(stls[name]) for name in wanted}
    found = {n: m for n in wanted if n not in stated.propped and (m := placement(parts[n], meshes[n])) is not None}
    propped = [name for name in wanted if name in stated.propped]
    if propped and found:
        carried = _carried(folder, stated, found, propped)
        found |= {name: motion for name, motion in carried.items() if is_within(parts[name], meshes[name], motion)}
    placed = [_placed(joint, found) for joint in stated.joints if set(joint.parts) <= set(found)]
    return [hinge for hinge in placed if hinge is not None], [name for name in wanted if name not in found]


def _carried(folder: Path, stated: Stated, found: dict[str, Array], propped: list[str]) -> dict[str, Array]:
    """Where parts with props lie, whose meshes are not those of their STL: folded, as the others are."""
    fold = read_glb(inside(folder, f"{stated.name}.glb"))
    folded = {name: pose(fold, name, 1.0) @ np.linalg.inv(pose(fold, name, 0.0)) for name in (*found, *propped)}
    first = min(found)
    stand: Array = found[first] @ np.linalg.inv(folded[first])
    return {name: stand @ folded[name] for name in propped}


def _placed(joint: StatedJoint, motions: dict[str, Array]) -> Hinge | None:
    first, second = (joint.axis @ motions[name][:3, :3].T + motions[name][:3, 3] for name in joint.parts)
    is_in_place = bool(np.linalg.norm(first - second, axis=1).max() <= SAME_AXIS_MM)
    return Hinge(joint.name, joint.parts, (first + second) / 2, joint.radius) if is_in_place else None


def told(seconds: float) -> str:
    """`14 h 45 min`, or minutes alone."""
    minutes = round(seconds / 60)
    return f"{minutes // 60} h {minutes % 60} min" if minutes >= 60 else f"{minutes} min"
