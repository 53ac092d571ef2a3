"""Hostile and broken files of every format, each with a word of the message that it deserves."""

from __future__ import annotations

import json
import os
import zipfile
from pathlib import Path
from typing import Any

from .furniture import glb, gltf, meshes, mjcf, model_xml, obj, stl, text_stl, threemf, urdf

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
TRIANGLE = SQUARE + "f 1 2 3\n"
ENTITIES = '<!DOCTYPE m [<!ENTITY a "aaaaaaaa"><!ENTITY b "&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;">]>'
OUTSIDE = '<!DOCTYPE m [<!ENTITY a SYSTEM "file:///etc/passwd">]>'
BODY = "<mujoco>{}<worldbody><body><geom {}/></body></worldbody></mujoco>"
LINK = '<robot><link name="a"><visual><geometry><{}/></geometry></visual></link></robot>'
BAIT = ("bait.obj", "bait.bin", "bait.stl")
"""Files beside the folder that some of them reach for."""

Case = tuple[str, bytes | str, str]


def lay_out(folder: Path) -> dict[str, str]:
    """Writes all of them into a folder that has the bait beside it; by file, the words."""
    for name in BAIT:
        (folder.parent / name).write_text(TRIANGLE, encoding="utf-8")
    (folder / "link.obj").symlink_to(folder.parent / "bait.obj")
    os.mkfifo(folder / "pipe.obj")
    expected = {"link.obj.urdf": "by a link", "pipe.obj": "not a plain file"}
    (folder / "link.obj.urdf").write_text(LINK.format('mesh filename="link.obj"'), encoding="utf-8")
    for number, (ending, data, says) in enumerate([*_plain(), *_gltf(), *_described(), *_recipes()]):
        file = folder / f"{number:02d}{ending}"
        file.write_bytes(data.encode() if isinstance(data, str) else data)
        expected[file.name] = says
    return expected | _archives(folder)


def _plain() -> list[Case]:
    some = meshes()["Top"]
    return [
        (".obj", "", "is empty"),
        (".obj", "hello", "no faces"),
        (".obj", "\0" * 9999, "no faces"),
        (".obj", b"\xff\xfe" + b"\x80" * 99, "no faces"),
        (".obj", SQUARE + "f 1 2 9\n", "beyond the 4"),
        (".obj", SQUARE + f"f 1 2 {10**30}\n", "line 5"),
        (".obj", "v nan 0 0\n" + TRIANGLE, "no place for furniture"),
        (".obj", "v 1e300 0 0\n" + TRIANGLE, "no place for furniture"),
        (".obj", "v 0 0 0\nf 1 1 1\n", "nothing in it has an area"),
        (".obj", "".join(f"g {n}\n{SQUARE}f -1 -2 -3\n" for n in range(5001)), "more than 5000 bodies"),
        (".obj", text_stl("a", some), "is a STL file"),
        (".stl", "", "is empty"),
        (".stl", "solid", "no STL file"),
        (".stl", stl(some)[:-9], "truncated"),
        (".stl", stl(some)[:80] + b"\xff" * 4 + bytes(50), "truncated"),
        (".stl", text_stl("a", some)[:-30], "truncated"),
        (".stl", text_stl("a", some).replace("vertex 0.0", "vertex nan", 1), "no place for furniture"),
        (".step", "", "is empty"),
        (".step", "hello", "does not begin with ISO-10303-21"),
        (".stp", stl(some), "does not begin with ISO-10303-21"),
        (".fbx", "hello", "is of a kind that is not read"),
        (".dae", OUTSIDE, "is of a kind that is not read"),
    ]


def _gltf() -> list[Case]:
    document, data = gltf(meshes())
    whole = glb(document, data)

    def changed(key: str, index: int, **values: Any) -> str:
        made = json.loads(json.dumps(document))
        made[key][index] |= values
        return json.dumps(made)

    return [
        (".glb", "", "is empty"),
        (".glb", whole[:40], "truncated"),
        (".glb", whole[:12] + b"\xff" * 8, "truncated"),
        (".glb", obj(meshes()), "no glTF file"),
        (".gltf", "[" * 99_999, "no glTF file"),
        (".gltf", "{}", "no asset"),
        (".gltf", changed("nodes", 0, children=[0]), "twice"),
        (".gltf", changed("nodes", 0, children=[1]), "twice"),
        (".gltf", changed("nodes", 0, scale=[1, 1, 1e308]), "3 finite numbers"),
        (".gltf", changed("accessors", 0, count=10**12), "more than"),
        (".gltf", changed("bufferViews", 0, byteOffset=10**12), "beyond its buffer"),
        (".gltf", changed("buffers", 0, uri="../bait.bin"), "leads out"),
        (".gltf", changed("buffers", 0, uri="..%2fbait.bin"), "leads out"),
        (".gltf", changed("buffers", 0, uri="/etc/passwd"), "leads out"),
        (".gltf", changed("buffers", 0, uri="file:///etc/passwd"), "same folder"),
        (".gltf", changed("buffers", 0, uri="https://example.org/a.bin"), "same folder"),
        (".gltf", changed("buffers", 0, uri="CON"), "leads out"),
    ]


