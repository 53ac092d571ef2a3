"""Names from other programs become names of parts: safe as files, unique, and as much like they were as can be."""

from __future__ import annotations

import re
import unicodedata

from foldfab.recipe.names import LONGEST, has_control_characters, part_name_problem, same_name

_FORBIDDEN = re.compile(r'[/\\:*?"<>|]+')
_NAMELESS = re.compile(r"(solid|compound|shell|shape|=>\[[\d:]*\])?", re.IGNORECASE)
"""What programs write where a body has no name."""
NAMELESS = "part"

NUMBER = 6
"""Room for what tells names apart, characters."""


def part_name(text: str) -> str:
    """A name that a part can have and that resembles `text`."""
    shown = "".join("-" if has_control_characters(letter) else letter for letter in unicodedata.normalize("NFC", text))
    name = _FORBIDDEN.sub("-", shown).strip().strip(".").strip()
    name = _shortened(name, 0).strip().strip(".").strip()
    if name.strip("-") == "":
        return NAMELESS
    return name if part_name_problem(name) is None else f"{_shortened(name, 2)}-1"


def is_nameless(text: str) -> bool:
    """Whether a name only says that there is none."""
    return bool(_NAMELESS.fullmatch(text.strip()))


def unique(names: list[str]) -> list[str]:
    """Each name safe, and with a number where an earlier one is the same to some file system."""
    taken = {same_name(part_name(name)) for name in names}
    used: set[str] = set()
    found = []
    numbers: dict[str, int] = {}
    for name in map(part_name, names):
        key = same_name(name)
        if key in used:
            number = numbers.get(key, 1)
            while True:
                number += 1
                fresh = f"{_shortened(name, NUMBER)}-{number}"
                if same_name(fresh) not in taken:
                    break
            numbers[key] = number
            name = fresh
            taken.add(same_name(name))
        used.add(same_name(name))
        found.append(name)
    return found


def _shortened(name: str, room: int) -> str:
    """The beginning of a name that leaves so much room in characters, and in bytes, for what is put behind it."""
    name = name[: LONGEST - room]
    while len(name.encode()) > 2 * LONGEST - room:
        name = name[:-1]
    return name
