"""Bytes that are not a recipe's JSON."""

from __future__ import annotations

from pathlib import Path

import pytest

from foldfab.errors import RecipeError
from foldfab.recipe.document import LARGEST_FILE, decode, load, repeated_keys


@pytest.mark.parametrize(
    ("content", "place", "words"),
    [
        (b"", "recipe", "empty"),
        (b" \n", "recipe", "empty"),
        (b"\xff\xfe{", "byte 1", "UTF-8"),
        (b'{"parts":\n [1,]}', "line 2", "not JSON"),
        (b"{'parts': []}", "line 1, column 2", "not JSON"),
        (b'{"parts": []', "line 1", "not JSON"),
        (b"[" * 200_000, "recipe", "deeply"),
    ],
)
def test_not_json(content: bytes, place: str, words: str) -> None:
    with pytest.raises(RecipeError) as caught:
        decode(content, "a.json")
    (problem,) = caught.value.problems
    assert problem.place.startswith(place)
    assert words in problem.text


def test_repeated_keys_have_their_place() -> None:
    data = decode(b'{"parts": [{"box": {"size": 1, "size": 2}}], "a": 1, "a": 2, "a": 3}', "a.json")
    assert {problem.place for problem in repeated_keys(data)} == {"a", "parts[0].box.size"}


def test_numbers_too_long_for_python() -> None:
    assert decode(b"[" + b"9" * 5000 + b"]", "a.json") == [float("inf")]


def test_a_byte_order_mark_is_let_through() -> None:
    assert decode("\ufeff[1]".encode(), "a.json") == [1]


def test_files_that_are_none(tmp_path: Path) -> None:
    big = tmp_path / "big.json"
    with big.open("wb") as file:
        file.truncate(LARGEST_FILE + 1)
    cases = {tmp_path: "folder", tmp_path / "none.json": "no such file", big: "20 MB", Path("a\0b"): "cannot be read"}
    for path, words in cases.items():
        with pytest.raises(RecipeError, match=words):
            load(path)
