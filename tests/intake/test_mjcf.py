"""MJCF: bodies where they stand before anything moves. The poses were held against MuJoCo's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.intake.robots import read

from .furniture import SHELF, box, mjcf, obj
from .test_urdf import bounds

CUBE = '<geom type="box" size=".1 .2 .3"/>'


def model(path: Path, inner: str, head: str = "") -> dict[str, list[list[float]]]:
    (path / "a.xml").write_text(f"<mujoco>{head}<worldbody>{inner}</worldbody></mujoco>", encoding="utf-8")
    return bounds(read(path / "a.xml"))


def test_a_shelf_of_bodies(tmp_path: Path) -> None:
    (tmp_path / "a.mjcf").write_text(mjcf(), encoding="utf-8")
    found = read(tmp_path / "a.mjcf")
    assert (found.up, found.millimetres, [body.name for body in found.bodies]) == ("z", 1000.0, list(SHELF))
    for body in found.bodies:
        middle = (body.mesh.vertices.min(0) + body.mesh.vertices.max(0)) / 2
        assert np.allclose(1000 * middle, SHELF[body.name][0])


@pytest.mark.parametrize(
    ("geom", "half"),
    [
        ('type="box" size=".1 .2 .3"', [0.1, 0.2, 0.3]),
        ('size=".1"', [0.1, 0.1, 0.1]),
        ('type="cylinder" size=".1 .5"', [0.1, 0.1, 0.5]),
        ('type="capsule" size=".1 .5"', [0.1, 0.1, 0.6]),
        ('type="ellipsoid" size=".1 .2 .3"', [0.1, 0.2, 0.3]),
        ('type="cylinder" size=".1" fromto="-.5 0 0 .5 0 0"', [0.5, 0.1, 0.1]),
        ('type="capsule" size=".1" fromto="0 .5 0 0 -.5 0"', [0.1, 0.6, 0.1]),
        ('type="box" size=".1" fromto="0 0 -.5 0 0 .5"', [0.1, 0.1, 0.5]),
        ('type="box" size=".1 .2 .3" quat="1 0 0 1"', [0.2, 0.1, 0.3]),
        ('type="box" size=".1 .2 .3" euler="90 0 0"', [0.1, 0.3, 0.2]),
        ('type="box" size=".1 .2 .3" euler="90 90 0"', [0.3, 0.1, 0.2]),
        ('type="box" size=".1 .2 .3" axisangle="0 0 2 90"', [0.2, 0.1, 0.3]),
        ('type="box" size=".1 .2 .3" xyaxes="0 1 0 -1 0 0"', [0.2, 0.1, 0.3]),
        ('type="box" size=".1 .2 .3" zaxis="1 0 0"', [0.3, 0.2, 0.1]),
        ('type="mesh" mesh="leg"', [0.1, 0.4, 0.9]),
        ('mesh="leg" euler="0 0 90"', [0.4, 0.1, 0.9]),
    ],
)
def test_geoms(tmp_path: Path, geom: str, half: list[float]) -> None:
    (tmp_path / "m").mkdir()
    (tmp_path / "m" / "leg.obj").write_text(obj({"leg": box((0, 0, 0), (2, 4, 6))}), encoding="utf-8")
    head = '<compiler meshdir="m/"/><asset><mesh file="leg.obj" scale=".1 .2 .3"/></asset>'
    assert model(tmp_path, f'<body name="b"><geom {geom}/></body>', head)["b"] == [[-side for side in half], half]


@pytest.mark.parametrize(
    ("compiler", "euler", "half"),
    [
        ('angle="radian"', f"{np.pi / 2} 0 0", [0.1, 0.3, 0.2]),
        ('eulerseq="zyx"', "90 90 0", [0.2, 0.3, 0.1]),
        ('eulerseq="XYZ"', "90 90 0", [0.2, 0.3, 0.1]),
        ('eulerseq="ZYX"', "90 90 0", [0.3, 0.1, 0.2]),
    ],
)
def test_the_compilers_settings(tmp_path: Path, compiler: str, euler: str, half: list[float]) -> None:
    geom = f'<body name="b"><geom type="box" size=".1 .2 .3" euler="{euler}"/></body>'
    assert model(tmp_path, geom, f"<compiler {compiler}/>")["b"][1] == half


def test_bodies_within_bodies_and_frames(tmp_path: Path) -> None:
    inner = (
        f'<body name="a" pos="1 0 0" euler="0 0 90">{CUBE}<joint type="slide" ref="3"/>'
        f'<frame pos="1 0 0"><body name="b" pos="0 1 0">{CUBE}</body></frame></body>'
    )
    assert model(tmp_path, inner) == {
        "a": [[0.8, -0.1, -0.3], [1.2, 0.1, 0.3]],
        "b": [[-0.2, 0.9, -0.3], [0.2, 1.1, 0.3]],
    }


def test_defaults_hold_by_class(tmp_path: Path) -> None:
    head = (
        '<default><geom type="box" size=".1 .1 .1"/>'
        '<default class="slat"><geom size=".5 .1 .02"/>'
        '<default class="thin"><geom size=".5 .1 .01"/></default></default>'
        "</default>"
    )
    inner = (
        '<body name="plain"><geom/></body><body name="named"><geom class="slat"/></body>'
        '<body name="child" childclass="thin"><geom/><body name="own"><geom size=".3 .1 .1"/></body></body>'
    )
    found = {name: high for name, (_, high) in model(tmp_path, inner, head).items()}
    assert found == {
        "plain": [0.1, 0.1, 0.1], "named": [0.5, 0.1, 0.02], "child": [0.5, 0.1, 0.01], "own": [0.3, 0.1, 0.1],
    }  # fmt: skip


def test_what_only_shows_is_what_it_looks_like(tmp_path: Path) -> None:
    hull = '<geom type="box" size="1 1 1" group="3"/>'
    bare = '<geom type="box" size=".1 .2 .3" contype="0" conaffinity="0"/>'
    assert model(tmp_path, f'<body name="b">{hull}{bare}</body>')["b"][1] == [0.1, 0.2, 0.3]
    assert model(tmp_path, f'<body name="b">{hull}</body>')["b"][1] == [1, 1, 1]


def test_ground_is_no_furniture(tmp_path: Path) -> None:
    found = model(tmp_path, f'<geom type="plane" size="1 1 1"/><geom type="hfield"/><body name="b">{CUBE}</body>')
    assert list(found) == ["b"]


def body(inner: str) -> str:
    return f'<body name="b">{inner}</body>'


MESH = '<asset><mesh name="m" {}/></asset>'


@pytest.mark.parametrize(
    ("inner", "head", "says"),
    [
        ("", "", "holds no shapes"),
        (body('<geom type="box"/>'), "", "geom.size: is missing"),
        (body('<geom type="box" size="1 1"/>'), "", "geom.size: should be 3 above 0 for a box"),
        (body('<geom type="box" size="1 1 -1"/>'), "", "should be 3 above 0"),
        (body('<geom type="box" size="1 nan 1"/>'), "", "should be 1 or 2 or 3 finite numbers"),
        (body('<geom size="1" pos="0 0 1e300"/>'), "", "geom.pos: should be 3 finite numbers"),
        (body('<geom type="cylinder" size="1" fromto="1 1 1 1 1 1"/>'), "", "begins where it ends"),
        (body('<geom type="torus" size="1"/>'), "", "is of type 'torus', which is not read"),
        (body('<geom size="1" quat="0 0 0 0"/>'), "", "geom.quat: should not be zero"),
        (body('<geom size="1" axisangle="0 0 0 1"/>'), "", "should not be zero"),
        (body('<geom size="1" xyaxes="1 0 0 1 0 0"/>'), "", "two directions that differ"),
        (body('<geom size="1" quat="1 0 0 0" euler="0 0 0"/>'), "", "is turned by quat and by euler; keep one"),
        (body('<geom name="g" size="1" class="c"/>'), "", "geom 'g': names the class 'c', and there is no such"),
        (body('<geom type="mesh" mesh="m"/>'), "", "shows the mesh 'm', and there is no such asset"),
        (body('<geom type="mesh"/>'), "", "is of type 'mesh', which is not read"),
        (body('<geom mesh="m"/>'), MESH.format('file="none.obj"'), "mesh 'm'.file: there is no file 'none.obj'"),
        (body('<geom mesh="m"/>'), MESH.format('file="../m.obj"'), "leads out of the folder"),
        (body('<geom mesh="m"/>'), '<compiler meshdir="/etc"/>' + MESH.format('file="m.obj"'), "leads out of the"),
        (body('<geom mesh="m"/>'), '<compiler meshdir=".."/>' + MESH.format('file="m.obj"'), "leads out of the folder"),
        (body('<geom mesh="m"/>'), MESH.format('file="m.msh"'), "there is no file"),
        (body('<geom mesh="m"/>'), MESH.format('vertex="0 0 0"'), "has vertex, which is not read"),
        (body('<geom mesh="m"/>'), MESH.format(""), "has no file, which is not read"),
        (body(CUBE), MESH.format('file="a.obj"') * 2, "mesh 'm': is given twice"),
        (body(CUBE), '<compiler eulerseq="xyq"/>', "compiler.eulerseq: should be three of x, y and z"),
        (body(CUBE), '<compiler eulerseq="xYz"/>', "all small or all capital"),
        (body(CUBE), '<include file="more.xml"/>', "include makes parts that do not stand in the file"),
        (body('<replicate count="9999999">' + CUBE + "</replicate>"), "", "replicate makes parts"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(tmp_path: Path, inner: str, head: str, says: str) -> None:
    with pytest.raises(RecipeError) as caught:
        model(tmp_path, inner, head)
    assert says in str(caught.value)
