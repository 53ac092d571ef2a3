"""Parts that a file has left far from the furniture that they belong to: it is understood without them, and says so.

Files have them where a parameter of the drawing went wrong, or where something stands beside the furniture. Most of
the parts have to hang together; else nothing tells what is the furniture and what is loose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.geometry.boxes import Boxes, close_pairs, gaps, grown
from foldfab.geometry.groups import Groups
from foldfab.intake.notes import listed
from foldfab.recipe.contacts import Contacts, pair, reach
from foldfab.recipe.model import Part

MAIN = 0.75
"""What holds this share of all parts together is the furniture."""


@dataclass(frozen=True, slots=True)
class Loose:
    """Parts that touch nothing of the furniture."""

    names: frozenset[str] = frozenset()
    notes: tuple[str, ...] = ()
    """What is said of them."""


NONE = Loose()


def loose(parts: tuple[Part, ...], contacts: Contacts) -> Loose:
    """Those beside the one heap of parts that holds most of them; none where no heap does."""
    names = [part.name for part in parts]
    boxes = Boxes(*(np.array(rows) for rows in zip(*((p.center, p.axes, p.size / 2) for p in parts), strict=True)))
    most = reach(2 * boxes.half)
    near = zip(*(found.tolist() for found in close_pairs(*2 * (grown(boxes, most / 2),))), strict=True)
    groups = Groups(len(parts), ((i, j) for i, j in near if pair(names[i], names[j]) not in contacts.apart))
    place = {name: index for index, name in enumerate(names)}
    for one, other in contacts.touching:
        groups.join(place[one], place[other])
    heaps = sorted(groups.all(), key=len)
    main = heaps.pop()
    if not heaps or len(main) < MAIN * len(parts):
        return NONE
    told = [_told(names, boxes, heap, main) for heap in heaps]
    text = f"LEFT OUT, as nothing of the rest touches them (parts touch within {most:.2g} mm): {listed(sorted(told))}"
    return Loose(frozenset(names[i] for heap in heaps for i in heap), (text,))


def _told(names: list[str], boxes: Boxes, heap: list[int], main: list[int]) -> str:
    """The parts of a heap, and how far they are from the furniture."""
    inner, outer = np.repeat(heap, len(main)), np.tile(main, len(heap))
    away = gaps(boxes[inner], boxes[outer])
    nearest = int(away.argmin())
    return f"{', '.join(names[i] for i in heap)} ({away[nearest]:.4g} mm from {names[outer[nearest]]})"
