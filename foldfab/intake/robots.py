"""Robot descriptions, URDF and MJCF, in which furniture for simulators comes: the assembled pose, metres, Z up."""

from __future__ import annotations

from pathlib import Path

from foldfab.intake import mjcf, urdf
from foldfab.intake.limits import DEEPEST, fail
from foldfab.intake.markup import tree
from foldfab.intake.model import Shapes
from foldfab.intake.rigid import shapes_of
from foldfab.recipe.problems import shown

_MORE = 8
"""Levels of XML around and within the bodies of a model."""


def read(path: Path) -> Shapes:
    """The parts of a URDF or MJCF file, whichever it is, with the mesh files beside it that it names.

    Raises:
        RecipeError: it is neither, is damaged, refers to files outside its folder, or is too large.
    """
    root = tree(path, kind="robot description", deepest=DEEPEST + _MORE)
    if root.tag == "robot":
        return shapes_of(path, urdf.links(path, root))
    if root.tag == "mujoco":
        return shapes_of(path, mjcf.links(path, root))
    return fail(path, f"is neither URDF (<robot>) nor MJCF (<mujoco>): it begins with {shown(root.tag)}")
