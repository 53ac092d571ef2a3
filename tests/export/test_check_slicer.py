"""Checks by PrusaSlicer, and by programs that lie in its place."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from foldfab import cli
from foldfab.export.bed import on_bed
from foldfab.export.check import inspect_folder
from foldfab.export.check_slicer import told
from foldfab.export.report import Row
from foldfab.export.shell import Shell
from foldfab.export.threemf import threemf_bytes
from foldfab.export.write import write
from foldfab.fabrication import solids
from foldfab.fabrication.model import Assembly
from foldfab.pipeline import check

CODES = ("slicer", "repairs", "support", "apart")


@pytest.fixture(scope="session")
def prusa() -> str:
    found = shutil.which("prusa-slicer")
    if found is None:
        pytest.skip("PrusaSlicer is not installed")
    return found


def rows(folder: Path, slicer: str) -> dict[str, Row]:
    return {row.code: row for row in inspect_folder(folder, slicer).rows if row.code in CODES}


def rewrite(folder: Path, assembly: Assembly, change: Callable[[Shell], Shell]) -> None:
    shells = tuple(change(shell) for shell in on_bed(assembly))
    (folder / "stool.3mf").write_bytes(threemf_bytes("stool", shells))


def moved(shell: Shell, name: str, by: tuple[float, float, float]) -> Shell:
    if shell.name != name:
        return shell
    return Shell(shell.name, shell.kind, shell.vertices + np.array(by), shell.faces, shell.is_hinge)


def test_a_good_print_passes(original: Path, prusa: str) -> None:
    found = rows(original, prusa)
    assert tuple(found) == CODES and all(row.ok for row in found.values()), found
    facts = found["slicer"].facts
    assert facts["layers"] == pytest.approx(facts["height_mm"] / 0.2) and facts["filament_g"] > 5
    # The top lies on the leg alone, so most of it hangs over.
    assert found["support"].facts["needed"] and found["support"].facts["support_g"] > 1
    assert found["apart"].facts["outlines"] == found["apart"].facts["bodies"] > 100
    assert found["apart"].facts["hinges"] == 4


def test_loose_parts_are_sliced_plate_by_plate(make: Callable[..., Assembly], tmp_path: Path, prusa: str) -> None:
    loose = make(posture="plate")
    write(loose, tmp_path / "stool")
    found = rows(tmp_path / "stool", prusa)
    assert tuple(found) == CODES and all(row.ok for row in found.values()), found
    assert found["slicer"].facts["bodies"] == len(loose.bodies)
    assert found["apart"].text == "no hinge is printed in place"


def test_knuckles_that_nearly_touch_are_found_fused(written: Path, assembly: Assembly, prusa: str) -> None:
    # Knuckles interleave along y with a gap of 0.3 mm: 0.25 of it are taken away on one side.
    rewrite(written, assembly, lambda shell: moved(shell, "flap", (0, 0.25, 0)))
    found = rows(written, prusa)
    assert not found["apart"].ok and "flap and floor share an outline" in found["apart"].text
    assert found["repairs"].ok and found["slicer"].ok, "the slicer itself has nothing to say about it"


def test_bodies_that_rest_on_each_other_are_found(written: Path, assembly: Assembly, prusa: str) -> None:
    rewrite(written, assembly, lambda shell: moved(shell, "flap", (0, 0, -0.25)))
    assert "laid onto each other" in rows(written, prusa)["apart"].text


def test_a_hole_is_found_that_slicing_would_mend(written: Path, assembly: Assembly, prusa: str) -> None:
    def holed(shell: Shell) -> Shell:
        if shell.name != "top":
            return shell
        return Shell(shell.name, shell.kind, shell.vertices, shell.faces[3:], shell.is_hinge[3:])

    rewrite(written, assembly, holed)
    assert not rows(written, prusa)["repairs"].ok


def test_a_body_that_is_not_its_stl_is_found(written: Path, assembly: Assembly, prusa: str) -> None:
    def stretched(shell: Shell) -> Shell:
        factors = np.array([1, 1.01, 1]) if shell.name == "flap" else np.ones(3)
        return Shell(shell.name, shell.kind, shell.vertices * factors, shell.faces, shell.is_hinge)

    rewrite(written, assembly, stretched)
    assert "not the STL's bodies moved rigidly: flap" in rows(written, prusa)["apart"].text


@pytest.fixture(scope="module")
def propped(make: Callable[..., Assembly]) -> Assembly:
    """Printed folded, with a block at the flap that is to be broken off."""
    made = make(posture="folded")
    flap = next(body for body in made.bodies if body.name == "flap")
    (x0, y0, _), (x1, y1, high) = flap.vertices.min(axis=0), flap.vertices.max(axis=0)
    block = solids.box(((x0 + x1) / 2 - 1, y0 + 5, high - 0.5), ((x0 + x1) / 2 + 1, y1 - 5, high + 4))
    vertices, faces = solids.mesh(solids.union([solids.from_mesh(flap.vertices, flap.faces), block]))
    with_block = replace(flap, vertices=vertices, faces=faces, hinge_faces=np.zeros(0, np.int64))
    return replace(made, propped=(with_block,))


def test_a_part_with_a_prop_is_found_where_its_hinges_take_it(propped: Assembly, tmp_path: Path, prusa: str) -> None:
    write(propped, tmp_path / "stool")
    row = rows(tmp_path / "stool", prusa)["apart"]
    assert row.ok and row.facts["hinges"] == 4, row.text
    rewrite(tmp_path / "stool", propped, lambda shell: moved(shell, "flap", (0.05, 0, 0)))
    assert "not the STL's bodies moved rigidly: flap" in rows(tmp_path / "stool", prusa)["apart"].text


def test_a_slicer_that_makes_nothing_fails_the_check(written: Path, tmp_path: Path) -> None:
    program = tmp_path / "slicer"
    program.write_text("#!/bin/sh\necho min_x = 0; echo nothing more; exit 0\n")
    program.chmod(0o755)
    (row,) = rows(written, str(program)).values()
    assert not row.ok and "PrusaSlicer cannot read it: " in row.text


def test_without_a_slicer_there_is_one_message_and_status_2(
    original: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("PRUSA_SLICER", raising=False)
    assert cli.main(["check", str(original), "--slicer"]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.startswith("foldfab: PrusaSlicer is not installed") and err.count("\n") == 1
    assert cli.main(["check", str(original), "--slicer=/no/such"]) == 2
    assert "/no/such is no program" in capsys.readouterr().err
    assert check(original).ok


def test_figures_are_in_the_json(original: Path, prusa: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["check", str(original), f"--slicer={prusa}", "--json"]) == 0
    checks = {row["code"]: row for row in json.loads(capsys.readouterr().out)["checks"]}
    assert checks["slicer"]["seconds"] > 0 and checks["slicer"]["repairs"] == [] and "support_g" in checks["support"]


def test_times_are_told_in_hours_and_minutes() -> None:
    assert [told(seconds) for seconds in (50, 3540, 3600, 53110)] == ["1 min", "59 min", "1 h 0 min", "14 h 45 min"]
