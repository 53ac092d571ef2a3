"""How much a file of shapes may hold; counted while reading, so that what is larger costs nothing more."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

from foldfab.errors import Problem, RecipeError
from foldfab.recipe.problems import TOP, shown

LARGEST_FILE = 400_000_000
"""Bytes: two million triangles as text take half of it."""
MOST_TRIANGLES = 3_000_000
"""Of the whole furniture, copies counted."""
MOST_VERTICES = 9_000_000
MOST_BODIES = 5_000
"""Copies counted."""
MOST_NODES = 100_000
"""Nodes, objects and components, copies counted."""
DEEPEST = 64
"""Levels of an assembly."""
LARGEST_UNPACKED = 800_000_000
"""Bytes of a 3MF's models together."""
MOST_EXPANDED = 100
"""Bytes unpacked for one packed; meshes as XML reach about 15."""
DEEPEST_XML = 32
LARGEST_DESCRIPTION = 20_000_000
"""Bytes of a URDF or MJCF file, whose shapes lie in files of their own."""
FARTHEST = 1e9
"""Units; furniture has no larger coordinates in any of them."""
LONGEST_SECONDS = 120.0
"""For the reader of STEP files."""
LARGEST_MEMORY = 4 << 30
"""Bytes of address space for the reader of STEP files, whose libraries take up one of it."""
LARGEST_DATA = 850_000_000
"""Bytes that it may fill; with what its libraries share it stays within 1 GB, as the other readers do at the limits."""


def fail(path: Path | str, text: str, place: str = TOP) -> NoReturn:
    """Ends reading.

    Raises:
        RecipeError: always.
    """
    source = str(path)
    raise RecipeError(source if source.isprintable() else shown(source), (Problem(place, text),))


def content(path: Path) -> bytes:
    """All bytes of a file.

    Raises:
        RecipeError: it is absent, no file, empty or too large.
    """
    try:
        if not path.is_file():
            fail(path, "there is no such file" if not path.exists() else "is not a plain file", "file")
        with path.open("rb") as file:
            found = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        fail(path, f"cannot be read ({getattr(error, 'strerror', None) or error})", "file")
    if not found:
        fail(path, "is empty; export it again", "file")
    if len(found) > LARGEST_FILE:
        fail(path, f"is larger than {LARGEST_FILE // 10**6} MB; export it with a coarser mesh", "file")
    return found


def check_triangles(path: Path | str, count: int) -> None:
    """Raises: RecipeError: so many triangles are too many."""
    if count > MOST_TRIANGLES:
        fail(path, f"has more than {MOST_TRIANGLES} triangles; export it with a coarser mesh")


def check_vertices(path: Path | str, count: int) -> None:
    """Raises: RecipeError: so many vertices are too many."""
    if count > MOST_VERTICES:
        fail(path, f"has more than {MOST_VERTICES} vertices; export it with a coarser mesh")


def check_bodies(path: Path | str, count: int) -> None:
    """Raises: RecipeError: so many bodies are too many."""
    if count > MOST_BODIES:
        fail(path, f"has more than {MOST_BODIES} bodies; export only the furniture, without hardware")


def check_nodes(path: Path | str, count: int) -> None:
    """Raises: RecipeError: so many nodes are too many."""
    if count > MOST_NODES:
        fail(path, f"has more than {MOST_NODES} nodes, copies counted; export only the furniture")


def check_depth(path: Path | str, depth: int) -> None:
    """Raises: RecipeError: an assembly is nested too deeply."""
    if depth > DEEPEST:
        fail(path, f"has assemblies nested more than {DEEPEST} deep")
