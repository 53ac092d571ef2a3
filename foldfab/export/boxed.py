"""A solution drawn as the boxes that the solver knows, open and folded: a picture before there are any solids."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from foldfab.export import scene
from foldfab.export.camera import Camera
from foldfab.export.frames import moved
from foldfab.export.page import INK, frames, page_png
from foldfab.export.shell import Shell
from foldfab.folding.anatomy import anchor_feet, base_boxes, far_feet, moving_boxes
from foldfab.folding.kinematics import configuration
from foldfab.folding.model import Chain, FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, stacked

if TYPE_CHECKING:
    from PIL import Image

_CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))
_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
_FACES = np.concatenate([_QUADS[:, [0, 1, 2]], _QUADS[:, [0, 2, 3]]])
"""(12, 3) counter-clockwise seen from outside."""
ARROW, HEAD, WIDTH = 36.0, 14.0, 4
"""Half the length of the arrow along the folding direction, the length of its head, and its width, px."""
PLACE = (52, 336)
"""Its middle, px from the corner of the picture."""


def folded_png(solution: FoldSolution, title: str, line: str) -> bytes:
    """The furniture open, with its folding direction as an arrow, and flat, both in the recipe's axes at one scale."""
    shells = shells_of(solution)
    heap = scene.model(shells)
    opened, closed = _poses(solution, heap, shells)
    # Wherever it comes to lie, it is drawn where it stood.
    middle = [(points.min(0) + points.max(0)) / 2 for points in (opened, closed)]
    shift = middle[0] - middle[1]
    shift[2] = opened[:, 2].min() - closed[:, 2].min()
    drawn = frames(heap, [opened, closed + shift])
    _arrow(drawn.pictures[0], drawn.camera, solution.scaffold.direction)
    return page_png(drawn.pictures, ["open", "flat"], 2, title, line)


def shells_of(solution: FoldSolution) -> tuple[Shell, ...]:
    """A shell for each base with the feet on it, and for each panel with its inserted hinge; recipe's axes, open."""
    turn, thickness = solution.scaffold.rotation, solution.thickness
    made = []
    for base in solution.scaffold.bases:
        feet = [anchor_feet(c, thickness) for c in solution.chains if c.anchor == base.name]
        feet += [far_feet(c, thickness) for c in solution.chains if c.far == base.name]
        made.append(_shell(base.name, "base", stacked([base_boxes(base, thickness), *feet]), 0, turn))
    for chain in solution.chains:
        made += _panels(solution, chain)
    return tuple(made)


def _panels(solution: FoldSolution, chain: Chain) -> list[Shell]:
    boxes = moving_boxes(chain, solution.thickness, np.zeros(1))[0]
    count, made = len(chain.lengths), []
    for i, name in enumerate(chain.panels):
        # The boxes of the hinges follow those of the panels.
        own = [i, count + i] if i < count - 1 else [i]
        some = Boxes(boxes.center[own], boxes.axes[own], boxes.half[own])
        made.append(_shell(name, "panel", some, len(own) - 1, solution.scaffold.rotation))
    return made


def _shell(name: str, kind: str, boxes: Boxes, hinges: int, turn: Array) -> Shell:
    """Boxes (n,) as one body, the last of them hinges; `turn` leads from the recipe's axes to theirs."""
    corners = boxes.center[:, None] + np.einsum("ci,ni,nij->ncj", _CORNERS, boxes.half, boxes.axes)
    count = len(corners)
    faces = (8 * np.arange(count)[:, None, None] + _FACES).reshape(-1, 3)
    is_hinge = np.repeat(np.arange(count) >= count - hinges, len(_FACES))
    return Shell(name, "base" if kind == "base" else "panel", corners.reshape(-1, 3) @ turn, faces, is_hinge)


def _poses(solution: FoldSolution, heap: scene.Model, shells: tuple[Shell, ...]) -> tuple[Array, Array]:
    """(n, 3) points of the model, open and folded."""
    turn = np.eye(4)
    turn[:3, :3] = solution.scaffold.rotation
    motion = configuration(solution, np.array([0.0, 1.0]))
    found = heap.points.copy()
    for number, shell in enumerate(shells):
        own = heap.owner == number
        found[own] = moved(found[own], turn.T @ motion[shell.name][1] @ turn)
    return heap.points, found


def _arrow(picture: Image.Image, camera: Camera, direction: Array) -> None:
    """Draws the folding direction as it is seen into the picture's corner."""
    from PIL import ImageDraw

    way = camera.rows()[:2] @ direction
    tail, tip = np.array(PLACE) - ARROW * way, np.array(PLACE) + ARROW * way
    length = float(np.linalg.norm(way)) or 1.0
    along = way / length
    back, side = tip - HEAD * along, 0.5 * HEAD * np.array([-along[1], along[0]])
    draw = ImageDraw.Draw(picture)
    draw.line([tuple(tail), tuple(back)], fill=INK, width=WIDTH)
    draw.polygon([tuple(tip), tuple(back + side), tuple(back - side)], fill=INK)
