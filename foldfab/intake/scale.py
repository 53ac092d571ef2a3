"""Which unit a file is in and which way is up: what is asked for, else what the format states, else a guess, told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from foldfab.errors import Problem, RecipeError
from foldfab.geometry.arrays import Array
from foldfab.intake.meshes import placed
from foldfab.intake.model import Body, Shapes, Up, Wishes
from foldfab.recipe.fields import MILLIMETRES
from foldfab.recipe.problems import shown

LARGEST_FURNITURE = 30_000.0
"""mm; glTF furniture that is larger was written in a CAD program's millimetres, not in metres."""
_LIKELY = (200.0, 5000.0)
"""mm; how long the longest side of furniture usually is."""
_GUESSES = ("mm", "m", "cm", "in")
"""In the order in which they are tried."""
_TURNS = {
    "x": np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "z": np.eye(3),
}
"""By the axis that points up in the file: what turns it to Z."""


def check(wishes: Wishes) -> None:
    """Raises: RecipeError: a unit, an axis or a size that there is not."""
    problems = []
    if wishes.units not in (None, *MILLIMETRES):
        problems.append(Problem("--units", f"should be one of {', '.join(MILLIMETRES)}, not {shown(wishes.units)}"))
    if wishes.up not in (None, *_TURNS):
        problems.append(Problem("--up", f"should be x, y or z, not {shown(wishes.up)}"))
    if wishes.smallest is not None and not 0 <= wishes.smallest < 1e6:
        problems.append(Problem("--smallest", f"should be a length in mm, not {wishes.smallest:g}"))
    if problems:
        raise RecipeError("command line", tuple(problems))


def in_millimetres(shapes: Shapes, wishes: Wishes) -> Shapes:
    """The bodies in millimetres, Z up, with notes on what was supposed."""
    reach = _reach(shapes.bodies)
    factor, up, notes = _factor(shapes, wishes, reach)
    matrix = np.eye(4)
    matrix[:3, :3] = factor * _TURNS[wishes.up or up]
    bodies = tuple(replace(body, mesh=placed(body.mesh, matrix)) for body in shapes.bodies)
    return Shapes(bodies, millimetres=1.0, notes=(*shapes.notes, *notes))


def _factor(shapes: Shapes, wishes: Wishes, reach: float) -> tuple[float, Up, tuple[str, ...]]:
    """Millimetres of a unit, the axis that points up, and what was supposed."""
    stated, up = shapes.millimetres, shapes.up
    if wishes.units is not None:
        return MILLIMETRES[wishes.units], up, ()
    if stated is None and wishes.default_units is not None:
        return MILLIMETRES[wishes.default_units], up, ()
    if stated is not None and (up == "z" or stated * reach <= LARGEST_FURNITURE):
        return stated, up, ()
    units = _guess(reach)
    size = f"so that its longest side is {reach * MILLIMETRES[units]:.4g} mm"
    if stated is None:
        return MILLIMETRES[units], up, (f"the file states no unit; taken as {units}, {size} (--units)",)
    told = f"in metres, as the format says, it would be {reach * stated / 1000:.4g} m long; taken as {units} with Z up"
    return MILLIMETRES[units], "z", (f"{told}, as CAD programs write it, {size} (--units, --up)",)


def _guess(reach: float) -> str:
    for units in _GUESSES:
        if _LIKELY[0] <= reach * MILLIMETRES[units] <= _LIKELY[1]:
            return units
    return "mm" if reach > 1 else "m"


def _reach(bodies: tuple[Body, ...]) -> float:
    low: Array = np.min([body.mesh.vertices.min(0) for body in bodies], axis=0)
    high: Array = np.max([body.mesh.vertices.max(0) for body in bodies], axis=0)
    return float((high - low).max())
