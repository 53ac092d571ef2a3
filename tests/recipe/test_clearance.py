"""The clearance where nobody gives one: by profile, by calibration, and what happens to a broken file."""

from __future__ import annotations

import pytest

from foldfab.cli import main
from foldfab.errors import RecipeError
from foldfab.pipeline import load
from foldfab.recipe.clearance import calibrate, calibration_file, calibrations, profile


def test_the_profile() -> None:
    assert [profile(nozzle, 0.2, "pla") for nozzle in (0.25, 0.4, 0.6)] == [0.2, 0.3, 0.4]
    assert profile(0.4, 0.3, "pla") == 0.4
    assert profile(0.4, 0.2, "petg") == pytest.approx(0.35)


def test_a_calibration_is_used_where_the_recipe_gives_none() -> None:
    assert (load("bench").print.clearance, load("bench").print.clearance_from) == (0.3, "profile")
    calibrate("prusa-mk4", 0.25)
    calibrate("ender-3", 0.4)
    assert (load("bench").print.clearance, load("bench").print.clearance_from) == (0.25, "calibration")
    assert load("bench", printer="ender-3").print.clearance == 0.4
    assert load("bench", printer="bambu-a1").print.clearance == 0.3
    own = load("bench", clearance="0.35").print
    assert (own.clearance, own.clearance_from) == (0.35, "command line")
    assert load("bench", clearance="auto").print.clearance_from == "calibration"
    assert load("bench", nozzle="0.6", printer="bambu-a1").print.clearance == 0.4


@pytest.mark.parametrize("text", ["", "[]", '{"printers": {"a": 3}}', '{"printers": {"a": {"clearance": 7}}}', "\xff"])
def test_a_broken_file_is_named_and_left_alone(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    file = calibration_file()
    file.parent.mkdir(parents=True)
    file.write_bytes(text.encode("latin-1"))
    with pytest.raises(RecipeError, match=r"printers\.json"):
        load("bench")
    assert main(["calibrate", "--printer", "prusa-mk4", "0.2"]) == 2
    assert file.read_bytes() == text.encode("latin-1")
    assert "calibrate again" in capsys.readouterr().err


def test_the_command_keeps_others_and_refuses_nonsense(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["calibrate", "--printer", "prusa-mk4", "0.25"]) == 0
    assert main(["calibrate", "--printer", "200x200x180", "0.2"]) == 0
    assert calibrations() == {"prusa-mk4": 0.25, "200x200x180": 0.2}
    assert main(["calibrate", "--printer", "prusa-mk4", "0.05"]) == 2
    assert main(["calibrate", "--printer", "nobody", "0.2"]) == 2
    assert calibrations()["prusa-mk4"] == 0.25
    assert [file.name for file in calibration_file().parent.iterdir()] == ["printers.json"]
    assert "0.15 to 1" in capsys.readouterr().err
