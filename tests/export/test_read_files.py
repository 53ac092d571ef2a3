"""What foldfab reads back is what it wrote."""

from pathlib import Path

import numpy as np
import pytest

from foldfab.export.mesh_files import stl_bytes
from foldfab.export.read_files import read_stl
from foldfab.export.read_glb import read_glb
from foldfab.export.shell import sheet_shells
from foldfab.fabrication.model import Assembly
from foldfab.geometry.closed import is_closed


def test_an_stl_comes_back_as_it_was(assembly: Assembly, tmp_path: Path) -> None:
    shell = sheet_shells(assembly)[0]
    path = tmp_path / "part.stl"
    path.write_bytes(stl_bytes(shell))
    vertices, faces = read_stl(path)
    assert is_closed(faces) and np.array_equal(vertices[faces], shell.vertices[shell.faces])


@pytest.mark.parametrize("data", [b"", b"solid text", b"\0" * 83, b"\0" * 85, b"\0" * 80 + b"\xff\xff\xff\xff"])
def test_what_is_no_stl_is_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "part.stl"
    path.write_bytes(data)
    with pytest.raises(ValueError, match=r"part\.stl is cut off"):
        read_stl(path)


def test_a_glb_cut_by_one_byte_is_refused(written: Path) -> None:
    path = written / "stool.glb"
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(ValueError, match="cut off"):
        read_glb(path)
