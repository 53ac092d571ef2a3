"""Base patches: connected coplanar parts and edges perpendicular to d (section 5.1).

The graph has a node for each part perpendicular to d and for each *line*, a horizontal line of a sheet that folds:
its two ends, and wherever a part perpendicular to d touches it in between. Parts that touch are linked, a line is
linked to the parts that touch it there, and ends of two sheets that meet along their length are linked. A component
with a part, or with at least two lines, is a base patch; a single line is the tip of a T-scaffold and is discarded.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from foldfab.geometry.boxes import Boxes, close_pairs, grown
from foldfab.geometry.groups import Groups
from foldfab.scaffold import segments, sheets
from foldfab.scaffold.bridges import bridge
from foldfab.scaffold.contacts import Contacts
from foldfab.scaffold.model import BasePatch, Outline
from foldfab.scaffold.segments import Segment
from foldfab.scaffold.sheets import Sheet

STUB_SHARE = 0.12
"""A sheet that sticks out beyond a base by less than this share of its length is trimmed to the base."""
STEP = 0.5
"""Parts of a base whose middles differ more than this in height keep their own heights, mm."""
ALIGNED = np.cos(np.radians(10.0))
"""Ends of two sheets join where they run this parallel."""


@dataclass(frozen=True, slots=True, order=True)
class Line:
    """A horizontal line of a sheet: one of its ends, or where a base crosses it."""

    sheet: int
    height: float
    """mm."""

    end: int
    """-1 for the sheet's lower end, 1 for its upper end, 0 in between."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Which base patch each line of each sheet belongs to."""

    bases: tuple[BasePatch, ...]
    lines: dict[int, tuple[tuple[Line, str], ...]]
    """By sheet, its lines that lie in a base patch, lowest first."""


def find_bases(
    parts: tuple[Segment, ...],
    leaves: tuple[Sheet, ...],
    contacts: Contacts,
    stub: float,
    cornered: frozenset[str] = frozenset(),
) -> Layout:
    """The base patches of the parts perpendicular to d and of the sheets' ends.

    Args:
        parts: the segments perpendicular to d.
        leaves: the sheets that fold.
        contacts: which of them touch.
        stub: shorter pieces of a sheet than this cannot fold and are trimmed, mm.
        cornered: parts whose ends belong to the base of an end that they meet at a corner.
    """
    touching: list[list[int]] = [[] for _ in leaves]
    joints: list[tuple[int, int]] = []
    of_parts, of_leaves = [(part.name,) for part in parts], [leaf.parts for leaf in leaves]
    if parts:
        solids = segments.as_boxes(parts)
        joints = contacts.between(solids, of_parts, solids, of_parts)
        for i, j in contacts.between(sheets.as_boxes(leaves), of_leaves, solids, of_parts):
            touching[i].append(j)
    lines, touched = _lines(parts, leaves, touching, contacts.tolerance, stub)
    # Numbers of parts come first, those of lines after them.
    whole = Groups(len(parts) + len(lines), joints)
    for k, members in enumerate(touched, len(parts)):
        for j in members:
            whole.join(k, j)
    for k, other in _meeting_ends(leaves, lines, contacts, cornered):
        whole.join(len(parts) + k, len(parts) + other)
    is_needed = _connecting(Groups(len(parts), joints), touched)
    stated = contacts.stated(of_leaves, of_parts)
    reached = [[j for j in members if (line.sheet, j) in stated] for line, members in zip(lines, touched, strict=True)]
    return _layout(whole, parts, leaves, lines, is_needed, reached)


def _pairs(a: Boxes, b: Boxes) -> list[tuple[int, int]]:
    i, j = close_pairs(a, b)
    return list(zip(i.tolist(), j.tolist(), strict=True))


