"""`sheet.json`: the measured facts of a print, those of the printed solids and those of the solution."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from foldfab.export.bed import print_files
from foldfab.export.frames import moved, sheet_poses, to_sheet
from foldfab.export.provenance import provenance
from foldfab.export.shell import Shell
from foldfab.export.version import foldfab_version
from foldfab.fabrication.latches import FILAMENT
from foldfab.fabrication.model import Assembly, Joint, Latch, Seam
from foldfab.fabrication.snaps import Snap, snaps
from foldfab.folding.model import Modification
from foldfab.geometry.arrays import Array

LENGTH_DIGITS = 6
SHARE_DIGITS = 9
"""Costs and importances must still add up within 1e-6 after many terms were rounded."""


def sheet_json(assembly: Assembly, shells: tuple[Shell, ...], stl_paths: dict[str, str]) -> str:
    """The text of `sheet.json`: (sheet frame, open posture) shells, and by body its STL's path in the folder."""
    return json.dumps(facts(assembly, shells, stl_paths), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def facts(assembly: Assembly, shells: tuple[Shell, ...], stl_paths: dict[str, str]) -> dict[str, Any]:
    """Everything that stands in `sheet.json`, in its order."""
    name = assembly.solution.scaffold.recipe.name
    return {
        "name": name,
        "about": assembly.solution.scaffold.recipe.about,
        "version": foldfab_version(),
        "provenance": provenance(assembly),
        **_print(assembly),
        **_sizes(assembly, shells),
        **_solution(assembly),
        "components": component_count([shell.name for shell in shells], assembly.joints),
        "parts": _parts(assembly, shells, stl_paths),
        **({"pieces": {part: list(names) for part, names in assembly.pieces.items()}} if assembly.pieces else {}),
        "joints": [_joint(assembly, joint) for joint in assembly.joints],
        "snaps": [_snap(snap) for snap in snaps(assembly.solution)],
        "findings": [{"code": finding.code, "text": finding.text} for finding in assembly.findings],
    }


def extents(assembly: Assembly, shells: tuple[Shell, ...], key: int) -> Array:
    """(3,) mm: axis-aligned size of all printed solids at a key time, sheet frame."""
    points = [moved(shell.vertices, sheet_poses(assembly, shell.name)[key]) for shell in shells]
    return np.asarray(np.ptp(np.vstack(points), axis=0))


def space_saving(assembly: Assembly, shells: tuple[Shell, ...]) -> float:
    """1 - folded over open bounding volume."""
    return 1.0 - float(extents(assembly, shells, -1).prod() / extents(assembly, shells, 0).prod())


def component_count(names: list[str], joints: tuple[Joint, ...]) -> int:
    """How many separate pieces the hinges leave."""
    leader = {name: name for name in names}

    def find(name: str) -> str:
        while leader[name] != name:
            name = leader[name]
        return name

    for joint in joints:
        leader[find(joint.parts[0])] = find(joint.parts[1])
    return len({find(name) for name in names})


def _print(assembly: Assembly) -> dict[str, Any]:
    scaffold, thickness = assembly.solution.scaffold, assembly.solution.thickness
    printer = scaffold.recipe.print.printer
    return {
        "posture": assembly.posture,
        "direction": _unit(scaffold.direction),
        "scale": float(scaffold.scale),
        "thickness_mm": _length(max((c.panel for c in assembly.solution.chains), default=thickness.panel)),
        "hinge": thickness.hinge,
        "clearance_mm": _length(thickness.gap),
        "clearance_from": scaffold.recipe.print.clearance_from,
        "printer": {"name": printer.name, "build_volume_mm": _lengths(np.array(printer.build_volume))},
        "propped": [body.name for body in assembly.propped],
        "print_files": list(print_files(assembly)),
    }


def _sizes(assembly: Assembly, shells: tuple[Shell, ...]) -> dict[str, Any]:
    return {
        "size_open_mm": _lengths(extents(assembly, shells, 0)),
        "size_folded_mm": _lengths(extents(assembly, shells, -1)),
        "space_saving": _share(space_saving(assembly, shells)),
    }


def _solution(assembly: Assembly) -> dict[str, Any]:
    solution = assembly.solution
    options = solution.scaffold.recipe.fold
    return {
        "options": {
            "alpha": float(options.alpha),
            "max_hinges": options.max_hinges,
            "shrink_steps": options.shrink_steps,
            "slanting": options.slanting,
            "stay_in_box": options.stay_in_box,
        },
        "cost": _share(solution.cost),
        "lower_bound": _share(min(solution.lower_bound, solution.cost)),
        "cost_terms": [_cost_term(modification) for modification in solution.modifications],
        "modifications": _modifications(assembly),
        "units": [
            {"name": step.unit, "patches": list(step.patches), "start": _share(step.start), "end": _share(step.end)}
            for step in solution.steps
        ],
    }


def _cost_term(modification: Modification) -> dict[str, Any]:
    return {
        "patch": modification.patch,
        "importance": _share(modification.importance),
        "hinges": modification.hinges,
        "window": [_share(end) for end in modification.window],
        "deleted": modification.is_deleted,
        "mechanism": modification.mechanism,
        "reason": modification.reason,
    }


def _modifications(assembly: Assembly) -> dict[str, Any]:
    solution = assembly.solution
    rows: dict[str, Any] = {}
    for part in solution.scaffold.recipe.parts:
        patches = [patch.name for patch in solution.scaffold.patches if part.name in patch.parts]
        if not patches:
            continue
        done = [solution.modification(name) for name in patches]
        rows[part.name] = {
            "windows": [[_share(end) for end in modification.window] for modification in done],
            "deleted": all(modification.is_deleted for modification in done),
        }
    return rows


def _parts(assembly: Assembly, shells: tuple[Shell, ...], stl_paths: dict[str, str]) -> list[dict[str, Any]]:
    return [
        {
            "name": body.name,
            "kind": body.kind,
            "stl": stl_paths[body.name],
            "volume_mm3": round(_volume(shell), 3),
            "normal": _unit(to_sheet(assembly, body.normal)),
        }
        for body, shell in zip(assembly.bodies, shells, strict=True)
    ]


def _volume(shell: Shell) -> float:
    corners = shell.vertices[shell.faces] - shell.vertices.mean(axis=0)
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)


