"""Files that files refer to lie in the same folder, or further inside, and nowhere else."""

from __future__ import annotations

from pathlib import Path, PureWindowsPath

from foldfab.intake.limits import fail
from foldfab.recipe.problems import shown


def inside(file: Path, reference: str, place: str) -> Path:
    """The file that `reference` in `file` means.

    Raises:
        RecipeError: it is absolute, leads upwards or out by a link, is no local path, or is not there.
    """
    windows = PureWindowsPath(reference)
    if not reference.strip() or "\0" in reference or "://" in reference:
        fail(file, f"should be a file in the same folder, not {shown(reference)}", place)
    if windows.drive or windows.root or ".." in windows.parts or windows.is_reserved():
        fail(file, f"leads out of the folder ({shown(reference)}); copy the file there and give its name", place)
    found = file.parent / Path(*windows.parts)
    try:
        if not found.resolve().is_relative_to(file.parent.resolve()):
            fail(file, f"leads out of the folder by a link ({shown(reference)}); copy the file there", place)
        if not found.exists():
            fail(file, f"there is no file {shown(reference)} beside it", place)
    except (OSError, ValueError, RuntimeError) as error:
        fail(file, f"{shown(reference)} cannot be reached ({error.__class__.__name__})", place)
    return found
