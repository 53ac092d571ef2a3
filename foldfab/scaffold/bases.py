"""Base patches: connected coplanar parts and edges perpendicular to d (section 5.1).

The graph has a node for each part perpendicular to d and for each *line*, a horizontal line of a sheet that folds:
its two ends, and wherever a part perpendicular to d touches it in between. Parts that touch are linked, a line is
linked to the parts that touch it there, and ends of two sheets that meet along their length are linked. A component
with a part, or with at least two lines, is a base patch; a single line is the tip of a T-scaffold and is discarded.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import networkx as nx
import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, close_pairs, grown
from foldfab.scaffold import segments, sheets
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


def find_bases(parts: tuple[Segment, ...], leaves: tuple[Sheet, ...], tolerance: float, stub: float) -> Layout:
    """The base patches of the parts perpendicular to d and of the sheets' ends.

    Args:
        parts: the segments perpendicular to d.
        leaves: the sheets that fold.
        tolerance: parts closer than this touch, mm.
        stub: shorter pieces of a sheet than this cannot fold and are trimmed, mm.
    """
    graph: nx.Graph[object] = nx.Graph()
    graph.add_nodes_from(range(len(parts)))
    solids = grown(segments.as_boxes(parts), tolerance / 2) if parts else None
    if solids is not None:
        graph.add_edges_from((int(i), int(j)) for i, j in zip(*close_pairs(solids, solids), strict=True) if i < j)
    lines = _lines(graph, parts, leaves, solids, tolerance, stub)
    _link_ends(graph, leaves, lines, tolerance)
    return _layout(graph, parts, leaves)


def _lines(
    graph: nx.Graph[object], parts: tuple[Segment, ...], leaves: tuple[Sheet, ...], solids: Boxes | None,
    tolerance: float, stub: float,
) -> list[Line]:  # fmt: skip
    touching: dict[int, list[int]] = {i: [] for i in range(len(leaves))}
    if solids is not None and leaves:
        hit = close_pairs(grown(sheets.as_boxes(leaves), tolerance / 2), solids)
        for i, j in zip(*hit, strict=True):
            touching[int(i)].append(int(j))
    made: list[Line] = []
    for i, leaf in enumerate(leaves):
        margin = max(stub, STUB_SHARE * (leaf.top - leaf.bottom))
        groups = _grouped([(float(parts[j].center[2]), j) for j in touching[i]], tolerance + leaf.thickness)
        for height, members, end in _with_ends(leaf, groups, margin):
            line = Line(i, height, end)
            made.append(line)
            graph.add_node(line)
            graph.add_edges_from((line, j) for j in members)
    return made


def _grouped(found: list[tuple[float, int]], tolerance: float) -> list[tuple[float, list[int]]]:
    groups: list[tuple[float, list[int]]] = []
    for height, part in sorted(found):
        if groups and height - groups[-1][0] <= tolerance:
            groups[-1][1].append(part)
        else:
            groups.append((height, [part]))
    return groups


def _with_ends(leaf: Sheet, groups: list[tuple[float, list[int]]], margin: float) -> list[tuple[float, list[int], int]]:
    """The groups of touching parts with the two ends among them; groups near an end are that end's."""
    low = [g for g in groups if g[0] - leaf.bottom <= margin]
    high = [g for g in groups if leaf.top - g[0] <= margin and g not in low]
    inner = [g for g in groups if g not in low and g not in high]
    ends = []
    for near, height, end in ((low, leaf.bottom, -1), (high, leaf.top, 1)):
        ends.append((near[0][0] if near else height, [j for g in near for j in g[1]], end))
    return [ends[0], *((height, members, 0) for height, members in inner), ends[1]]


def _link_ends(graph: nx.Graph[object], leaves: tuple[Sheet, ...], lines: list[Line], tolerance: float) -> None:
    """Links ends of different sheets that meet along their length.

    Ends that only meet at a corner are left apart: they would make a base out of air where two T-scaffolds fold freely.
    """
    ends = [line for line in lines if line.end]
    if not ends:
        return
    strips = grown(_strips(leaves, ends, tolerance), tolerance / 2)
    for i, j in zip(*close_pairs(strips, strips), strict=True):
        a, b = ends[i].sheet, ends[j].sheet
        if a < b and abs(leaves[a].along @ leaves[b].along) > ALIGNED:
            graph.add_edge(ends[i], ends[j])