def _joint(assembly: Assembly, joint: Joint) -> dict[str, Any]:
    return {
        "name": joint.name,
        "parts": list(joint.parts),
        "axis": [_lengths(point) for point in to_sheet(assembly, joint.axis)],
        "radius_mm": _length(joint.radius),
        "range_deg": [_length(angle) for angle in joint.range_deg],
        "inserted": joint.is_inserted,
        "stop_deg": list(joint.stop_deg),
        "stops": list(joint.stops),
        **({} if joint.latch is None else {"latch": _latch(assembly, joint.latch)}),
        **({} if joint.seam is None else {"seam": _seam(assembly, joint.seam)}),
    }


def _latch(assembly: Assembly, latch: Latch) -> dict[str, Any]:
    return {
        "base": latch.base,
        "pin_mm": FILAMENT,
        "length_mm": _length(latch.length),
        "ends": [_lengths(point) for point in to_sheet(assembly, np.array(latch.pin))],
        "into": _unit(to_sheet(assembly, np.array(latch.into))),
        "holds_at_deg": _length(latch.holds_at),
        "moment_nmm": round(latch.moment, 1),
    }


def _seam(assembly: Assembly, seam: Seam) -> dict[str, Any]:
    return {
        "kind": seam.kind,
        "keys": seam.keys,
        "fit_mm": _length(seam.fit),
        "pull": _unit(to_sheet(assembly, np.array(seam.pull))),
    }


def _snap(snap: Snap) -> dict[str, Any]:
    return {
        "patch": snap.patch,
        "rise_mm": _length(snap.rise),
        "estimate_mm": None if snap.estimate is None else _length(snap.estimate),
        "play_mm": _length(snap.play),
        "play_limit_mm": _length(snap.limit),
    }


def _length(value: float) -> float:
    return round(float(value), LENGTH_DIGITS) + 0.0


def _lengths(values: Array) -> list[float]:
    return [_length(value) for value in values]


def _unit(direction: Array) -> list[float]:
    return [_share(value) for value in direction]


def _share(value: float) -> float:
    return round(float(value), SHARE_DIGITS) + 0.0
