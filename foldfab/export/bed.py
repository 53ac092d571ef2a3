"""How the bodies lie on the printer's bed, by posture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from foldfab.export.frames import moved, to_sheet
from foldfab.export.shell import GRID_DIGITS, Shell, bounds, snapped
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.posture import printed_turn
from foldfab.geometry.arrays import Array

FIT_MM = 1e-6
"""How far the print may stand out of the build volume by rounding."""


def on_bed(assembly: Assembly) -> tuple[Shell, ...]:
    """All bodies as they will be printed: on z = 0, in the middle of the bed, turned a quarter if they only fit so."""
    volume = np.array(assembly.solution.scaffold.recipe.print.printer.build_volume)
    points = _postured(assembly)
    if not _fits(points, volume) and _fits(turned := [_quarter(p) for p in points], volume):
        points = turned
    low, high = np.vstack(points).min(axis=0), np.vstack(points).max(axis=0)
    middle = (low + high) / 2
    shift = np.array([volume[0] / 2 - middle[0], volume[1] / 2 - middle[1], -low[2]])
    shells = tuple(snapped(body, p + shift) for body, p in zip(assembly.bodies, points, strict=True))
    return _grounded(shells)


def _postured(assembly: Assembly) -> list[Array]:
    if assembly.posture == "open":
        return [to_sheet(assembly, body.vertices) for body in assembly.bodies]
    # Folded flat, the canonical frame's floor is the bed: d = -Z.
    turn = printed_turn(assembly)
    return [moved(body.vertices, assembly.poses[body.name][-1]) @ turn.T for body in assembly.bodies]


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
