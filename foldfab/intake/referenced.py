"""Files of shapes that a robot description names: in its own folder, each read once."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.intake import obj, stl
from foldfab.intake.inside import inside
from foldfab.intake.limits import FARTHEST, check_bodies, check_triangles, fail
from foldfab.intake.meshes import joined
from foldfab.recipe.model import Mesh
from foldfab.recipe.problems import shown

_READERS = {".obj": obj.read, ".stl": stl.read}
_PACKAGE = "package://"


@dataclass(frozen=True, slots=True, eq=False)
class References:
    """The meshes that were read so far."""

    path: Path
    """The description."""
    read: dict[Path, Mesh] = field(default_factory=dict)

    def mesh(self, reference: str, scale: Array, place: str) -> Mesh:
        """All bodies of a file as one mesh, each coordinate times its `scale` (3,).

        Raises:
            RecipeError: it is not in the folder, of another kind, or damaged.
        """
        # Packages are looked for where the description lies; their name is the folder's.
        name = reference.removeprefix(_PACKAGE).partition("/")[2] if reference.startswith(_PACKAGE) else reference
        file = inside(self.path, name, place)
        if file.suffix.lower() not in _READERS:
            fail(self.path, f"{shown(name)} is of a kind that is not read here; export it as .obj or .stl", place)
        if file not in self.read:
            check_bodies(self.path, len(self.read) + 1)
            self.read[file] = joined([body.mesh for body in _READERS[file.suffix.lower()](file).bodies])
            check_triangles(self.path, sum(len(mesh.faces) for mesh in self.read.values()))
        mesh = self.read[file]
        return Mesh(np.clip(mesh.vertices * scale, -2 * FARTHEST, 2 * FARTHEST), mesh.faces)
