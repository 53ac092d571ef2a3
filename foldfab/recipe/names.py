"""Names that are safe as folders and files on every system."""

from __future__ import annotations

import re
import unicodedata
from fnmatch import fnmatchcase

LONGEST = 100
"""Characters in a name."""

_FOLDER = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9._-]*")
_DEVICE = re.compile(r"(con|prn|aux|nul|com[0-9]|lpt[0-9])(\..*)?", re.IGNORECASE)
_NOT_IN_FILES = '/\\:*?"<>|'


def folder_name_problem(name: str) -> str | None:
    """Why `name` cannot be a folder, as the end of a sentence; None where it can."""
    if not name:
        return "is empty; give letters, digits, '.', '_' or '-'"
    if len(name) > LONGEST:
        return f"has {len(name)} characters; keep it to {LONGEST}"
    if not _FOLDER.fullmatch(name) or name.endswith("."):
        return (
            "becomes a folder's name: only letters, digits, '.', '_' and '-', with no dot at either end; "
            f"try {folder_name(name)!r}"
        )
    if _DEVICE.fullmatch(name):
        return f"is the name of a device on Windows; try {name + '-1'!r}"
    return None


def folder_name(text: str) -> str:
    """A safe folder name that resembles `text`."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    name = re.sub(r"[^A-Za-z0-9._-]+", "-", plain).strip(".-")[:LONGEST].rstrip(".")
    return name or "furniture"


def part_name_problem(name: str) -> str | None:
    """Why `name` cannot be a part's name, as the end of a sentence; None where it can."""
    if not name.strip():
        return "is empty; give the part a name such as 'seat'"
    if name != name.strip():
        return f"begins or ends with blanks; write {name.strip()[:LONGEST]!r}"
    if has_control_characters(name):
        return "holds control characters; use letters, digits and '-'"
    if len(name) > LONGEST or len(name.encode()) > 2 * LONGEST:
        return f"has {len(name)} characters; keep it to {LONGEST}"
    if any(character in _NOT_IN_FILES for character in name):
        return f"becomes a file's name, so it cannot hold any of {' '.join(_NOT_IN_FILES)}; use '-' instead"
    if name.startswith(".") or name.endswith("."):
        return "becomes a file's name, so it cannot begin or end with a dot"
    if _DEVICE.fullmatch(name):
        return f"is the name of a device on Windows; try {name + '-1'!r}"
    return None


def fits(name: str, pattern: str) -> bool:
    """Whether a part's name fits a pattern with * and ?, capitals and small letters being the same."""
    return fnmatchcase(name.casefold(), pattern.casefold().replace("[", "[[]"))


def has_control_characters(text: str) -> bool:
    """Whether `text` holds anything that cannot be shown, line breaks and lone surrogates included."""
    return any(unicodedata.category(character) in ("Cc", "Cf", "Cs", "Zl", "Zp") for character in text)


def same_name(name: str) -> str:
    """A key that is equal for names that some file system would take for the same."""
    return unicodedata.normalize("NFC", name.strip()).casefold()
