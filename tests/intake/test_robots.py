"""Robot descriptions as files of furniture: told apart, within limits, and nothing in them believed."""

from __future__ import annotations

from pathlib import Path

import pytest

from foldfab.errors import RecipeError
from foldfab.intake import limits
from foldfab.intake.files import shapes
from foldfab.intake.robots import read

from .furniture import SHELF, box, glb, gltf, meshes, mjcf, obj, urdf

BOMB = '<!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
STEALS = '<!DOCTYPE robot [<!ENTITY a SYSTEM "file:///etc/passwd">]>'
HEAD = '<?xml version="1.0"?>'


@pytest.mark.parametrize(
    ("name", "text"), [("a.urdf", urdf()), ("a.xml", urdf()), ("a.mjcf", mjcf()), ("a.xml", mjcf()), ("a.urdf", mjcf())]
)
def test_each_by_its_root(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    assert [body.name for body in shapes(tmp_path / name).bodies] == list(SHELF)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.urdf", "", "is empty"),
        ("a.urdf", "hello", "is not XML"),
        ("a.xml", urdf()[:-20], "is not XML"),
        ("a.urdf", "\0" * 500, "is not XML"),
        ("a.xml", "<svg/>", "is neither URDF (<robot>) nor MJCF (<mujoco>): it begins with 'svg'"),
        ("a.urdf", HEAD + BOMB + urdf(), "declares a document type"),
        ("a.urdf", HEAD + STEALS + '<robot name="&a;"/>', "declares a document type"),
        ("a.mjcf", HEAD + BOMB.replace("robot", "mujoco") + mjcf(), "declares a document type"),
        ("a.urdf", "<robot>" * 100, "is nested more than"),
        ("a.xml", '<mujoco><worldbody>' + "<body>" * 69, "has assemblies nested more than 64 deep"),
        ("a.obj", urdf(), "is named as OBJ, but it is a URDF file by its content; rename it to .urdf"),
        ("a.stl", mjcf(), "it is a MJCF file by its content; rename it to .mjcf"),
        ("a.sdf", "<sdf/>", "is of a kind that is not read; export it as one of"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(tmp_path: Path, name: str, content: str, says: str) -> None:
    if says.startswith("has assemblies"):
        content += "</body>" * 69 + "</worldbody></mujoco>"
    (tmp_path / name).write_text(content, encoding="utf-8")
    with pytest.raises(RecipeError) as caught:
        shapes(tmp_path / name)
    assert says in str(caught.value)


def test_a_binary_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_bytes(glb(*gltf(meshes())))
    with pytest.raises(RecipeError, match="it is a GLB file"):
        shapes(tmp_path / "a.urdf")


def test_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.urdf").write_text(urdf(), encoding="utf-8")
    for name, most, says in (
        ("MOST_TRIANGLES", 50, "more than 50 triangles"),
        ("MOST_BODIES", 3, "more than 3 bodies"),
        ("MOST_NODES", 20, "more than 20 nodes"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(limits, name, most)
            with pytest.raises(RecipeError, match=says):
                read(tmp_path / "a.urdf")


def test_one_mesh_shown_many_times_is_read_once_and_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "leg.obj").write_text(obj({"leg": box((0, 0, 0), (2, 4, 6))}), encoding="utf-8")
    shown = '<visual><origin xyz="{} 0 0"/><geometry><mesh filename="leg.obj"/></geometry></visual>'
    links = "".join(f'<link name="l{n}">{shown.format(9 * n)}</link>' for n in range(50))
    (tmp_path / "a.urdf").write_text(f"<robot>{links}</robot>", encoding="utf-8")
    assert len(read(tmp_path / "a.urdf").bodies) == 50
    monkeypatch.setattr(limits, "MOST_TRIANGLES", 400)
    with pytest.raises(RecipeError, match="more than 400 triangles"):
        read(tmp_path / "a.urdf")


def test_a_link_out_of_the_folder_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "secret.obj").write_text(obj({"leg": box((0, 0, 0), (2, 4, 6))}), encoding="utf-8")
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "leg.obj").symlink_to(tmp_path / "secret.obj")
    mesh = '<visual><geometry><mesh filename="leg.obj"/></geometry></visual>'
    (tmp_path / "in" / "a.urdf").write_text(f'<robot><link name="a">{mesh}</link></robot>', encoding="utf-8")
    with pytest.raises(RecipeError, match="leads out of the folder by a link"):
        read(tmp_path / "in" / "a.urdf")
