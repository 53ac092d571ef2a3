"""Where a recipe lies: a path of the user's, or one of those that foldfab ships."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

from foldfab.errors import Problem, RecipeError
from foldfab.recipe.problems import TOP, shown

_PACKAGE = Path(__file__).resolve().parents[1]
PLACES = (_PACKAGE / "_recipes", _PACKAGE.parent / "recipes")
"""Where shipped recipes lie: in an installed wheel, else in the repository."""


def find(text: str) -> Path:
    """The recipe file that `text` means: a path, with or without `.json`, or the name of a shipped recipe.

    Raises:
        RecipeError: there is none; the message names the closest shipped ones.
    """
    given = Path(text)
    ours = {path.stem: path for path in shipped()}
    for candidate in (given, Path(f"{text}.json")):
        if _is_there(candidate):
            return candidate
    if text.removesuffix(".json") in ours:
        return ours[text.removesuffix(".json")]
    if _is_folder(given):
        return given
    raise RecipeError(shown(text), (Problem(TOP, _advice(given.name.removesuffix(".json"), tuple(ours))),))


def shipped() -> tuple[Path, ...]:
    """The recipes that foldfab ships, sorted by name."""
    place = next((place for place in PLACES if place.is_dir()), None)
    return () if place is None else tuple(sorted(place.glob("*.json"), key=lambda path: path.stem))


def _advice(name: str, ours: tuple[str, ...]) -> str:
    close = get_close_matches(name, ours, n=3)
    hint = f"did you mean {' or '.join(close)}?" if close else f"foldfab ships {', '.join(ours) or 'none'}"
    return f"there is no such file and no shipped recipe of that name; {hint}"


def _is_there(path: Path) -> bool:
    try:
        return path.exists() and not path.is_dir()
    except (OSError, ValueError):
        return False


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False
