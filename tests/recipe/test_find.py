"""Paths and shipped recipes."""

from __future__ import annotations

from pathlib import Path

import pytest

from foldfab.errors import RecipeError
from foldfab.recipe import find as room
from foldfab.recipe.find import find, shipped


@pytest.fixture(autouse=True)
def house(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of shipped recipes, and an empty working folder."""
    ours = tmp_path / "ours"
    ours.mkdir()
    for name in ("bench", "table", "table-slanted"):
        (ours / f"{name}.json").write_text("{}")
    monkeypatch.setattr(room, "PLACES", (tmp_path / "none", ours))
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return ours


def test_shipped_are_sorted() -> None:
    assert [path.stem for path in shipped()] == ["bench", "table", "table-slanted"]


@pytest.mark.parametrize("text", ["bench", "bench.json"])
def test_a_shipped_recipe_by_name(text: str, house: Path) -> None:
    assert find(text) == house / "bench.json"


def test_the_users_own_file_comes_first() -> None:
    Path("bench.json").write_text("{}")
    assert find("bench.json") == find("bench") == Path("bench.json")


def test_a_folder_does_not_hide_a_shipped_recipe(house: Path) -> None:
    Path("bench").mkdir()
    assert find("bench") == house / "bench.json"


@pytest.mark.parametrize(
    ("text", "words"), [("bensh", "did you mean bench"), ("sofa", "foldfab ships"), ("a\0b", "no")]
)
def test_what_to_try(text: str, words: str) -> None:
    with pytest.raises(RecipeError, match=words):
        find(text)


def test_no_shipped_recipes_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "PLACES", ())
    with pytest.raises(RecipeError, match="none"):
        find("bench")
