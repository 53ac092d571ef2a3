"""References do not leave their folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from foldfab.errors import RecipeError
from foldfab.intake.inside import inside


def test_files_beside_and_further_in(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    for name in ("a.obj", "parts/b c.obj"):
        (tmp_path / name).touch()
        assert inside(tmp_path / "r.json", name, "model") == tmp_path / name
    assert inside(tmp_path / "r.json", "parts\\b c.obj", "model").name == "b c.obj"


@pytest.mark.parametrize(
    "reference",
    ["", "../a.obj", "parts/../../a.obj", "..\\a.obj", "/etc/passwd", "C:\\a.obj", "C:a.obj", "\\\\host\\a", "http://a/b",
     "file:///a", "a\0b", "NUL", "none.obj", "link.obj", "loop.obj", "x" * 5000],
)  # fmt: skip
def test_anything_else_is_refused(tmp_path: Path, reference: str) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (tmp_path / "a.obj").touch()
    (folder / "link.obj").symlink_to(tmp_path / "a.obj")
    (folder / "loop.obj").symlink_to(folder / "loop.obj")
    with pytest.raises(RecipeError) as caught:
        inside(folder / "r.json", reference, "model")
    assert caught.value.problems[0].place == "model"