def _strips(leaves: tuple[Sheet, ...], lines: list[Line], height: float) -> Boxes:
    """Thin horizontal boxes along the lines, as thick as the sheets."""
    made = [leaves[line.sheet] for line in lines]
    across = np.array([np.cross([0.0, 0.0, 1.0], s.along) for s in made])
    axes = np.stack([np.array([s.along for s in made]), across, np.tile([0.0, 0.0, 1.0], (len(made), 1))], axis=1)
    half = np.array([[s.width / 2, s.thickness / 2, height / 2] for s in made])
    return Boxes(np.array([s.at(line.height) for s, line in zip(made, lines, strict=True)]), axes, half)


def _layout(graph: nx.Graph[object], parts: tuple[Segment, ...], leaves: tuple[Sheet, ...]) -> Layout:
    found: list[tuple[BasePatch, list[Line]]] = []
    for component in nx.connected_components(graph):
        members = sorted(n for n in component if isinstance(n, int))
        lines = sorted((n for n in component if isinstance(n, Line)), key=lambda n: (n.sheet, n.height))
        if members or len(lines) > 1:
            found.append((_base(graph, [parts[j] for j in members], members, lines, leaves), lines))
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
    graph: nx.Graph[object], parts: list[Segment], members: list[int], lines: list[Line], leaves: tuple[Sheet, ...]
) -> BasePatch:
    stepped = len(parts) > 1 and float(np.ptp([part.center[2] for part in parts])) > STEP
    outlines = [_outline(part, is_stepped=stepped) for part in parts]
    needed = lines if not parts else _connecting(graph, members, lines)
    outlines += [_strip_outline(leaves[line.sheet], line) for line in needed]
    heights = [float(part.center[2]) for part in parts] or [line.height for line in lines]
    if parts:
        name = max(parts, key=lambda p: (float(np.prod(np.sort(p.half)[1:])), p.name)).name
    else:
        name = "+".join(sorted({leaves[line.sheet].parts[0] for line in lines})[:3])
    return BasePatch(name, tuple(sorted(p.name for p in parts)), min(heights), max(heights), tuple(outlines))


def _connecting(graph: nx.Graph[object], members: list[int], lines: list[Line]) -> list[Line]:
    """The lines without which the parts would not hang together."""
    parts_only = graph.subgraph(members)
    label = {n: k for k, c in enumerate(nx.connected_components(parts_only)) for n in c}
    joint: nx.Graph[int] = nx.Graph()
    joint.add_nodes_from(label.values())
    needed = []
    for line in lines:
        touched = sorted({label[n] for n in graph.neighbors(line) if isinstance(n, int)})
        if any(not nx.has_path(joint, touched[0], t) for t in touched[1:]):
            needed.append(line)
            nx.add_path(joint, touched)
        elif not touched:
            needed.append(line)
    return needed


def _outline(part: Segment, *, is_stepped: bool) -> Outline:
    level = np.hypot(part.axes[:, 0], part.axes[:, 1]) * part.half
    along = part.axes[int(np.argmax(level)), :2]
    made = _rectangle(part.name, part.center[:2], along / np.linalg.norm(along), part)
    rise = float(np.abs(part.axes[:, 2]) @ part.half)
    return replace(made, extent=(float(part.center[2]) - rise, float(part.center[2]) + rise)) if is_stepped else made


def _rectangle(name: str, center: Array, along: Array, part: Segment) -> Outline:
    across = np.array([-along[1], along[0]])
    reach = np.abs(part.axes[:, :2] @ np.stack([along, across]).T).T @ part.half
    return Outline(name, center, along, reach)


def _strip_outline(leaf: Sheet, line: Line) -> Outline:
    return Outline(leaf.parts[0], leaf.at(line.height)[:2], leaf.along[:2], np.array([leaf.width, leaf.thickness]) / 2)
