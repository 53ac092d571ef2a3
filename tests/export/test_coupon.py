"""The coupon's folder: strict 3MF, an STL a body, its sheet; and what does not fit."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from foldfab.cli import main
from foldfab.errors import PrintFolderError
from foldfab.export.coupon import write_coupon
from foldfab.export.read_files import read_threemf
from foldfab.fabrication.coupon import coupon
from foldfab.recipe.model import Printer


def test_the_folder_of_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["coupon", "--printer", "prusa-mini", "--posture", "folded", "-o", str(tmp_path)]) == 0
    folder = tmp_path / "coupon"
    sheet = json.loads((folder / "sheet.json").read_text())
    found = read_threemf(folder / "coupon.3mf")
    assert found.is_sound
    assert found.warnings == 0
    assert sorted(name for name, _, _ in found.volumes) == sorted(sheet["bodies"])
    assert len(list((folder / "stl").iterdir())) == len(sheet["bodies"]) == len(sheet["clearances_mm"]) + 1
    assert "foldfab calibrate --printer prusa-mini NUMBER" in capsys.readouterr().out
    before = {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}
    assert main(["coupon", "--printer", "prusa-mini", "--posture", "folded", "-o", str(tmp_path)]) == 0
    assert before == {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def test_a_printer_that_is_too_small(tmp_path: Path) -> None:
    with pytest.raises(PrintFolderError, match="does not fit the tiny"):
        write_coupon(coupon(4.0, "open"), Printer("tiny", (100.0, 60.0, 60.0)), tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("option", "value"), [("--printer", "x"), ("--thickness", "1"), ("--posture", "plate-ish")])
def test_bad_options(option: str, value: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = ["coupon", "--printer", "prusa-mk4", "-o", str(tmp_path), option, value]
    assert main(line) == 2
    assert option in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
