"""STL files and their names."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from foldfab.export.mesh_files import file_stems, stl_bytes
from foldfab.export.shell import sheet_shells
from foldfab.fabrication.model import Assembly


def test_stl_is_watertight_and_of_the_body_s_volume(assembly: Assembly, tmp_path: Path) -> None:
    for shell, body in zip(sheet_shells(assembly), assembly.bodies, strict=True):
        path = tmp_path / "part.stl"
        path.write_bytes(stl_bytes(shell))
        mesh = trimesh.load_mesh(path)
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(body.volume, rel=1e-4)
        assert np.allclose(mesh.bounds, [shell.vertices.min(axis=0), shell.vertices.max(axis=0)], atol=1e-4)


@pytest.mark.parametrize(
    ("names", "stems"),
    [
        (["seat/2"], ["seat-2"]),
        (["Seat", "seat"], ["Seat", "seat-2"]),
        (["a/b", "a-b", "a b"], ["a-b", "a-b-2", "a-b-3"]),
        (["../../etc"], ["etc"]),
        (["Rücken", "脚"], ["R-cken", "part"]),
        (["con"], ["part-con"]),
    ],
)
def test_file_names_are_safe_and_unique(names: list[str], stems: list[str]) -> None:
    found = file_stems(names)
    assert sorted(found) == sorted(names)
    assert sorted(found.values()) == sorted(stems)
    assert len({stem.lower() for stem in found.values()}) == len(names)
