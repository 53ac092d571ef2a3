"""A folder comes into its place whole, or not at all."""

from collections.abc import Callable
from pathlib import Path

import pytest

from foldfab.errors import PrintFolderError
from foldfab.export.swap import replace_folder


def _fill(text: str) -> Callable[[Path], None]:
    def fill(folder: Path) -> None:
        (folder / "sheet.json").write_text(text)

    return fill


@pytest.fixture
def old(tmp_path: Path) -> Path:
    """A print folder that stands already."""
    folder = tmp_path / "prints" / "bench"
    replace_folder(folder, _fill("old"))
    (folder / "extra.txt").write_text("mine")
    return folder


def _is_untouched(old: Path) -> bool:
    return (old / "sheet.json").read_text() == "old" and [p.name for p in old.parent.iterdir()] == ["bench"]


def test_an_old_print_is_replaced_whole(old: Path) -> None:
    assert replace_folder(old, _fill("new")) == old
    assert [path.name for path in old.iterdir()] == ["sheet.json"] and (old / "sheet.json").read_text() == "new"
    assert [path.name for path in old.parent.iterdir()] == ["bench"]


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError, MemoryError])
def test_an_interrupted_fill_leaves_the_old_print(old: Path, error: type[BaseException]) -> None:
    def fill(folder: Path) -> None:
        (folder / "sheet.json").write_text("half")
        raise error

    with pytest.raises(error):
        replace_folder(old, fill)
    assert _is_untouched(old)


@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError(28, "No space left on device")])
def test_an_interruption_between_the_renames_puts_the_old_print_back(
    old: Path, error: BaseException, monkeypatch: pytest.MonkeyPatch
) -> None:
    rename = Path.rename

    def failing(path: Path, target: Path) -> Path:
        if path.name == "new":
            raise error
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", failing)
    with pytest.raises((KeyboardInterrupt, PrintFolderError)):
        replace_folder(old, _fill("new"))
    assert _is_untouched(old)


def test_a_first_print_that_fails_leaves_nothing(tmp_path: Path) -> None:
    def fill(folder: Path) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(PrintFolderError, match="No space left"):
        replace_folder(tmp_path / "bench", fill)
    assert list(tmp_path.iterdir()) == []


def test_what_is_no_print_folder_is_left_alone(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (home / "thesis.txt").write_text("years")
    with pytest.raises(PrintFolderError, match="left alone"):
        replace_folder(home, _fill("new"))
    assert [path.name for path in home.iterdir()] == ["thesis.txt"]


def test_an_empty_folder_is_taken(tmp_path: Path) -> None:
    (tmp_path / "bench").mkdir()
    replace_folder(tmp_path / "bench", _fill("new"))
    assert (tmp_path / "bench" / "sheet.json").is_file()


@pytest.mark.parametrize("is_link", [False, True])
def test_a_file_is_refused(tmp_path: Path, is_link: bool) -> None:
    file = tmp_path / "file"
    file.write_text("text")
    target = file
    if is_link:
        target = tmp_path / "link"
        target.symlink_to(file)
    with pytest.raises(PrintFolderError, match="is a file"):
        replace_folder(target, _fill("new"))
    assert file.read_text() == "text"


def test_a_link_to_a_print_folder_stays_a_link(old: Path, tmp_path: Path) -> None:
    link = tmp_path / "link"
    link.symlink_to(old)
    replace_folder(link, _fill("new"))
    assert link.is_symlink() and (old / "sheet.json").read_text() == "new"


def test_a_parent_that_is_a_file_is_one_clear_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("text")
    with pytest.raises(PrintFolderError, match="cannot be written"):
        replace_folder(tmp_path / "file" / "bench", _fill("new"))
