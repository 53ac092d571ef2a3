"""The whole print folder."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from foldfab.errors import FabricationError, PrintFolderError
from foldfab.export.check import inspect_folder
from foldfab.export.write import contents, write
from foldfab.fabrication.model import Assembly
from foldfab.geometry.arrays import Array
from foldfab.pipeline import printable

NAMES = {"stool.3mf", "stool.glb", "sheet.json", "recipe.json", "preview.png"} | {
    "printability.json",
    "printability.txt",
}
STLS = {f"stl/{name}.stl" for name in ("flap", "floor", "leg-1", "leg-2", "top")}


def test_every_file_is_written_and_named(assembly: Assembly, tmp_path: Path) -> None:
    folder = tmp_path / "prints" / "stool"
    files = write(assembly, folder)
    assert {path.relative_to(folder).as_posix() for path in files} == NAMES | STLS
    assert {path for path in folder.rglob("*") if path.is_file()} == set(files)
    assert json.loads((folder / "recipe.json").read_text())["name"] == "stool"


def test_the_same_assembly_gives_the_same_bytes(make: Callable[..., Assembly]) -> None:
    assert contents(make()) == contents(make())


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.1])
@pytest.mark.parametrize("posture", ["open", "folded"])
def test_what_is_written_passes_whatever_the_frame(
    make: Callable[..., Assembly], tmp_path: Path, angle: float, posture: str
) -> None:
    write(make(rotation=_rotation(angle), posture=posture), tmp_path / "stool")
    report = inspect_folder(tmp_path / "stool")
    assert report.ok, [row for row in report.rows if not row.ok]


def test_an_interrupted_write_leaves_the_old_print(
    written: Path, make: Callable[..., Assembly], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = {path: path.read_bytes() for path in written.rglob("*") if path.is_file()}
    write_bytes, left = Path.write_bytes, [4]

    def interrupted(path: Path, data: bytes) -> int:
        left[0] -= 1
        if left[0] < 0:
            raise KeyboardInterrupt
        return write_bytes(path, data)

    monkeypatch.setattr(Path, "write_bytes", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write(make(posture="folded"), written)
    assert {path: path.read_bytes() for path in written.rglob("*") if path.is_file()} == before
    assert list(written.parent.iterdir()) == [written]


def test_a_print_that_slicers_would_stumble_over_is_not_written(assembly: Assembly, tmp_path: Path) -> None:
    flap = assembly.bodies[0]
    holed = replace(flap, faces=flap.faces[2:], hinge_faces=np.array([], dtype=np.int64))
    with pytest.raises(FabricationError, match=r"would not print:\n  open edges: 4, in flap"):
        write(replace(assembly, bodies=(holed, *assembly.bodies[1:])), tmp_path / "stool")
    assert list(tmp_path.iterdir()) == []


def test_the_table_is_that_of_the_json(original: Path) -> None:
    kinds = json.loads((original / "printability.json").read_text())["kinds"]
    text = (original / "printability.txt").read_text()
    assert all(f"{kind['name']:<18}{kind['count']:>7.0f}" in text for kind in kinds)
    assert printable(original) == text.rstrip()


def test_a_foreign_folder_is_refused(assembly: Assembly, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(PrintFolderError):
        write(assembly, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def _rotation(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    turn: Array = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.array(
        [[1.0, 0, 0], [0, c, -s], [0, s, c]]
    )
    return turn
