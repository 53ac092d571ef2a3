"""Bytes on disk become JSON data, with every repeated key remembered."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import NoReturn

from foldfab.errors import Problem, RecipeError
from foldfab.recipe.problems import TOP, Location, place, shown

LARGEST_FILE = 20_000_000
"""Bytes."""
_LONGEST_INTEGER = 18
"""Digits; what is longer is read as a float, for which overflow is infinity."""


class Document(dict[str, object]):
    """A JSON object that knows which of its keys stood in the file more than once."""

    repeated: tuple[str, ...] = ()


def load(path: Path) -> object:
    """The JSON data in a file.

    Raises:
        RecipeError: it cannot be read, is too large, or is not JSON in UTF-8.
    """
    return decode(_bytes(path), str(path))


def decode(content: bytes, source: str) -> object:
    """The JSON data in `content`; objects become `Document`s.

    Raises:
        RecipeError: it is not JSON in UTF-8.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        _fail(source, f"byte {error.start + 1}", "is not UTF-8; save the file as UTF-8 text")
    if not text.strip():
        _fail(source, TOP, 'the file is empty; a recipe is a JSON object with a list of "parts"')
    try:
        return json.loads(text, object_pairs_hook=_document, parse_int=_integer)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        _fail(source, where, f"is not JSON ({error.msg[0].lower()}{error.msg[1:]}); check commas, quotes and brackets")
    except RecursionError:
        _fail(source, TOP, "is nested too deeply; a recipe needs no more than six levels")


def repeated_keys(data: object) -> list[Problem]:
    """A problem for each key that stands in one object more than once."""
    problems: list[Problem] = []
    pending: list[tuple[Location, object]] = [((), data)]
    while pending:
        location, value = pending.pop()
        if isinstance(value, Document):
            places = (place((*location, key)) for key in value.repeated)
            problems += [Problem(where, "is given more than once; keep one") for where in places]
        pending += [((*location, step), inner) for step, inner in _children(value)]
    return problems


def _children(value: object) -> list[tuple[int | str, object]]:
    if isinstance(value, dict):
        return list(value.items())
    return list(enumerate(value)) if isinstance(value, list) else []


def _bytes(path: Path) -> bytes:
    try:
        if path.is_dir():
            _fail(str(path), TOP, "is a folder; give the recipe's .json file")
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        _fail(str(path), TOP, "there is no such file; `foldfab recipes` lists those that are shipped")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        _fail(shown(str(path)), TOP, f"cannot be read ({reason})")
    if len(content) > LARGEST_FILE:
        _fail(str(path), TOP, f"is larger than {LARGEST_FILE // 10**6} MB, which no recipe is")
    return content


def _document(pairs: list[tuple[str, object]]) -> Document:
    document = Document((_encodable(key), value) for key, value in pairs)
    if len(document) < len(pairs):
        counts = Counter(_encodable(key) for key, _ in pairs)
        document.repeated = tuple(sorted(key for key, count in counts.items() if count > 1))
    return document


def _encodable(key: str) -> str:
    """Without lone surrogates, over which pydantic would drop all its other findings."""
    return key.encode("utf-8", "replace").decode()


def _integer(text: str) -> int | float:
    return int(text) if len(text) <= _LONGEST_INTEGER else float(text)


def _fail(source: str, where: str, text: str) -> NoReturn:
    raise RecipeError(source, (Problem(where, text),))
