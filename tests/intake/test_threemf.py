"""3MF: objects, components, transforms, units; bombs and damage."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.intake import limits
from foldfab.intake.threemf import read

from .furniture import SHELF, box, meshes, model_xml, threemf

LEG = {"leg": box((0, 0, 50), (10, 10, 100))}
PLACE = 'transform="1 0 0 0 1 0 0 0 1 {} 0 0"'
QUARTER = 'transform="0 1 0 -1 0 0 0 0 1 0 0 0"'


def bounds(body: Any) -> Any:
    return np.array([body.mesh.vertices.min(0), body.mesh.vertices.max(0)])


def test_items_are_bodies(tmp_path: Path) -> None:
    shapes = read(threemf(tmp_path / "a.3mf", model_xml(meshes())))
    assert [body.name for body in shapes.bodies] == list(SHELF)
    assert (shapes.up, shapes.millimetres) == ("z", 1.0)
    for body, mesh in zip(shapes.bodies, meshes().values(), strict=True):
        assert np.array_equal(body.mesh.vertices, mesh.vertices)


@pytest.mark.parametrize(("unit", "millimetres"), [("inch", 25.4), ("meter", 1000), ("micron", 0.001), ("foot", 304.8)])
def test_units(tmp_path: Path, unit: str, millimetres: float) -> None:
    assert read(threemf(tmp_path / "a.3mf", model_xml(LEG, unit))).millimetres == millimetres


def test_components_within_components(tmp_path: Path) -> None:
    pair = f'<object id="7" name="pair"><components><component objectid="1" {PLACE.format(0)}/>'
    pair += f'<component objectid="1" {PLACE.format(100)}/></components></object>'
    build = f'<item objectid="7" {QUARTER}/>'
    first, second = read(threemf(tmp_path / "a.3mf", model_xml(LEG, more=pair, build=build))).bodies
    assert (first.name, second.name) == ("leg", "leg")
    assert np.allclose(bounds(first), [[-5, -5, 0], [5, 5, 100]])
    assert np.allclose(bounds(second), [[-5, 95, 0], [5, 105, 100]])


def test_objects_in_other_models_of_the_archive(tmp_path: Path) -> None:
    inner = '<object id="9"><components><component objectid="1" p:path="/3D/legs.model"/></components></object>'
    xml = model_xml({}, more=inner, build='<item objectid="9" partnumber="front"/>')
    xml = xml.replace("<model ", '<model xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" ')
    body = read(threemf(tmp_path / "a.3mf", xml, legs=model_xml({"": LEG["leg"]}))).bodies[0]
    assert body.name == "front"
    assert np.allclose(bounds(body), [[-5, -5, 0], [5, 5, 100]])


def test_without_a_build_what_no_object_uses_is_shown(tmp_path: Path) -> None:
    pair = f'<object id="7"><components><component objectid="1" {PLACE.format(20)}/></components></object>'
    bodies = read(threemf(tmp_path / "a.3mf", model_xml(LEG, more=pair, build=""))).bodies
    assert [bounds(body)[0].tolist() for body in bodies] == [[15, -5, 0]]


def test_supports_are_no_furniture(tmp_path: Path) -> None:
    xml = model_xml(meshes()).replace('name="Shelf" type="model"', 'name="Shelf" type="support"')
    assert [body.name for body in read(threemf(tmp_path / "a.3mf", xml)).bodies] == list(SHELF)[:-1]


ITSELF = '<object id="7"><components><component objectid="7"/></components></object>'
IN_TURNS = "".join(
    f'<object id="{one}"><components><component objectid="{other}"/></components></object>'
    for one, other in ((7, 8), (8, 7))
)
ENTITIES = '<!DOCTYPE m [<!ENTITY a "aaaaaaaa"><!ENTITY b "&a;&a;&a;">]>'


@pytest.mark.parametrize(
    ("xml", "says"),
    [
        (model_xml(LEG).replace("?>", f"?>{ENTITIES}", 1), "document type"),
        (model_xml(LEG).replace("?>", '?><!DOCTYPE m SYSTEM "file:///etc/passwd">', 1), "document type"),
        (model_xml(LEG)[:-30], "truncated or damaged"),
        ("", "not XML"),
        ("hello", "not XML"),
        ("<a>" * 100 + "</a>" * 100, "nested more than"),
        (model_xml(LEG, "league"), "micron"),
        (model_xml({}), "no triangles"),
        (model_xml(LEG, build='<item objectid="5"/>'), "not there"),
        (model_xml(LEG, build="<item/>"), "objectid"),
        (model_xml(LEG, more=ITSELF, build='<item objectid="7"/>'), "component of itself"),
        (model_xml(LEG, more=IN_TURNS, build='<item objectid="7"/>'), "component of itself"),
        (model_xml(LEG, build='<item objectid="1" transform="1 2 3"/>'), "twelve finite numbers"),
        (model_xml(LEG, build=f'<item objectid="1" {PLACE.format("inf")}/>'), "twelve finite numbers"),
        (model_xml(LEG, build=f'<item objectid="1" {PLACE.format("x")}/>'), "could not convert"),
        (model_xml(LEG, build=f'<item objectid="1" {PLACE.format("1e11")}/>'), "no place for furniture"),
        (model_xml(LEG).replace('x="-5.0"', 'x="nan"', 1), "no place for furniture"),
        (model_xml(LEG).replace('x="-5.0"', 'x="1e300"', 1), "no place for furniture"),
        (model_xml(LEG).replace('x="-5.0"', 'x="one"', 1), "could not convert"),
        (model_xml(LEG).replace('x="-5.0"', "", 1), "number should be"),
        (model_xml(LEG).replace('v1="1"', 'v1="99"', 1), "beyond its 8"),
        (model_xml(LEG).replace('v1="1"', 'v1="-1"', 1), "beyond its 8"),
        (model_xml(LEG).replace('v1="1"', f'v1="{10**30}"', 1), "number should be"),
        (model_xml(LEG | {"other": LEG["leg"]}).replace('id="2"', 'id="1"'), "given twice"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, xml: str, says: str) -> None:
    with pytest.raises(RecipeError) as caught:
        read(threemf(tmp_path / "a.3mf", xml))
    assert says in str(caught.value)


def test_a_tree_that_doubles_at_every_level(tmp_path: Path) -> None:
    doubles = "".join(
        f'<object id="{level}"><components>{f"""<component objectid="{level - 1}"/>""" * 2}</components></object>'
        for level in range(2, 40)
    )
    with pytest.raises(RecipeError, match="more than"):
        read(threemf(tmp_path / "a.3mf", model_xml(LEG, more=doubles, build='<item objectid="39"/>')))


def test_a_bomb_is_not_unpacked(tmp_path: Path) -> None:
    file = threemf(tmp_path / "a.3mf", model_xml(LEG).encode() + b" " * 20_000_000)
    assert file.stat().st_size < 50_000
    with pytest.raises(RecipeError, match="unpacks to 20 MB"):
        read(file)


def test_a_bomb_that_states_less_than_it_is(tmp_path: Path) -> None:
    file = threemf(tmp_path / "a.3mf", model_xml(LEG).encode() + b" " * 5_000_000)
    content = file.read_bytes()
    with zipfile.ZipFile(file) as archive:
        size = archive.getinfo("3D/3dmodel.model").file_size
    file.write_bytes(content.replace(size.to_bytes(4, "little"), (1000).to_bytes(4, "little")))
    with pytest.raises(RecipeError):
        read(file)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"hello" * 100])
def test_what_is_no_archive(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.3mf").write_bytes(content)
    with pytest.raises(RecipeError, match=r"no 3MF file|is empty"):
        read(tmp_path / "a.3mf")


def test_damage_anywhere_is_told(tmp_path: Path) -> None:
    file = threemf(tmp_path / "a.3mf", model_xml(meshes()))
    content = file.read_bytes()
    for at in range(0, len(content), 61):
        file.write_bytes(content[:at] + bytes([content[at] ^ 255]) + content[at + 1 :])
        try:
            read(file)
        except RecipeError:
            continue


def test_an_archive_without_a_model(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
        archive.writestr("../../escape.txt", "x")
    with pytest.raises(RecipeError, match="without a 3D model"):
        read(tmp_path / "a.3mf")
    assert [file.name for file in tmp_path.iterdir()] == ["a.3mf"]


def test_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = threemf(tmp_path / "a.3mf", model_xml(meshes()))
    for name, most, says in (("MOST_TRIANGLES", 50, "triangles"), ("MOST_BODIES", 3, "bodies")):
        with monkeypatch.context() as patch:
            patch.setattr(limits, name, most)
            with pytest.raises(RecipeError, match=f"{most} {says}"):
                read(file)
