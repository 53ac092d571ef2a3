"""Recipes as files of shapes that stand somewhere else, askew and in another size."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Mesh, Part, Recipe

from .furniture import box, obj


def as_mesh(part: Part) -> Mesh:
    """The box of a part as triangles, mm."""
    return box(tuple(part.center), tuple(part.size), part.axes)


def turn(seed: int) -> Array:
    """(3, 3) some rotation."""
    matrix = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    proper: Array = matrix * np.sign(np.linalg.det(matrix))
    return proper


def moved(mesh: Mesh, rotation: Array, shift: Array, factor: float) -> Mesh:
    """The mesh turned, shifted and made larger."""
    return Mesh(factor * (mesh.vertices @ rotation.T) + shift, mesh.faces)


def write(file: Path, recipe: Recipe, rotation: Array, shift: Array, factor: float) -> Path:
    """The recipe as an OBJ file that is moved."""
    meshes = {part.name: moved(as_mesh(part), rotation, shift, factor) for part in recipe.parts}
    file.write_text(obj(meshes, word="o"), encoding="utf-8")
    return file
