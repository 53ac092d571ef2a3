"""The print file is strict 3MF of one mesh, with its bodies named."""

import zipfile
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import lib3mf
import numpy as np
import pytest
from lib3mf import get_wrapper

from foldfab.export.bed import on_bed
from foldfab.export.read_files import CONFIG, read_threemf
from foldfab.export.slicer_settings import xml_attribute
from foldfab.export.threemf import threemf_bytes
from foldfab.fabrication.model import Assembly
from foldfab.geometry.closed import is_closed


@pytest.fixture
def path(assembly: Assembly, tmp_path: Path) -> Path:
    file = tmp_path / "stool.3mf"
    file.write_bytes(threemf_bytes("stool", on_bed(assembly)))
    return file


def test_strict_mode_has_nothing_to_say(path: Path) -> None:
    model = get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
    assert model.GetBuildItems().Count() == 1 and model.GetMeshObjects().Count() == 1
    groups = model.GetBaseMaterialGroups()
    groups.MoveNext()
    assert groups.GetCurrentBaseMaterialGroup().GetCount() == 3


def test_every_body_is_a_closed_range_of_its_own_name(path: Path, assembly: Assembly) -> None:
    found = read_threemf(path)
    assert found.is_sound
    assert [name for name, _, _ in found.volumes] == [body.name for body in assembly.bodies]
    owners = []
    for _, first, last in found.volumes:
        faces = found.faces[first : last + 1]
        assert is_closed(faces - faces.min())
        owners.append(set(np.unique(faces).tolist()))
    assert sum(len(owner) for owner in owners) == len(found.vertices)
    assert len(np.unique(found.vertices, axis=0)) == len(found.vertices)


def test_added_hinges_have_their_own_colour(path: Path) -> None:
    with zipfile.ZipFile(path) as archive:
        model = archive.read("3D/3dmodel.model").decode()
    assert {f'p1="{i}"' in model for i in range(3)} == {True}


def test_names_that_xml_would_choke_on(make: Callable[..., Assembly], tmp_path: Path) -> None:
    names = {"flap": 'a<b>&"c"', "top": "Bein 'links' ü"}
    assembly = make(rename=lambda name: names.get(name, name))
    file = tmp_path / "odd.3mf"
    file.write_bytes(threemf_bytes('<odd> & "even"', on_bed(assembly)))
    assert {name for name, _, _ in read_threemf(file).volumes} >= set(names.values())
    assert ElementTree.fromstring(f"<a b={xml_attribute(chr(1) + chr(10))}/>").get("b") == "\ufffd\n"


def test_the_archive_has_no_clock(path: Path) -> None:
    with zipfile.ZipFile(path) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert CONFIG in archive.namelist()
