"""PrusaSlicer is found, run, and not believed by its exit status."""

from collections.abc import Callable
from pathlib import Path

import pytest

from foldfab.errors import MissingLibraryError, SlicingError
from foldfab.recipe.model import Printer
from foldfab.slicing.profile import profile
from foldfab.slicing.program import VARIABLE, find_slicer, mesh_info, run, slice_print, warnings

MINI = Printer("mini", (180.0, 160.0, 150.0))
TABLE = (((30.0, 40.0, 0.0), (10.0, 20.0, 12.0)), ((30.0, 40.0, 12.0), (40.0, 20.0, 4.0)))
"""A post, and on it a plate that sticks out by 30 mm; their faces touch."""
POST = (((30.0, 40.0, 0.0), (10.0, 20.0, 12.0)),)
LAID = "min_x = 0\nmin_y = 0\nmin_z = 0\nmax_x = 1\nmax_y = 1\nmax_z = 1"


def test_a_slicer_that_is_absent_is_one_message(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv(VARIABLE, raising=False)
    with pytest.raises(MissingLibraryError, match=r"PrusaSlicer is not installed.*--slicer"):
        find_slicer()
    with pytest.raises(MissingLibraryError, match="nowhere/slicer is no program"):
        find_slicer("nowhere/slicer")


def test_the_variable_names_a_slicer_and_the_argument_outranks_it(
    monkeypatch: pytest.MonkeyPatch, program: Callable[[str], str]
) -> None:
    path = program("true")
    monkeypatch.setenv(VARIABLE, path)
    assert find_slicer() == path
    with pytest.raises(MissingLibraryError, match="another"):
        find_slicer("another")


def test_a_silent_failure_is_an_error(program: Callable[[str], str], tmp_path: Path) -> None:
    slicer = program(f'case "$1" in --info) echo "{LAID}";; *) echo "Objects could not fit"; exit 0;; esac')
    with pytest.raises(SlicingError, match="no G-code: Objects could not fit"):
        slice_print(tmp_path / "a.stl", MINI, support=False, slicer=slicer)


def test_an_unreadable_file_is_an_error(program: Callable[[str], str], tmp_path: Path) -> None:
    with pytest.raises(SlicingError, match="cannot read it: Unknown file format"):
        mesh_info(tmp_path / "a.stl", program("echo Unknown file format"))


def test_progress_is_no_warning_and_all_else_is_one() -> None:
    log = """[2026-01-01 00:00:00.5] [0x7f] [trace]   Initializing
10 => Processing triangulated mesh
print warning: Empty layer between 0.2 and 4.
Slicing result exported to x.gcode

print warning: Detected print stability issues:

thing
Loose extrusions

Consider enabling supports.
"""
    assert warnings(log) == ("print warning: Empty layer between 0.2 and 4.",)


def test_the_profile_is_for_the_printer() -> None:
    text = profile(MINI, support=True)
    assert "bed_shape = 0x0,180x0,180x160,0x160\n" in text
    assert "max_print_height = 150\n" in text and "support_material = 1\n" in text
    assert "support_material = 0\n" in profile(MINI, support=False)


def test_a_print_is_measured_where_it_lies(prusa: str, box_stl: Callable[..., Path]) -> None:
    file = box_stl(POST)
    sliced = run(file, MINI, support=False, slicer=prusa)
    report = sliced.report
    assert (report.layers, report.height_mm) == (60, 12.0)
    assert report.is_manifold and report.bodies == 1 and report.repairs == () and report.warnings == ()
    assert 60 < report.seconds < 3600 and report.support_g == 0
    assert report.filament_g == pytest.approx(1.24 * report.filament_cm3, rel=0.01)
    assert 0.5 < report.filament_cm3 < 10 * 20 * 12 / 1000
    from foldfab.slicing import gcode

    outline = list(gcode.layers(sliced.gcode))[30].outlines[0]
    # The line's middle lies about half its width inside.
    assert outline.min(axis=0) == pytest.approx([30.2, 40.2], abs=0.05)
    assert outline.max(axis=0) == pytest.approx([39.8, 59.8], abs=0.05)


def test_what_sticks_out_asks_for_support(prusa: str, box_stl: Callable[..., Path]) -> None:
    file = box_stl(TABLE)
    bare, held = (slice_print(file, MINI, support=wanted, slicer=prusa) for wanted in (False, True))
    assert bare.support_g == 0 and held.support_g > 0.3
    assert held.filament_g == pytest.approx(bare.filament_g + held.support_g, rel=0.1)
    assert held.seconds > bare.seconds
    assert slice_print(box_stl(POST), MINI, support=True, slicer=prusa).support_g == 0


def test_what_would_be_mended_is_told(prusa: str, box_stl: Callable[..., Path]) -> None:
    # A single missing triangle is put in without a word but this.
    assert slice_print(box_stl(POST, drop=1), MINI, support=False, slicer=prusa).repairs
    holed = mesh_info(box_stl(POST, drop=6), prusa)
    assert not holed.is_manifold and dict(holed.repairs)["open_edges"] > 0
    turned = slice_print(box_stl(POST, flip=True), MINI, support=False, slicer=prusa)
    assert dict(turned.repairs)["facets_reversed"] == 12


def test_a_print_that_is_dropped_to_the_bed_is_told(prusa: str, box_stl: Callable[..., Path]) -> None:
    raised = (((30.1, 40.1, 3.0), (10.0, 20.0, 5.0)),)
    (warning,) = slice_print(box_stl(raised), MINI, support=False, slicer=prusa).warnings
    assert warning == "sliced up to 5.00 mm, but the print reaches 8.00 mm: it was moved"


def test_a_print_in_the_air_is_warned_of(prusa: str, box_stl: Callable[..., Path]) -> None:
    stacked = (((0.1, 0.1, 0.0), (9.1, 9.1, 2.1)), ((0.1, 0.1, 5.1), (9.1, 9.1, 2.1)))
    assert any("Empty layer" in text for text in slice_print(box_stl(stacked), MINI, support=False).warnings)
