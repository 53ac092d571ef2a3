"""The print as CAD knows it: named, coloured solids with true cylinders, their hinges as joints, and as a STEP file.

STEP (AP214, what build123d writes) has no joints that CAD programs read. In Python they are build123d's own; in the
file each hinge is its axis, a line that is named after it and says how far it turns, for a mate to be put on.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np

from foldfab.errors import FabricationError
from foldfab.export.colours import COLOURS, HINGE, NAMES
from foldfab.export.frames import sheet_poses, to_sheet
from foldfab.export.step_order import canonical
from foldfab.fabrication.analytic import analytic, faceted, has_facets, require
from foldfab.fabrication.model import Assembly, Body, Joint
from foldfab.fabrication.shapes import Shape, placed
from foldfab.geometry.arrays import Array

if TYPE_CHECKING:
    import build123d

FIXED_TIME = "1980-01-01T00:00:00"
"""The same input gives the same bytes."""
AXES = "hinge axes"
"""Label of the lines that stand for the hinges."""
VOLUME_SHARE = 0.01
"""By how much a body may differ from the one that is printed: facets take a little."""
STILL = 1e-6
"""A turn whose sine adds up to less than this has no sense."""


def compound(assembly: Assembly) -> build123d.Compound:
    """All bodies as CAD solids under their names, open posture, sheet frame, mm, and the axes of their hinges.

    Each hinge is a `RevoluteJoint` on its first part and a `RigidJoint` on its second, both under the hinge's name:
    `a.joints[name].connect_to(b.joints[name], angle=…)` turns b about a, from 0 as it stands to the end of its range.

    Raises:
        FabricationError: the CAD kernel could not make a body, or made another one than is printed.
        MissingLibraryError: build123d, or a system library that it needs, is absent.
    """
    require()
    import build123d as b3d

    known: dict[Shape, b3d.Shape] = {}
    bodies = {body.name: _body(assembly, body, assembly.shapes[body.name], known) for body in assembly.bodies}
    for joint in assembly.joints:
        _join(assembly, joint, bodies)
    lines = b3d.Compound(label=AXES, children=[_line(assembly, joint) for joint in assembly.hinges])
    name = assembly.solution.scaffold.recipe.name
    return b3d.Compound(label=name, children=[*bodies.values(), lines])


def step_bytes(assembly: Assembly) -> bytes:
    """The STEP file of `compound`.

    Raises:
        FabricationError, MissingLibraryError: as for `compound`.
    """
    made = compound(assembly)
    import build123d as b3d

    file = io.BytesIO()
    b3d.export_step(made, file, timestamp=FIXED_TIME)
    return canonical(file.getvalue())


def _body(assembly: Assembly, body: Body, shape: Shape, known: dict[Shape, build123d.Shape]) -> build123d.Solid:
    try:
        solid = _made(body, placed(shape, np.zeros(3), assembly.solution.scaffold.rotation), known)
    except FabricationError:
        if not has_facets(shape):
            raise
        # What came as a mesh may be more than this kernel can join to a hinge: then it is as it is printed.
        solid = _checked(body, faceted(to_sheet(assembly, body.vertices), body.faces))
    solid.label, solid.color = body.name, _colour(NAMES.index(body.kind))
    return solid


def _made(body: Body, shape: Shape, known: dict[Shape, build123d.Shape]) -> build123d.Solid:
    try:
        solid = analytic(shape, known)
    except FabricationError as error:
        raise FabricationError(f"{body.name}: {error}") from error
    return _checked(body, solid)


def _checked(body: Body, solid: build123d.Solid) -> build123d.Solid:
    if abs(solid.volume - body.volume) > VOLUME_SHARE * body.volume:
        text = f"{body.name} has {solid.volume:.2f} mm³ for CAD and {body.volume:.2f} mm³ in print"
        raise FabricationError(f"{text}; try another scale or thickness")
    return solid


def _colour(material: int) -> build123d.Color:
    import build123d as b3d

    return b3d.Color(*(value / 255 for value in COLOURS[material]))


def _join(assembly: Assembly, joint: Joint, bodies: dict[str, build123d.Shape]) -> None:
    import build123d as b3d

    a, b = (bodies[name] for name in joint.parts)
    if joint.seam is not None:
        b3d.RigidJoint(joint.name, b, b3d.RigidJoint(joint.name, a).location)
        return
    axis = b3d.Axis(to_sheet(assembly, joint.axis[0]).tolist(), _sense(assembly, joint).tolist())
    hinge = b3d.RevoluteJoint(joint.name, a, axis, angular_range=joint.range_deg)
    b3d.RigidJoint(joint.name, b, hinge.location)


def _sense(assembly: Assembly, joint: Joint) -> Array:
    """(3,) unit vector along a hinge, sheet frame, about which its second part turns while it folds."""
    along = to_sheet(assembly, joint.axis[1] - joint.axis[0])
    a, b = (sheet_poses(assembly, name)[:, :3, :3] for name in joint.parts)
    turns = np.swapaxes(a, 1, 2) @ b
    # The skew part of a rotation is its axis times its sine, which says nothing at a half turn: so all are added up.
    skew = turns - np.swapaxes(turns, 1, 2)
    total = np.array([skew[:, 2, 1].sum(), skew[:, 0, 2].sum(), skew[:, 1, 0].sum()])
    sense: Array = along / np.linalg.norm(along) * (-1.0 if total @ along < -STILL else 1.0)
    return sense


def _line(assembly: Assembly, joint: Joint) -> build123d.Edge:
    import build123d as b3d

    line = b3d.Edge.make_line(*to_sheet(assembly, joint.axis).tolist())
    line.label = f"hinge {joint.name}, {joint.range_deg[0]:g} to {joint.range_deg[1]:g} deg"
    line.color = _colour(HINGE)
    return line
