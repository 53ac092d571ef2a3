"""The same solids give the same STEP file, byte for byte.

Two things in a file of the CAD kernel change from run to run: it counts the uses of parts on from the last file of its
process, and it writes colours in the order of addresses in memory. Here uses are counted from 1, and the records of
colours, which stand last in a file, follow the parts that they colour.
"""

from __future__ import annotations

import re
from contextlib import suppress

STYLES = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"
"""The record that opens the colours of one part; its last reference is the part's."""
USE = re.compile(r"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\()\s*'[^']*'(.*?;\n)", re.DOTALL)
RECORD = re.compile(r"#(\d+) = (.*?);\n", re.DOTALL)
OTHER_LETTERS = re.compile(r"[^\x00-\x7f]+")
REFERENCE = re.compile(r"#(\d+)")


def canonical(data: bytes) -> bytes:
    """The STEP file with its uses numbered and its colours ordered by the parts that they are of, in O(n)."""
    text = OTHER_LETTERS.sub(_escaped, data.decode("utf-8").replace("\r\n", "\n"))
    count = iter(range(1, len(text)))
    text = USE.sub(lambda found: f"{found[1]}'{next(count)}'{_unwrapped(found[2])}\n", text)
    start = re.search(rf"^#(\d+) = {STYLES}\(", text, re.MULTILINE)
    if start is None:
        return text.encode("ascii")
    end = text.index("ENDSEC;", start.start())
    records = {int(key): _unwrapped(body) for key, body in RECORD.findall(text[start.start() : end])}
    return (text[: start.start()] + _ordered(records, int(start[1])) + text[end:]).encode("ascii")


def _escaped(found: re.Match[str]) -> str:
    """Letters beyond ASCII as ISO 10303-21 writes them; not every reader takes them as they are."""
    letters = found[0]
    # build123d 0.13 hands the bytes of a label to the kernel as if each were a letter.
    with suppress(UnicodeError):
        letters = letters.encode("latin-1").decode("utf-8")
    if max(letters) > "\uffff":
        return f"\\X4\\{letters.encode('utf-32-be').hex().upper()}\\X0\\"
    return f"\\X2\\{letters.encode('utf-16-be').hex().upper()}\\X0\\"


def _ordered(records: dict[int, str], first: int) -> str:
    """The records, numbered from `first`: those of a part behind each other, parts by their own number."""
    heads = [key for key, body in records.items() if body.startswith(STYLES)]
    heads.sort(key=lambda key: _references(records[key])[-1])
    numbers: dict[int, int] = {}
    left = heads[::-1]
    while left:
        key = left.pop()
        if key in records and key not in numbers:
            numbers[key] = first + len(numbers)
            left += _references(records[key])[::-1]
    renamed = (
        f"#{new} = {REFERENCE.sub(lambda found: f'#{numbers.get(int(found[1]), int(found[1]))}', records[old])};\n"
        for old, new in numbers.items()
    )
    return "".join(renamed)


def _references(body: str) -> list[int]:
    return [int(key) for key in REFERENCE.findall(body)]


def _unwrapped(body: str) -> str:
    # Where a long record is broken into lines depends on how many digits its numbers have.
    return "".join(line.strip() for line in body.split("\n"))
