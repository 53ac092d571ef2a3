"""`preview.png`: six key frames of the fold from open to flat, after Fig. 18 of the paper."""

from __future__ import annotations

import numpy as np

from foldfab.export import scene
from foldfab.export.frames import pose_at, sheet_poses
from foldfab.export.page import frames, page_png
from foldfab.export.sheet import extents, space_saving
from foldfab.export.shell import Shell
from foldfab.fabrication.model import Assembly

COLUMNS, ROWS = 3, 2


def preview_png(assembly: Assembly, shells: tuple[Shell, ...]) -> bytes:
    """The picture of (sheet frame, open posture) shells, about 1500 by 900 px."""
    times = [float(time) for time in np.linspace(0.0, 1.0, COLUMNS * ROWS)]
    heap = scene.model(shells)
    keys = [sheet_poses(assembly, shell.name) for shell in shells]
    points = [scene.posed(heap, np.array([pose_at(assembly.times, key, time) for key in keys])) for time in times]
    name = assembly.solution.scaffold.recipe.name
    labels = [label(time) for time in times]
    return page_png(frames(heap, points).pictures, labels, COLUMNS, name, caption(assembly, shells))


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
