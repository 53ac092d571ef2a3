"""The ranked table of directions, its data and its folder."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from foldfab import cli, survey
from foldfab.directions import Row, ranked
from foldfab.errors import PrintFolderError
from foldfab.recipe.model import Part, Recipe
from foldfab.recipe.write import as_text

PNG = b"\x89PNG"


@pytest.fixture(scope="module")
def table_rows(recipe: Callable[..., Recipe]) -> tuple[Row, ...]:
    """A table: along z and along x it folds, along y nothing does."""
    return ranked(replace(recipe("table"), direction=None))


@pytest.fixture(scope="module")
def stuck_rows(recipe: Callable[..., Recipe], box: Callable[..., Part]) -> tuple[Row, ...]:
    """A lump that does not fold."""
    return ranked(replace(recipe((box("lump", (0, 0, 0), (60, 60, 60)),)), direction=None))


def test_the_table(table_rows: tuple[Row, ...]) -> None:
    text = survey.table(table_rows, "table")
    lines = text.splitlines()
    assert lines[0] == "table folds best along -z; 6 directions were tried"
    assert lines[2].split()[:5] == ["rank", "direction", "score", "saves", "cost"]
    assert lines[3].split()[:2] == ["1", "-z"]
    assert "score = space saving - cost - 0.01 a hinge - share of the furniture lost" in lines
    assert text.partition("Nothing folds along\n")[2].startswith("  -y  ")


def test_where_nothing_folds(stuck_rows: tuple[Row, ...]) -> None:
    text = survey.table(stuck_rows, "lump")
    assert text.startswith("lump folds along no direction; 6 directions were tried\n\nNothing folds along\n  -")
    facts = survey.facts(stuck_rows, "lump")
    assert facts["status"] == "refused"
    assert all(row["rank"] is None and row["picture"] is None and row["reason"] for row in facts["directions"])


def test_the_facts(table_rows: tuple[Row, ...]) -> None:
    facts = json.loads(json.dumps(survey.facts(table_rows, "table"), allow_nan=False))
    first, second, *_ = facts["directions"]
    assert (facts["status"], facts["tried"], first["rank"], first["direction"]) == ("folded", 6, 1, [0, 0, -1])
    assert first["score"] >= second["score"] and second["against_first"]
    assert first["opposite"]["direction"] == [0, 0, 1]
    told = first["space_saving"] - first["cost"] - 0.01 * first["hinges"] - first["lost"]
    assert first["score"] == pytest.approx(told, abs=0.00501)


def test_a_picture_of_each_fold_and_the_facts(tmp_path: Path, table_rows: tuple[Row, ...]) -> None:
    folder = survey.write(table_rows, "table", tmp_path / "table")
    facts = json.loads((folder / "directions.json").read_text(encoding="utf-8"))
    pictures = [row["picture"] for row in facts["directions"] if row["picture"]]
    assert sorted([*pictures, "directions.json"]) == sorted(file.name for file in folder.iterdir())
    assert len(pictures) == sum(row.best.solution is not None for row in table_rows)
    assert all((folder / name).read_bytes().startswith(PNG) for name in pictures)
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    survey.write(table_rows, "table", tmp_path / "table")
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path, table_rows: tuple[Row, ...]) -> None:
    (tmp_path / "table").mkdir()
    (tmp_path / "table" / "sheet.json").write_text("{}", encoding="utf-8")
    with pytest.raises(PrintFolderError, match=r"no directions\.json"):
        survey.write(table_rows, "table", tmp_path / "table")
    assert [file.name for file in tmp_path.rglob("*")] == ["table", "sheet.json"]


def test_the_command(tmp_path: Path, recipe: Callable[..., Recipe], capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "table.json"
    file.write_text(as_text(replace(recipe("table"), direction=None, name="table")), encoding="utf-8")
    assert cli.main(["directions", str(file), "-o", str(tmp_path / "out")]) == 0
    out = capsys.readouterr().out
    assert out.startswith("table folds best along -z") and "direction-RANK.png" in out
    assert (tmp_path / "out" / "table" / "direction-1.png").is_file()
    assert cli.main(["directions", str(file), "-o", str(tmp_path / "out"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(
        (tmp_path / "out" / "table" / "directions.json").read_text(encoding="utf-8")
    )


def test_the_command_where_nothing_folds(
    tmp_path: Path, recipe: Callable[..., Recipe], box: Callable[..., Part], capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "lump.json"
    lump = recipe((box("lump", (0, 0, 0), (60, 60, 60)),))
    file.write_text(as_text(replace(lump, direction=None, name="lump")), encoding="utf-8")
    assert cli.main(["directions", str(file), "-o", str(tmp_path / "out")]) == 1
    assert "lump folds along no direction" in capsys.readouterr().out
    assert not (tmp_path / "out").exists()
