"""URDF: links where the joints at zero place them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.intake.model import Shapes
from foldfab.intake.robots import read

from .furniture import SHELF, box, obj, stl, urdf

CUBE = '<visual><geometry><box size="0.2 0.4 0.6"/></geometry></visual>'


def robot(path: Path, inner: str) -> Shapes:
    (path / "a.urdf").write_text(f'<?xml version="1.0"?>\n<robot name="r">{inner}</robot>', encoding="utf-8")
    return read(path / "a.urdf")


def bounds(shapes: Shapes) -> dict[str, list[list[float]]]:
    """By body, its least and greatest coordinates, to a micrometre."""
    found = {}
    for body in shapes.bodies:
        low, high = body.mesh.vertices.min(0), body.mesh.vertices.max(0)
        found[body.name] = [np.round(end, 6).tolist() for end in (low, high)]
    return found


def test_a_shelf_of_links(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(urdf(), encoding="utf-8")
    found = read(tmp_path / "a.urdf")
    assert (found.up, found.millimetres, [body.name for body in found.bodies]) == ("z", 1000.0, list(SHELF))
    first = SHELF["Side left"][0]
    for body in found.bodies:
        middle = (body.mesh.vertices.min(0) + body.mesh.vertices.max(0)) / 2
        assert np.allclose(1000 * middle + first, SHELF[body.name][0])


def test_joints_carry_what_hangs_on_them(tmp_path: Path) -> None:
    quarter = math.pi / 2
    joint = (
        f'<joint name="j" type="revolute"><origin xyz="1 0 0" rpy="0 0 {quarter}"/>'
        '<parent link="a"/><child link="b"/></joint>'
        f'<joint name="k" type="prismatic"><origin xyz="1 0 0"/><parent link="b"/><child link="c"/></joint>'
    )
    links = "".join(f'<link name="{name}">{CUBE}</link>' for name in "cba")
    assert bounds(robot(tmp_path, links + joint)) == {
        "c": [[0.8, 0.9, -0.3], [1.2, 1.1, 0.3]],
        "b": [[0.8, -0.1, -0.3], [1.2, 0.1, 0.3]],
        "a": [[-0.1, -0.2, -0.3], [0.1, 0.2, 0.3]],
    }


def test_roll_pitch_and_yaw_are_about_axes_that_stand_still(tmp_path: Path) -> None:
    """Rolled by a quarter, y lies along z; the yaw then leaves it, and turns x to y."""
    origin = f'<origin xyz="0 0 1" rpy="{math.pi / 2} 0 {math.pi / 2}"/>'
    cube = CUBE.replace("<geometry>", f"{origin}<geometry>")
    assert bounds(robot(tmp_path, f'<link name="a">{cube}</link>'))["a"] == [[-0.3, -0.1, 0.8], [0.3, 0.1, 1.2]]


@pytest.mark.parametrize(
    ("shape", "half"),
    [
        ('<cylinder radius="0.2" length="1"/>', [0.2, 0.2, 0.5]),
        ('<capsule radius="0.2" length="1"/>', [0.2, 0.2, 0.7]),
        ('<sphere radius="0.2"/>', [0.2, 0.2, 0.2]),
        ('<mesh filename="leg.obj"/>', [1.0, 2.0, 3.0]),
        ('<mesh filename="leg.stl" scale="0.1 0.2 1"/>', [0.1, 0.4, 3.0]),
        ('<mesh filename="package://chair/meshes/leg.obj"/>', [1.0, 2.0, 3.0]),
    ],
)
def test_shapes(tmp_path: Path, shape: str, half: list[float]) -> None:
    (tmp_path / "meshes").mkdir()
    leg = box((0, 0, 0), (2, 4, 6))
    for file in ("leg.obj", "meshes/leg.obj"):
        (tmp_path / file).write_text(obj({"leg": leg}), encoding="utf-8")
    (tmp_path / "leg.stl").write_bytes(stl(leg))
    found = robot(tmp_path, f'<link name="a"><visual><geometry>{shape}</geometry></visual></link>')
    assert bounds(found)["a"] == [[-side for side in half], half]


def test_collision_shapes_where_nothing_is_shown(tmp_path: Path) -> None:
    small = CUBE.replace("visual", "collision").replace("0.2 0.4 0.6", "1 1 1")
    assert bounds(robot(tmp_path, f'<link name="a">{CUBE}{small}</link>'))["a"][1] == [0.1, 0.2, 0.3]
    assert bounds(robot(tmp_path, f'<link name="a">{small}</link>'))["a"][1] == [0.5, 0.5, 0.5]


def link(name: str, inner: str = CUBE) -> str:
    return f'<link name="{name}">{inner}</link>'


def joint(parent: str, child: str, more: str = "") -> str:
    return f'<joint name="j"><parent link="{parent}"/><child link="{child}"/>{more}</joint>'


def shape(inner: str) -> str:
    return link("a", f"<visual><geometry>{inner}</geometry></visual>")


@pytest.mark.parametrize(
    ("inner", "says"),
    [
        ("", "holds no shapes"),
        ("<link>" + CUBE + "</link>", "link: has no name"),
        (link("a") + link("a"), "link 'a': is given twice"),
        (link("a") + joint("a", "b"), "joint 'j': names the child 'b', and there is no such link"),
        (link("a") + "<joint/>", "joint: names the parent '', and there is no such link"),
        (link("a") + joint("a", "a"), "'a' hang on each other in a circle"),
        (link("a") + link("b") + link("c") + joint("b", "c") + joint("c", "b"), "'b', 'c' hang on each other"),
        (link("a") + link("b") + joint("a", "b") * 2, "is the second joint that 'b' hangs on"),
        (link("a") + link("b") + joint("a", "b", '<origin xyz="1 2"/>'), "origin.xyz: should be 3 finite numbers"),
        (link("a") + link("b") + joint("a", "b", '<origin rpy="nan 0 0"/>'), "origin.rpy: should be 3 finite numbers"),
        (link("a", "<visual><geometry/></visual>"), "link 'a'.visual: has no shape"),
        (shape('<cone radius="1"/>'), "has 'cone' for its shape; give a box"),
        (shape("<box/>"), "box.size: is missing; give 3 finite numbers"),
        (shape('<box size="1 1 0"/>'), "box.size: should be above 0"),
        (shape('<box size="1 1 inf"/>'), "box.size: should be 3 finite numbers, not '1 1 inf'"),
        (shape('<box size="1 1 1e99"/>'), "should be 3 finite numbers"),
        (shape('<sphere radius="-1"/>'), "sphere.radius: should be above 0"),
        (shape('<cylinder radius="1"/>'), "cylinder.length: is missing"),
        (shape('<mesh filename="none.obj"/>'), "link 'a'.visual.mesh: there is no file 'none.obj' beside it"),
        (shape('<mesh filename="../a.obj"/>'), "leads out of the folder"),
        (shape('<mesh filename="package://p/../a.obj"/>'), "leads out of the folder"),
        (shape('<mesh filename="/etc/passwd"/>'), "leads out of the folder"),
        (shape('<mesh filename="file:///etc/passwd"/>'), "should be a file in the same folder"),
        (shape('<mesh filename="http://a/b.obj"/>'), "should be a file in the same folder"),
        (shape('<mesh filename=""/>'), "should be a file in the same folder"),
        (shape('<mesh filename="a.urdf"/>'), "is of a kind that is not read here; export it as .obj or .stl"),
        (shape('<mesh filename="bad.obj"/>'), "bad.obj: 1 problem"),
        (shape('<mesh filename="far.obj"/>'), "no place for furniture"),
        ('<xacro:macro name="leg"/>', "is a template for xacro"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, inner: str, says: str) -> None:
    (tmp_path / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n", encoding="utf-8")
    (tmp_path / "far.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", encoding="utf-8")
    with pytest.raises(RecipeError) as caught:
        robot(tmp_path, inner)
    assert says in str(caught.value)