def _lines(
    parts: tuple[Segment, ...], leaves: tuple[Sheet, ...], touching: list[list[int]], tolerance: float, stub: float
) -> tuple[list[Line], list[list[int]]]:
    """The lines of all sheets, and for each the parts that touch its sheet there."""
    heights = [float(part.center[2]) for part in parts]
    lines: list[Line] = []
    touched: list[list[int]] = []
    for i, leaf in enumerate(leaves):
        bottom, top = leaf.bottom, leaf.top
        margin = max(stub, STUB_SHARE * (top - bottom))
        groups = _grouped([(heights[j], j) for j in touching[i]], tolerance + leaf.thickness)
        for height, members, end in _with_ends(bottom, top, groups, margin):
            lines.append(Line(i, height, end))
            touched.append(members)
    return lines, touched


def _grouped(found: list[tuple[float, int]], tolerance: float) -> list[tuple[float, list[int]]]:
    groups: list[tuple[float, list[int]]] = []
    for height, part in sorted(found):
        if groups and height - groups[-1][0] <= tolerance:
            groups[-1][1].append(part)
        else:
            groups.append((height, [part]))
    return groups


def _with_ends(
    bottom: float, top: float, groups: list[tuple[float, list[int]]], margin: float
) -> list[tuple[float, list[int], int]]:
    """The groups of touching parts with the two ends among them; groups near an end are that end's."""
    low = [g for g in groups if g[0] - bottom <= margin]
    high = [g for g in groups if top - g[0] <= margin and g not in low]
    inner = [g for g in groups if g not in low and g not in high]
    ends = []
    for near, height, end in ((low, bottom, -1), (high, top, 1)):
        ends.append((near[0][0] if near else height, [j for g in near for j in g[1]], end))
    return [ends[0], *((height, members, 0) for height, members in inner), ends[1]]


def _meeting_ends(
    leaves: tuple[Sheet, ...], lines: list[Line], contacts: Contacts, cornered: frozenset[str]
) -> list[tuple[int, int]]:
    """Which lines, by their numbers, are ends of different sheets that meet along their length.

    Ends that only meet at a corner are left apart: they would make a base out of air where two T-scaffolds fold freely.
    Ends of `cornered` parts are not: these have no other base to fold onto.
    """
    ends = [k for k, line in enumerate(lines) if line.end]
    if not ends:
        return []
    strips = grown(_strips(leaves, [lines[k] for k in ends], contacts.tolerance), contacts.tolerance / 2)
    found = []
    for i, j in _pairs(strips, strips):
        a, b = lines[ends[i]].sheet, lines[ends[j]].sheet
        is_corner = abs(leaves[a].along @ leaves[b].along) <= ALIGNED
        if contacts.are_apart(leaves[a].parts, leaves[b].parts):
            continue
        if a < b and (not is_corner or not cornered.isdisjoint(leaves[a].parts + leaves[b].parts)):
            found.append((ends[i], ends[j]))
    return found


def _strips(leaves: tuple[Sheet, ...], lines: list[Line], height: float) -> Boxes:
    """Thin horizontal boxes along the lines, as thick as the sheets."""
    made = [leaves[line.sheet] for line in lines]
    along = np.array([s.along for s in made])
    up = np.tile([0.0, 0.0, 1.0], (len(made), 1))
    half = np.array([[s.width / 2, s.thickness / 2, height / 2] for s in made])
    center = np.array([s.at(line.height) for s, line in zip(made, lines, strict=True)])
    return Boxes(center, np.stack([along, np.cross(up, along), up], axis=1), half)


