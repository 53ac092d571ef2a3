"""Which reader a file needs, by its name; and whether it is what its name says, by its first bytes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from foldfab.intake.limits import fail
from foldfab.intake.model import Shapes

FORMATS = {
    ".step": "STEP", ".stp": "STEP", ".glb": "GLB", ".gltf": "glTF", ".obj": "OBJ", ".3mf": "3MF", ".stl": "STL",
    ".urdf": "URDF", ".mjcf": "MJCF", ".xml": "MJCF",
}  # fmt: skip
"""By the file's ending."""
_OTHERS = (
    ".blend", ".dae", ".dxf", ".f3d", ".fbx", ".fcstd", ".iges", ".igs", ".ply", ".sdf", ".skp", ".sldprt", ".usdz",
    ".wrl", ".xacro",
)  # fmt: skip
"""What people have, too."""
_ROBOTS = {"URDF", "MJCF"}
"""Told apart by their reader, as both are called .xml."""
_SNIFFED = 4096
"""Bytes looked at."""


def is_shapes(path: Path) -> bool:
    """Whether a path is a file of shapes, or a folder, rather than a recipe."""
    return path.is_dir() or path.suffix.lower() in (*FORMATS, *_OTHERS)


def shapes(path: Path) -> Shapes:
    """The bodies in a file of any format that is read, or in a folder of STL files.

    Raises:
        RecipeError: it cannot be read, with the reason.
    """
    if path.is_dir():
        from foldfab.intake.stl import read_folder

        return read_folder(path)
    name = FORMATS.get(path.suffix.lower())
    if name is None:
        fail(path, f"is of a kind that is not read; export it as one of {', '.join(FORMATS)}", "file")
    _check_content(path, name)
    return _reader(name)(path)


def _reader(name: str) -> Callable[[Path], Shapes]:
    from foldfab.intake import gltf, obj, robots, step, stl, threemf

    readers = {"STEP": step.read, "OBJ": obj.read, "3MF": threemf.read, "STL": stl.read}
    readers |= {"URDF": robots.read, "MJCF": robots.read}
    return readers.get(name, gltf.read)


def _check_content(path: Path, name: str) -> None:
    """Raises: RecipeError: the file begins like one of another format."""
    try:
        # A pipe would never end.
        if not path.is_file():
            return
        with path.open("rb") as file:
            head = file.read(_SNIFFED)
    except (OSError, ValueError):
        # The reader says it better.
        return
    found = _sniffed(head)
    if found is not None and found != name and {found, name} != _ROBOTS:
        ending = next(ending for ending, other in FORMATS.items() if other == found)
        fail(path, f"is named as {name}, but it is a {found} file by its content; rename it to {ending}", "file")


def _sniffed(head: bytes) -> str | None:
    """The format that only such a beginning has; None where it can be many."""
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    if head.startswith(b"glTF"):
        return "GLB"
    if head.startswith(b"PK\x03\x04"):
        return "3MF"
    if text.startswith(b"ISO-10303-21"):
        return "STEP"
    if text.startswith(b"{") and b'"asset"' in head:
        return "glTF"
    if text.startswith(b"<"):
        return "URDF" if b"<robot" in head else "MJCF" if b"<mujoco" in head else None
    if text.startswith(b"solid") and b"facet" in head:
        return "STL"
    return None
