"""Validity of a configuration (section 4, figure 5): a spanning tree places all bodies, the other hinges must agree.

Breadth first from the first body, neighbours in the order of their names, so that the tree is always the same. Cost:
linear in hinges and moments.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.geometry.rotation import cosine, sine
from foldfab.validity.model import Hinge, Linkage


@dataclass(frozen=True, slots=True)
class Tree:
    """A spanning tree of the hinge graph."""

    edges: tuple[tuple[int, bool], ...]
    """Hinges in the order in which they place a body, and whether that body is their second one."""
    closing: tuple[int, ...]
    """The other hinges."""
    adrift: tuple[str, ...]
    """Bodies that no hinges connect to the first one, sorted."""


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """Where bodies are: x of the open posture is at `turn` x + `place`."""

    turn: Array
    """(k, n, 3, 3) rotations."""
    place: Array
    """(k, n, 3) mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Breaks:
    """How badly each of h hinges is violated at k moments."""

    distance: Array
    """(k, h) between the axis as its two bodies carry it, mm."""
    bend: Array
    """(k, h) between the two directions of the axis, radians."""
    twist: Array
    """(k, h) between the angle that the bodies make and the assigned one, radians."""


def spanning_tree(linkage: Linkage) -> Tree:
    """The spanning tree that starts at the first body."""
    ends = {h: (hinge.first, hinge.second) for h, hinge in enumerate(linkage.hinges)}
    at: dict[str, list[tuple[str, int]]] = {body.name: [] for body in linkage.bodies}
    for h, (first, second) in ends.items():
        at[first].append((second, h))
        at[second].append((first, h))
    root = linkage.bodies[0].name
    seen, edges, queue = {root}, [], deque([root])
    while queue:
        name = queue.popleft()
        for other, h in sorted(at[name]):
            if other not in seen:
                seen.add(other)
                edges.append((h, other == ends[h][1]))
                queue.append(other)
    used = {h for h, _ in edges}
    closing = tuple(h for h in ends if h not in used)
    return Tree(tuple(edges), closing, tuple(sorted(set(at) - seen)))


def arranged(linkage: Linkage, tree: Tree, angles: Array, slips: Array) -> Poses:
    """Where the angles (k, h) of the tree's hinges put all bodies; those adrift stay.

    `slips` (k, h, 3) mm is added where a hinge has play.
    """
    index = {body.name: i for i, body in enumerate(linkage.bodies)}
    turn = np.tile(np.eye(3), (len(angles), len(index), 1, 1))
    place = np.zeros((len(angles), len(index), 3))
    for h, is_second in tree.edges:
        hinge = linkage.hinges[h]
        a, b = index[hinge.first], index[hinge.second]
        spin = rotations(hinge.direction, angles[:, h])
        arm = hinge.point - spin @ hinge.point
        if is_second:
            turn[:, b] = turn[:, a] @ spin
            place[:, b] = place[:, a] + _applied(turn[:, a], arm) + slips[:, h]
        else:
            turn[:, a] = turn[:, b] @ np.swapaxes(spin, 1, 2)
            place[:, a] = place[:, b] - _applied(turn[:, a], arm) - slips[:, h]
    return Poses(turn, place)


def breaks(linkage: Linkage, which: tuple[int, ...], poses: Poses, angles: Array, slips: Array) -> Breaks:
    """How badly the hinges `which` are violated by the poses."""
    index = {body.name: i for i, body in enumerate(linkage.bodies)}
    found = [_break(linkage.hinges[h], index, poses, angles[:, h], slips[:, h]) for h in which]
    columns = np.array(found).reshape(len(which), 3, len(angles))
    return Breaks(columns[:, 0].T, columns[:, 1].T, columns[:, 2].T)


def rotations(direction: Array, angles: Array) -> Array:
    """Right-handed rotations (k, 3, 3) about a unit `direction` by angles (k,), exact at quarter turns."""
    x, y, z = direction
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sin, cos = sine(angles)[:, None, None], cosine(angles)[:, None, None]
    found: Array = cos * np.eye(3) + sin * cross + (1 - cos) * np.outer(direction, direction)
    return found


def _break(hinge: Hinge, index: dict[str, int], poses: Poses, angles: Array, slips: Array) -> tuple[Array, ...]:
    a, b = index[hinge.first], index[hinge.second]
    turn_a, turn_b = poses.turn[:, a], poses.turn[:, b]
    apart = (turn_b - turn_a) @ hinge.point + poses.place[:, b] - poses.place[:, a] - slips
    bend = np.linalg.norm((turn_b - turn_a) @ hinge.direction, axis=-1)
    made = np.swapaxes(turn_a, 1, 2) @ turn_b
    side = np.cross(hinge.direction, np.eye(3)[int(np.argmin(np.abs(hinge.direction)))])
    side /= np.linalg.norm(side)
    turned = made @ side
    angle = np.arctan2(turned @ np.cross(hinge.direction, side), turned @ side)
    twist = np.abs((angle - angles + np.pi) % (2 * np.pi) - np.pi)
    return np.linalg.norm(apart, axis=-1), bend, twist


def _applied(turn: Array, arm: Array) -> Array:
    moved: Array = np.einsum("kij,kj->ki", turn, arm)
    return moved