def _layout(
    whole: Groups, parts: tuple[Segment, ...], leaves: tuple[Sheet, ...], lines: list[Line], is_needed: list[bool],
    reached: list[list[int]],
) -> Layout:  # fmt: skip
    """The bases by their groups; `reached` holds for each line the parts that it touches because the recipe says so."""
    found: list[tuple[BasePatch, list[Line]]] = []
    outlines = _outlines(parts)
    for component in whole.all():
        members = [n for n in component if n < len(parts)]
        own = [n - len(parts) for n in component if n >= len(parts)]
        if members or len(own) > 1:
            inside = [lines[k] for k in own]
            strips = [_strip_outline(leaves[lines[k].sheet], lines[k]) for k in own if is_needed[k]]
            strips += _bridges([(_strip_outline(leaves[lines[k].sheet], lines[k]), reached[k]) for k in own], outlines)
            made = _base([parts[j] for j in members], [outlines[j] for j in members], inside, strips, leaves)
            found.append((made, inside))
    floor = min((base.bottom for base, _ in found), default=0.0)
    found.sort(key=lambda f: (round(f[0].bottom - floor, 6), f[0].name, f[1]))
    taken = {part for leaf in leaves for part in leaf.parts}
    bases: list[BasePatch] = []
    owned: dict[int, list[tuple[Line, str]]] = {i: [] for i in range(len(leaves))}
    for base, lines in found:
        name = base.name
        while name in taken:
            name += "'"
        taken.add(name)
        bases.append(replace(base, name=name))
        for line in lines:
            owned[line.sheet].append((line, name))
    return Layout(tuple(bases), {i: tuple(sorted(own, key=lambda o: o[0].height)) for i, own in owned.items()})


def _base(
    parts: list[Segment], outlines: list[Outline], lines: list[Line], strips: list[Outline], leaves: tuple[Sheet, ...]
) -> BasePatch:
    heights = [float(part.center[2]) for part in parts] or [line.height for line in lines]
    low, high = min(heights), max(heights)
    if parts and high - low > STEP:
        outlines = [_with_extent(outline, part) for outline, part in zip(outlines, parts, strict=True)]
    if parts:
        name = max(parts, key=lambda p: (float(np.prod(np.sort(p.half)[1:])), p.name)).name
    else:
        name = "+".join(sorted({leaves[line.sheet].parts[0] for line in lines})[:3])
    return BasePatch(name, tuple(sorted(p.name for p in parts)), low, high, (*outlines, *strips))


def _bridges(reaching: list[tuple[Outline, list[int]]], outlines: list[Outline]) -> list[Outline]:
    found = [bridge(strip, outlines[j]) for strip, members in reaching for j in members]
    return [outline for outline in found if outline is not None]


def _connecting(joined: Groups, touched: list[list[int]]) -> list[bool]:
    """Of each line, whether the parts of its base would not hang together without it.

    Args:
        joined: which parts hang together; more and more is joined here.
        touched: for each line, the parts that touch it.
    """
    is_needed = []
    for members in touched:
        apart = {joined.of(j) for j in members}
        is_needed.append(len(apart) != 1)
        for j in apart:
            joined.join(members[0], j)
    return is_needed


def _outlines(parts: tuple[Segment, ...]) -> list[Outline]:
    """What each part covers, seen from above: the tight rectangle along its longest level side."""
    if not parts:
        return []
    axes, half = np.array([part.axes for part in parts]), np.array([part.half for part in parts])
    level = np.hypot(axes[:, :, 0], axes[:, :, 1]) * half
    along = axes[np.arange(len(parts)), np.argmax(level, axis=1), :2]
    along = along / np.sqrt(along[:, None, :] @ along[:, :, None])[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    turned = np.abs(axes[:, :, :2] @ np.stack([along, across], axis=1).swapaxes(1, 2)).swapaxes(1, 2)
    reach = (turned @ half[:, :, None])[:, :, 0]
    return [Outline(p.name, p.center[:2], a, r) for p, a, r in zip(parts, along, reach, strict=True)]


def _with_extent(outline: Outline, part: Segment) -> Outline:
    rise = float(np.abs(part.axes[:, 2]) @ part.half)
    return replace(outline, extent=(float(part.center[2]) - rise, float(part.center[2]) + rise))


def _strip_outline(leaf: Sheet, line: Line) -> Outline:
    return Outline(leaf.parts[0], leaf.at(line.height)[:2], leaf.along[:2], np.array([leaf.width, leaf.thickness]) / 2)
