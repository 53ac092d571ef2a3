"""XML as files of furniture have it: read in pieces, without document types, entities or depth."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn, Protocol
from xml.parsers.expat import ExpatError, ParserCreate

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.intake.limits import FARTHEST, LARGEST_DESCRIPTION, check_nodes, content, fail
from foldfab.recipe.problems import shown

_PIECE = 1 << 16
"""Bytes given to the parser at once."""

Attributes = dict[str, str]


class Stream(Protocol):
    """Anything that bytes are read from."""

    def read(self, count: int) -> bytes:
        """At most `count` bytes more; none at the end."""


@dataclass(frozen=True, slots=True, eq=False)
class Element:
    """One element of a small XML file, with all that stands in it but text."""

    tag: str
    given: Attributes
    children: list[Element] = field(default_factory=list)

    def all(self, *tags: str) -> list[Element]:
        """Its children of these tags, in the order of the file."""
        return [child for child in self.children if child.tag in tags]

    def first(self, tag: str) -> Element | None:
        """Its first child of that tag."""
        return next((child for child in self.children if child.tag == tag), None)

    @property
    def place(self) -> str:
        """Where it stands, for messages."""
        name = self.given.get("name")
        return f"{self.tag} {shown(name)}" if name else self.tag


def tree(path: Path, *, kind: str, deepest: int) -> Element:
    """The root of a small XML file.

    Raises:
        RecipeError: as for `parse`, or it is too large.
    """
    data = content(path)
    if len(data) > LARGEST_DESCRIPTION:
        fail(path, f"is larger than {LARGEST_DESCRIPTION // 10**6} MB, which no {kind} is", "file")
    top = Element("", {})
    stack, count = [top], 0

    def start(tag: str, given: Attributes) -> None:
        nonlocal count
        count += 1
        check_nodes(path, count)
        made = Element(tag, given)
        stack[-1].children.append(made)
        stack.append(made)

    def end(tag: str) -> None:
        stack.pop()

    parse(path, io.BytesIO(data), start, end, kind=kind, place="file", deepest=deepest)
    return top.children[0]


def numbers(path: Path, element: Element, key: str, counts: tuple[int, ...], default: str | None = None) -> Array:
    """The numbers in an attribute, as many as one of `counts`; those of `default` where it is missing.

    Raises:
        RecipeError: it is missing without a default, or holds something else.
    """
    text = element.given.get(key, default)
    where = f"{element.place}.{key}"
    told = f"{' or '.join(map(str, counts))} finite number{'s' * (counts != (1,))}"
    if text is None:
        fail(path, f"is missing; give {told}", where)
    try:
        found = np.array([float(word) for word in text.split()], dtype=np.float64)
    except ValueError:
        found = np.zeros(0)
    if len(found) not in counts or not (np.abs(found) < FARTHEST).all():
        fail(path, f"should be {told}, not {shown(text)}", where)
    return found


def parse(
    path: Path, stream: Stream, start: Callable[[str, Attributes], None], end: Callable[[str], None],
    *, kind: str, place: str, deepest: int,
) -> None:  # fmt: skip
    """Calls `start` and `end` for each element of a stream of XML.

    Raises:
        RecipeError: it is not XML, has a document type, is nested too deeply, or has no number where one belongs.
    """
    depth = 0

    def opened(tag: str, given: Attributes) -> None:
        nonlocal depth
        depth += 1
        if depth > deepest:
            fail(path, f"is nested more than {deepest} deep, which no {kind} is")
        start(tag, given)

    def closed(tag: str) -> None:
        nonlocal depth
        depth -= 1
        end(tag)

    parser = ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = opened, closed
    parser.StartDoctypeDeclHandler = lambda *_: _refuse(path, kind)
    parser.EntityDeclHandler = lambda *_: _refuse(path, kind)
    try:
        while piece := stream.read(_PIECE):
            parser.Parse(piece, False)
        parser.Parse(b"", True)
    except ExpatError as error:
        fail(path, f"its model is not XML ({error}); the file is truncated or damaged", place)
    except (ValueError, OverflowError, KeyError) as error:
        text = f"has something else where a number should be ({str(error)[:60]})"
        fail(path, text, f"{place}, line {parser.CurrentLineNumber}")


def _refuse(path: Path, kind: str) -> NoReturn:
    fail(path, f"declares a document type, which no {kind} does; it is refused")