def _described() -> list[Case]:
    return [
        (".urdf", "", "is empty"),
        (".urdf", urdf()[:-9], "is not XML"),
        (".urdf", ENTITIES + urdf(), "document type"),
        (".urdf", OUTSIDE + '<robot name="&a;"/>', "document type"),
        (".urdf", "<robot>" * 9999, "nested more than"),
        (".urdf", "<robot/>", "holds no shapes"),
        (".urdf", LINK.format('mesh filename="../bait.obj"'), "leads out"),
        (".urdf", LINK.format('mesh filename="package://../bait.obj"'), "beside it"),
        (".urdf", LINK.format('mesh filename="package://x/../bait.stl"'), "leads out"),
        (".urdf", LINK.format('mesh filename="/etc/passwd"'), "leads out"),
        (".urdf", LINK.format('mesh filename="ftp://a/b.obj"'), "same folder"),
        (".urdf", LINK.format('box size="1 nan 1"'), "3 finite numbers"),
        (".urdf", urdf().replace('parent link="Side left"', 'parent link="Top"'), "in a circle"),
        (".urdf", "<robot>" + "<link name='a'/>" * 100_001 + "</robot>", "more than 100000 nodes"),
        (".mjcf", ENTITIES + mjcf(), "document type"),
        (".mjcf", "<mujoco/>", "holds no shapes"),
        (".mjcf", BODY.format("", 'size="1e400"'), "finite numbers"),
        (".mjcf", BODY.format('<asset><mesh file="../bait.obj"/></asset>', 'mesh="bait"'), "leads out"),
        (".mjcf", BODY.format('<include file="/etc/passwd"/>', 'size="1"'), "do not stand in the file"),
        (".mjcf", "<mujoco><worldbody>" + "<body>" * 66 + "</body>" * 66 + "</worldbody></mujoco>", "nested more than"),
        (".xml", "<svg/>", "is neither URDF"),
    ]


def _recipes() -> list[Case]:
    return [
        (".json", json.dumps({"model": "../bait.obj"}), "leads out"),
        (".json", json.dumps({"model": "/etc/passwd"}), "leads out"),
        (".json", json.dumps({"parts": [{"name": "a", "mesh": "../bait.stl"}]}), "leads out"),
        (".json", json.dumps({"parts": [{"name": "../a", "box": {"center": [0, 0, 0], "size": [1, 1, 1]}}]}), "name"),
        (".json", "[" * 99_999, "nested"),
    ]


def _archives(folder: Path) -> dict[str, str]:
    one = {"leg": meshes()["Top"]}
    itself = '<object id="7"><components><component objectid="7"/></components></object>'
    doubles = "".join(
        f'<object id="{n}"><components>{f"""<component objectid="{n - 1}"/>""" * 2}</components></object>'
        for n in range(2, 40)
    )
    models: dict[str, tuple[str | bytes, str]] = {
        "empty": ("", "not XML"),
        "bomb": (model_xml(one).encode() + b" " * 20_000_000, "unpacks to 20 MB"),
        "entities": (model_xml(one).replace("?>", f"?>{ENTITIES}", 1), "document type"),
        "outside": (model_xml(one).replace("?>", f"?>{OUTSIDE}", 1), "document type"),
        "itself": (model_xml(one, more=itself, build='<item objectid="7"/>'), "component of itself"),
        "doubles": (model_xml(one, more=doubles, build='<item objectid="39"/>'), "more than"),
        "nan": (model_xml(one).replace('x="0.0"', 'x="nan"', 1), "no place for furniture"),
    }
    for name, (xml, _) in models.items():
        threemf(folder / f"{name}.3mf", xml)
    with zipfile.ZipFile(folder / "slip.3mf", "w") as archive:
        archive.writestr("../../slipped.txt", "x")
    (folder / "cut.3mf").write_bytes(threemf(folder / "whole.3mf", model_xml(one)).read_bytes()[:200])
    (folder / "whole.3mf").unlink()
    told = {f"{name}.3mf": says for name, (_, says) in models.items()}
    return told | {"slip.3mf": "without a 3D model", "cut.3mf": "no 3MF file"}
