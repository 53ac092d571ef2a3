"""STEP files and build123d objects, and the process between."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("build123d", reason="needs build123d, and its system library libGL", exc_type=ImportError)

import build123d as b3d

from foldfab.errors import MissingLibraryError, RecipeError
from foldfab.intake import limits, step
from foldfab.intake.model import Body
from foldfab.intake.solids import read as read_solids

LEG = (10.0, 20.0, 300.0)


@pytest.fixture(scope="module")
def chair() -> b3d.Compound:
    """Two legs of one name in a side that stands elsewhere, a seat, and a solid without a name."""
    legs = [b3d.Solid.make_box(*LEG), b3d.Solid.make_box(*LEG).moved(b3d.Location((100, 0, 0), (0, 0, 90)))]
    for leg in legs:
        leg.label = "Leg. links"
    side = b3d.Compound(label="Seite", children=legs).moved(b3d.Location((0, 0, 500)))
    seat = b3d.Solid.make_box(100, 100, 10)
    seat.label = "Sitz/fläche"
    nameless = b3d.Solid.make_cylinder(50, 20)
    return b3d.Compound(label="chair", children=[side, seat, nameless])


@pytest.fixture(scope="module")
def file(chair: b3d.Compound, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path: Path = tmp_path_factory.mktemp("step") / "chair.step"
    b3d.export_step(chair, path)
    return path


def bounds(body: Body) -> list[Any]:
    return [np.round(body.mesh.vertices.min(0), 6).tolist(), np.round(body.mesh.vertices.max(0), 6).tolist()]


def assert_is_the_chair(bodies: tuple[Body, ...]) -> None:
    assert [body.name for body in bodies] == ["Leg. links", "Leg. links", "Sitz/fläche", "chair"]
    assert bounds(bodies[0]) == [[0, 0, 500], [10, 20, 800]]
    assert bounds(bodies[1]) == [[80, 0, 500], [100, 10, 800]]
    assert bounds(bodies[2]) == [[0, 0, 0], [100, 100, 10]]
    assert np.allclose(bounds(bodies[3]), [[-50, -50, 0], [50, 50, 20]], atol=limits.FARTHEST * 1e-9)


def test_a_step_file(file: Path) -> None:
    shapes = step.read(file)
    assert (shapes.up, shapes.millimetres) == ("z", 1.0)
    assert_is_the_chair(shapes.bodies)


def test_a_build123d_object(chair: b3d.Compound) -> None:
    assert_is_the_chair(read_solids(chair, "chair").bodies)


def test_triangles_face_outward(chair: b3d.Compound) -> None:
    for body in read_solids(chair, "chair").bodies:
        a, b, c = np.moveaxis(body.mesh.vertices[body.mesh.faces], 1, 0)
        assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0


def test_without_solids() -> None:
    with pytest.raises(RecipeError, match="holds no solids"):
        read_solids(b3d.Face.make_rect(1, 1), "face")
    with pytest.raises(RecipeError, match="holds no solids"):
        read_solids(b3d.Compound(), "nothing")


def test_limits(chair: b3d.Compound, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MOST_BODIES", 3)
    with pytest.raises(RecipeError, match="3 bodies"):
        read_solids(chair, "chair")


@pytest.mark.parametrize(
    "content",
    [b"", b"solid", b"ISO-10303-21;", b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"],
)
def test_what_is_no_step_file(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.step").write_bytes(content)
    with pytest.raises(RecipeError):
        step.read(tmp_path / "a.step")


@pytest.mark.parametrize("name", ["part_seat.stp", "../part_seat.stp", "/etc/passwd"])
def test_a_file_that_names_other_files_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """The kernel would read them, wherever they are."""
    folder = tmp_path / "in"
    folder.mkdir()
    monkeypatch.chdir(folder)
    write_in_several_files()
    if name.startswith(".."):
        Path("part_seat.stp").rename(name)
    text = Path("whole.step").read_text(encoding="latin-1")
    assert "part_seat.stp" in text
    Path("whole.step").write_text(text.replace("part_seat.stp", name), encoding="latin-1")
    with pytest.raises(RecipeError, match="refers to other files; export the furniture as one STEP file"):
        step.read(folder / "whole.step")


def write_in_several_files() -> None:
    """An assembly whose parts lie in STEP files of their own, as the kernel writes it, in this folder."""
    from OCP.Message import Message_ProgressRange
    from OCP.STEPCAFControl import STEPCAFControl_Reader, STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_AsIs
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document

    solids = [b3d.Solid.make_box(9, 9, 1), b3d.Solid.make_box(1, 2, 3)]
    solids[0].label, solids[1].label = "seat", "leg"
    b3d.export_step(b3d.Compound(label="stool", children=solids), "one.step")
    document = TDocStd_Document(TCollection_ExtendedString("XCAF"))
    reader, writer = STEPCAFControl_Reader(), STEPCAFControl_Writer()
    reader.SetNameMode(True)
    writer.SetNameMode(True)
    reader.ReadFile("one.step")
    reader.Transfer(document)
    writer.Transfer(document, STEPControl_AsIs, "part_", Message_ProgressRange())
    writer.Write("whole.step")


@pytest.mark.parametrize("share", [0.3, 0.6, 0.95])
def test_truncated_files(file: Path, tmp_path: Path, share: float) -> None:
    content = file.read_bytes()
    (tmp_path / "a.step").write_bytes(content[: int(share * len(content))])
    with pytest.raises(RecipeError) as caught:
        step.read(tmp_path / "a.step")
    assert len(caught.value.problems) == 1


def crashing(code: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The reading process runs this instead."""
    real = subprocess.run

    def run(command: list[str], **options: Any) -> Any:
        return real([sys.executable, "-c", code], **options)

    monkeypatch.setattr(subprocess, "run", run)


@pytest.mark.parametrize(
    "code", ["import os; os.abort()", "import os; os.kill(os.getpid(), 11)", "print('no arrays')", ""]
)
def test_a_crash_is_a_message(file: Path, monkeypatch: pytest.MonkeyPatch, code: str) -> None:
    crashing(code, monkeypatch)
    with pytest.raises(RecipeError, match="broke down over it"):
        step.read(file)


def test_a_reader_that_does_not_end_is_ended(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    crashing("import time; time.sleep(60)", monkeypatch)
    monkeypatch.setattr(step, "LONGEST_SECONDS", 0.3)
    with pytest.raises(RecipeError, match="takes longer"):
        step.read(file)


def test_a_kernel_that_is_not_there(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = "import sys; sys.modules['OCP'] = None; from foldfab.intake.step_process import main; main('a.step')"
    crashing(code, monkeypatch)
    with pytest.raises(MissingLibraryError, match="pip install build123d"):
        step.read(file)
