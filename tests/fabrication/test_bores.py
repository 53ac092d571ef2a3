"""Pins go in from end to end, whatever stops their hinges got, and their bores print without support."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.bores import blocked, bored
from foldfab.fabrication.lying import lying
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.printed import printed
from foldfab.recipe.hinges import HingeKind

FILAMENT = 1.75 / 2


def halves(made: Assembly) -> dict[str, solids.Solid]:
    return {body.name: solids.from_mesh(body.vertices, body.faces) for body in made.bodies}


@pytest.mark.parametrize("name", ["table", "shelter"])
def test_filament_goes_through_hinges_that_have_stops(name: str, assembled: Callable[..., Assembly]) -> None:
    made = assembled(name, "plate", hinge="filament")
    assert any("tongue" in joint.stops for joint in made.joints)
    bodies = halves(made)
    for joint in made.joints:
        # Along y in both, and blind at one end only.
        (x, low, z), (_, high, _) = sorted(joint.axis.tolist(), key=lambda point: point[1])
        for tip in ((1.0, 0.0), (0.0, 1.0)):
            pin = solids.rod(FILAMENT, low + tip[0], high - tip[1], x, z)
            if all(solids.overlap(pin, bodies[part]) == 0 for part in joint.parts):
                break
        else:
            pytest.fail(f"no filament goes into {joint.name}")


@pytest.mark.parametrize(("hinge", "thickness"), [("screw-m2", 4.0), ("screw-m3", 6.0)])
def test_screws_do_too(hinge: HingeKind, thickness: float, assembled: Callable[..., Assembly]) -> None:
    made = assembled("table", "plate", hinge=hinge, thickness=thickness)
    assert not [finding for finding in made.findings if finding.code == "pin"]


def test_a_pin_that_cannot_be_put_in_is_told(assembled: Callable[..., Assembly]) -> None:
    made = assembled("table", "plate", hinge="filament")
    bodies = halves(made)
    assert blocked(made, bodies) == []
    joint = made.joints[0]
    plug = solids.box(joint.axis.mean(axis=0) - 1.0, joint.axis.mean(axis=0) + 1.0)
    bodies[joint.parts[0]] = solids.union([bodies[joint.parts[0]], plug])
    (finding,) = blocked(made, bodies)
    assert finding.is_fatal
    assert joint.name in finding.text


def test_no_ceiling_of_a_bore_is_flatter_than_its_roof(assembled: Callable[..., Assembly]) -> None:
    made = assembled("table", "plate", hinge="filament")
    (joint, *_) = made.joints
    leg = next(body for body in made.bodies if body.name in joint.parts and body.kind == "panel")
    corners = leg.vertices[leg.faces]
    axis = joint.axis.mean(axis=0)
    near = np.linalg.norm(corners[:, :, [0, 2]] - axis[[0, 2]], axis=2).max(axis=1) < 1.45
    lain = lying(leg)[leg.faces]
    normals = np.cross(lain[:, 1] - lain[:, 0], lain[:, 2] - lain[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    assert near.any()
    assert normals[near][:, 2].min() > -0.72


def test_shapes_are_bored_as_the_solids_are(assembled: Callable[..., Assembly]) -> None:
    made = assembled("shelter", "plate", hinge="filament")
    for body in made.bodies:
        assert printed(made.shapes[body.name]).volume() == pytest.approx(body.volume, rel=2e-3)


def test_hinges_without_a_pin_have_no_bores(assembled: Callable[..., Assembly]) -> None:
    made = assembled("table")
    bodies = halves(made)
    assert bored(made.solution, bodies, made.shapes) == (bodies, made.shapes)
