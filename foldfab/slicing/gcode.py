"""What PrusaSlicer writes about a print into its G-code: figures in comments, outlines in moves."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.errors import SlicingError
from foldfab.geometry.arrays import Array

OUTLINES = frozenset({"External perimeter", "Overhang perimeter"})
"""Kinds of extrusion that an outline is drawn with; where it hangs over, it changes kind on its way."""
SUPPORTS = frozenset({"Support material", "Support material interface"})
_UNITS = {"d": 86400, "h": 3600, "m": 60, "s": 1}


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """One layer of a print."""

    top: float
    """Its z, mm."""
    height: float
    """mm."""
    outlines: tuple[Array, ...]
    """(k, 2) mm: the paths of its outermost perimeters, walked without a gap, on the middle of their lines."""

    @property
    def middle(self) -> float:
        """Where the slicer cuts the mesh for this layer, mm."""
        return self.top - self.height / 2


def figure(gcode: str, name: str) -> float:
    """The number that stands in the comment `; name = number`.

    Raises:
        SlicingError: it does not stand there.
    """
    return float(_comment(gcode, name, r"[\d.]+"))


def seconds(gcode: str) -> int:
    """The estimated printing time.

    Raises:
        SlicingError: it does not stand there.
    """
    text = _comment(gcode, "estimated printing time (normal mode)", r"[\d dhms]+")
    return sum(int(count) * _UNITS[unit] for count, unit in re.findall(r"(\d+)([dhms])", text))


def heights(gcode: str) -> list[float]:
    """The tops of all layers, mm, from the bed up."""
    return [float(z) for z in re.findall(r"^;LAYER_CHANGE\n;Z:([\d.]+)", gcode, re.MULTILINE)]


def support_mm(gcode: str) -> float:
    """Filament that becomes support, mm, from the moves themselves; relative extrusion is taken for granted."""
    total, kind = 0.0, ""
    for line in gcode.splitlines():
        if line.startswith(";TYPE:"):
            kind = line[6:]
        elif kind in SUPPORTS and line.startswith("G1 X"):
            at = line.rfind(" E")
            total += float(line[at + 2 :]) if at > 0 else 0.0
    return total


def layers(gcode: str) -> Iterator[Layer]:
    """All layers with their outlines, from the bed up."""
    # A layer that starts with the kind of extrusion that the last one ended with does not name it again.
    kind = ""
    # What stands before the first mark is the start of the machine.
    for text in gcode.split(";LAYER_CHANGE\n")[1:]:
        head = re.match(r";Z:([\d.]+)\n;HEIGHT:([\d.]+)", text)
        if head is None:
            raise SlicingError("the G-code has a layer without a height; is this PrusaSlicer?")
        paths, kind = _outlines(text, kind)
        yield Layer(float(head[1]), float(head[2]), paths)


def _outlines(text: str, kind: str) -> tuple[tuple[Array, ...], str]:
    """The outlines of a layer that starts with a kind of extrusion, and the kind that it ends with.

    A move without extrusion ends a path, a change of kind does not.
    """
    found: list[list[tuple[float, float]]] = []
    path: list[tuple[float, float]] = []
    is_one = False
    for line in text.splitlines():
        if line.startswith(";TYPE:"):
            kind = line[6:]
        elif line.startswith("G1 X"):
            words = line.split()
            point = float(words[1][1:]), float(words[2][1:])
            if " E" in line:
                path.append(point)
                is_one = is_one or kind in OUTLINES
                continue
            if is_one:
                found.append(path)
            path, is_one = [point], False
    if is_one:
        found.append(path)
    return tuple(np.array(path) for path in found if len(path) > 1), kind


def _comment(gcode: str, name: str, pattern: str) -> str:
    found = re.search(rf"^; {re.escape(name)} = ({pattern})", gcode, re.MULTILINE)
    if found is None:
        raise SlicingError(f"the G-code does not tell its {name}; is this PrusaSlicer?")
    return found[1]
