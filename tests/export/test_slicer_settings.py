"""What slicers read beside the mesh, and that PrusaSlicer does."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from foldfab.export.bed import on_bed
from foldfab.export.slicer_settings import BAMBU, PRUSA, SETTINGS, bambu_config, prusa_config
from foldfab.export.threemf import OBJECT_ID, threemf_bytes
from foldfab.fabrication.model import Assembly
from foldfab.geometry.arrays import Array


def test_prusas_names_cover_the_mesh(assembly: Assembly) -> None:
    shells = on_bed(assembly)
    root = ElementTree.fromstring(prusa_config([(1, "stool", shells)]))
    (thing,) = root
    rows = {row.get("key"): row.get("value") for row in thing.findall("metadata")}
    assert rows == {"name": "stool", **SETTINGS}
    volumes = thing.findall("volume")
    assert [next(iter(volume)).get("value") for volume in volumes] == [shell.name for shell in shells]
    ends = [(int(volume.attrib["firstid"]), int(volume.attrib["lastid"])) for volume in volumes]
    assert ends[0][0] == 0 and ends[-1][1] == sum(len(shell.faces) for shell in shells) - 1
    assert all(end + 1 == start for (_, end), (start, _) in pairwise(ends))


def test_bambus_part_has_the_id_of_the_mesh() -> None:
    (thing,) = ElementTree.fromstring(bambu_config([(OBJECT_ID, '<odd> & "even"', ())]))
    part = thing.find("part")
    assert part is not None and part.attrib == {"id": str(OBJECT_ID), "subtype": "normal_part"}
    assert thing.get("id") == str(OBJECT_ID)
    names = [row.get("value") for row in thing.iter("metadata") if row.get("key") == "name"]
    assert names == ['<odd> & "even"'] * 2


def test_both_are_in_the_file(assembly: Assembly) -> None:
    import io

    with zipfile.ZipFile(io.BytesIO(threemf_bytes("stool", on_bed(assembly)))) as archive:
        assert {PRUSA, BAMBU} <= set(archive.namelist())


def test_names_places_and_settings_survive_prusaslicer(assembly: Assembly, tmp_path: Path) -> None:
    slicer = shutil.which("prusa-slicer")
    if slicer is None:
        pytest.skip("PrusaSlicer is not installed")
    file, copy = tmp_path / "stool.3mf", tmp_path / "copy.3mf"
    file.write_bytes(threemf_bytes("stool", on_bed(assembly)))
    command = [slicer, "--export-3mf", "--dont-arrange", "--output", str(copy), "--datadir", str(tmp_path / "data")]
    subprocess.run([*command, str(file)], check=True, capture_output=True)
    with zipfile.ZipFile(copy) as archive:
        config = ElementTree.fromstring(archive.read(PRUSA))
    told = {(row.get("type"), row.get("key"), row.get("value")) for row in config.iter("metadata")}
    assert {("volume", "name", body.name) for body in assembly.bodies} <= told
    assert {("object", key, value) for key, value in SETTINGS.items()} <= told
    before, after = (vertices(path) for path in (file, copy))
    assert len(after) == len(before)
    # One shift for all of them: nothing was dropped to the bed or moved by itself.
    assert np.ptp(after - before, axis=0).max() < 1e-3


def vertices(path: Path) -> Array:
    """(n, 3) of the mesh as it stands in the file."""
    with zipfile.ZipFile(path) as archive:
        model = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    found = [[float(v.attrib[axis]) for axis in "xyz"] for v in model.iter() if v.tag.endswith("}vertex")]
    return np.array(found)
