"""How the bodies lie on the printer's bed, by posture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from foldfab.export.frames import moved
from foldfab.export.packing import packed
from foldfab.export.shell import GRID_DIGITS, Shell, bounds, snapped
from foldfab.fabrication.lying import lying
from foldfab.fabrication.model import Assembly, Body
from foldfab.fabrication.posture import needs_pins, printed_turn
from foldfab.geometry.arrays import Array

FIT_MM = 1e-6
"""How far the print may stand out of the build volume by rounding."""

SPACE_MM = 8.0
"""Room between parts that are printed side by side: more than slicers leave when they arrange them anew."""
RIM_MM = 8.0
"""The same along the edges of the bed."""


def on_bed(assembly: Assembly) -> tuple[Shell, ...]:
    """All bodies as they will be printed: on z = 0, in the middle of the bed, turned a quarter if they only fit so."""
    volume = np.array(assembly.solution.scaffold.recipe.print.printer.build_volume)
    bodies = _printed(assembly)
    points = _postured(assembly, bodies)
    if not _fits(points, volume) and _fits(turned := [_quarter(p) for p in points], volume):
        points = turned
    low, high = np.vstack(points).min(axis=0), np.vstack(points).max(axis=0)
    middle = (low + high) / 2
    shift = np.array([volume[0] / 2 - middle[0], volume[1] / 2 - middle[1], -low[2]])
    shells = tuple(snapped(body, p + shift) for body, p in zip(bodies, points, strict=True))
    return _grounded(shells)


def on_plates(assembly: Assembly) -> tuple[tuple[Shell, ...], ...]:
    """All bodies, each flat on the bed for itself, spread over as many plates as it takes, each in the bed's middle."""
    volume = assembly.solution.scaffold.recipe.print.printer.build_volume
    laid = [lying(body) for body in assembly.bodies]
    sizes = [(float(x), float(y)) for x, y in (np.ptp(points[:, :2], axis=0) for points in laid)]
    spots = packed(sizes, (volume[0], volume[1]), SPACE_MM, RIM_MM)
    plates: list[list[tuple[Body, Array]]] = [[] for _ in range(1 + max(spot.plate for spot in spots))]
    for body, points, spot in zip(assembly.bodies, laid, spots, strict=True):
        turned = _quarter(points) if spot.is_turned else points
        corner = np.append(turned[:, :2].min(axis=0) - spot.corner, 0.0)
        plates[spot.plate].append((body, turned - corner))
    return tuple(_centred(plate, volume) for plate in plates)


def print_files(assembly: Assembly) -> dict[str, tuple[Shell, ...]]:
    """By the name of the print file, the bodies in it as they lie on the bed."""
    name = assembly.solution.scaffold.recipe.name
    if not needs_pins(assembly.posture):
        return {f"{name}.3mf": on_bed(assembly)}
    return {f"{name}-{number}.3mf": shells for number, shells in enumerate(on_plates(assembly), 1)}


def _centred(plate: list[tuple[Body, Array]], volume: tuple[float, float, float]) -> tuple[Shell, ...]:
    heap = np.vstack([points for _, points in plate])
    middle = (heap.min(axis=0) + heap.max(axis=0)) / 2
    shift = np.array([volume[0] / 2 - middle[0], volume[1] / 2 - middle[1], 0.0])
    return tuple(snapped(body, points + shift) for body, points in plate)


def _printed(assembly: Assembly) -> tuple[Body, ...]:
    """The bodies, with their props where they are printed with one."""
    propped = {body.name: body for body in assembly.propped}
    return tuple(propped.get(body.name, body) for body in assembly.bodies)


def _postured(assembly: Assembly, bodies: tuple[Body, ...]) -> list[Array]:
    turn = printed_turn(assembly)
    if assembly.posture == "open":
        return [body.vertices @ turn.T for body in bodies]
    # Folded flat, the canonical frame's floor is the bed: d = -Z.
    return [moved(body.vertices, assembly.poses[body.name][-1]) @ turn.T for body in bodies]


def _fits(points: list[Array], volume: Array) -> bool:
    return bool(np.all(np.ptp(np.vstack(points), axis=0) <= volume + FIT_MM))


def _quarter(points: Array) -> Array:
    return np.column_stack([-points[:, 1], points[:, 0], points[:, 2]])


def _grounded(shells: tuple[Shell, ...]) -> tuple[Shell, ...]:
    # A pose that is not exact leaves the lowest corner some 1e-14 off the bed, which the grid may keep as -0.00001.
    low = round(float(bounds(shells)[0][2]), GRID_DIGITS)
    if low == 0.0:
        return shells
    return tuple(replace(shell, vertices=shell.vertices - [0.0, 0.0, low]) for shell in shells)
