"""A folder comes into its place whole, or not at all."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from foldfab.errors import PrintFolderError

MARK = "sheet.json"
"""What a folder must hold to be taken for a print folder, which may be replaced."""


def replace_folder(target: Path, fill: Callable[[Path], None], mark: str = MARK) -> Path:
    """`fill` an empty folder beside `target` and move it there; returns where it then stands.

    Whatever stops it, an interruption included, leaves the old folder as it was and nothing beside it. What is replaced
    holds a file `mark`, or nothing.

    Raises:
        PrintFolderError: the target holds something else, or the disk refuses.
    """
    try:
        place = target.resolve()
        _refuse_foreign(place, target, mark)
        place.parent.mkdir(parents=True, exist_ok=True)
        workshop = Path(tempfile.mkdtemp(prefix=f".{place.name}.", dir=place.parent))
        try:
            fresh = workshop / "new"
            fresh.mkdir()
            fill(fresh)
            _swap(fresh, place, aside=workshop / "old")
        finally:
            shutil.rmtree(workshop, ignore_errors=True)
    except (OSError, RuntimeError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise PrintFolderError(f"{target}: cannot be written ({reason}); choose another folder with -o") from error
    return place


def _refuse_foreign(place: Path, target: Path, mark: str) -> None:
    if place.exists() and not place.is_dir():
        raise PrintFolderError(f"{target}: is a file, where a print folder should go; move it or choose another folder")
    if place.is_dir() and any(place.iterdir()) and not (place / mark).is_file():
        raise PrintFolderError(
            f"{target}: holds files but no {mark}, so it is no folder of ours and is left alone; "
            "empty it or choose another folder"
        )
    if place.name == "":
        raise PrintFolderError(f"{target}: is the root of the disk; choose a folder")


def _swap(fresh: Path, place: Path, *, aside: Path) -> None:
    try:
        if place.exists():
            place.rename(aside)
        fresh.rename(place)
    except BaseException:
        # An interruption counts too: the old print must not go down with the workshop.
        if aside.exists() and not place.exists():
            aside.rename(place)
        raise
