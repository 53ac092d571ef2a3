"""Whether a print file is fit for slicing, in the words that slicers use, from the meshes that it holds.

Nothing here asks a slicer. What is an error must not occur at all; what is a note costs support or care.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from foldfab.export.faults import Faults, faults
from foldfab.export.hanging import floating, overhang_areas
from foldfab.export.solid import Solid, close_pairs, solid
from foldfab.fabrication.walls import thinnest
from foldfab.geometry.arrays import Array, Indices
from foldfab.slicing.profile import CLOSING_RADIUS_MM, LAYER_MM, LINE_MM, NOZZLE_MM

Mesh = tuple[str, Array, Indices]
"""Name, (n, 3) vertices as they will be printed, mm, and (m, 3) faces of one body."""

CLOSED_MM = 2 * CLOSING_RADIUS_MM
"""Gaps narrower than this are closed by slicers."""
APART_MM = 100.0
"""Between plates."""
FAR_GAPS = 2.0
"""Bodies that are further apart than this many clearances are no neighbours."""


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of thing that is looked for."""

    name: str
    is_error: bool
    """Whether it must not occur; else it is worth knowing."""
    count: float | None
    """How many there are, or how many mm²; None where faults of the mesh keep it from being measured."""
    text: str
    """The measured figure, and what it is held against."""


@dataclass(frozen=True, slots=True)
class Printability:
    """All kinds, errors first."""

    kinds: tuple[Kind, ...]

    @property
    def ok(self) -> bool:
        """Whether there is no error, and all were looked for."""
        return all(kind.count == 0 for kind in self.kinds if kind.is_error)

    @property
    def errors(self) -> tuple[str, ...]:
        """One sentence for each kind of error that occurs."""
        return tuple(f"{k.name}: {k.count:g}, {k.text}" for k in self.kinds if k.is_error and k.count)


def printability(meshes: Sequence[Mesh], clearance: float, propped: Collection[str] = ()) -> Printability:
    """Of the bodies of a print as they lie on the bed; hinges are printed with `clearance`, mm.

    Bodies that are `propped` stand on blocks that are broken off; what holds those is thin on purpose.
    """
    found = [(name, faults(vertices, faces)) for name, vertices, faces in meshes]
    kinds = _mesh_kinds(found)
    if not all(fault.is_closed for _, fault in found):
        unknown = "not measured, since the meshes are not closed"
        solids = [("thin walls", True), ("narrow gaps", True), ("overhangs", False), ("floating regions", False)]
        return Printability(
            (*kinds, *(Kind(name, is_error, None, unknown) for name, is_error in solids), _slivers(found))
        )
    bodies = [solid(*mesh) for mesh in meshes]
    return Printability(
        (
            *kinds,
            _walls([b for b in bodies if b.name not in propped]),
            _gaps(bodies, clearance),
            *_hanging(bodies, clearance),
            _slivers(found),
        )
    )


def side_by_side(plates: Sequence[Sequence[Mesh]]) -> list[Mesh]:
    """The bodies of several plates, far enough from those of other plates to have nothing to do with them."""
    corners = [vertices[:, 0] for plate in plates for _, vertices, _ in plate]
    step = np.array([max(map(np.max, corners)) - min(map(np.min, corners)) + APART_MM, 0.0, 0.0])
    return [(name, vertices + k * step, faces) for k, plate in enumerate(plates) for name, vertices, faces in plate]


def as_json(found: Printability, facts: dict[str, object]) -> str:
    """The text of `printability.json`; `facts` name the print."""
    limits = {"nozzle_mm": NOZZLE_MM, "line_mm": LINE_MM, "layer_mm": LAYER_MM, "closed_gap_mm": CLOSED_MM}
    data = {**facts, **limits, "ok": found.ok, "kinds": [asdict(kind) for kind in found.kinds]}
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def as_text(found: Printability) -> str:
    """A table for people, without a line break at its end."""
    lines = ["Printability"]
    for kind in found.kinds:
        count = "-" if kind.count is None else f"{kind.count:.0f}"
        what = "note " if not kind.is_error else "ok   " if kind.count == 0 else "ERROR"
        lines.append(f"  {what}  {kind.name:<18}{count:>7}  {kind.text}".rstrip())
    return "\n".join(lines)


def _mesh_kinds(found: list[tuple[str, Faults]]) -> tuple[Kind, ...]:
    kinds = []
    for field in ("open_edges", "nonmanifold_edges", "backwards_edges", "degenerate_facets"):
        where = [name for name, fault in found if getattr(fault, field)]
        count = sum(getattr(fault, field) for _, fault in found)
        name = field.replace("_", " ").replace("nonmanifold", "non-manifold")
        kinds.append(Kind(name, True, count, f"in {', '.join(where[:3])}" if where else ""))
    return tuple(kinds)


def _slivers(found: list[tuple[str, Faults]]) -> Kind:
    where = [name for name, fault in found if fault.slivers]
    text = f"facets lower than 0.1 µm, in {', '.join(where[:3])}; slicers pass over them" if where else ""
    return Kind("slivers", False, sum(fault.slivers for _, fault in found), text)


def _walls(bodies: list[Solid]) -> Kind:
    found = [(*_thinnest(body, 2 * LINE_MM), body.name) for body in bodies]
    least, _, name = min(found, default=(2 * LINE_MM, 0, ""))
    text = f"none under {2 * LINE_MM:g} mm" if least >= 2 * LINE_MM else f"thinnest {least:.2f} mm, of {name}"
    count = sum(_thinnest(body, LINE_MM)[1] for body in bodies) if least < LINE_MM else 0
    return Kind("thin walls", True, count, f"{text}; a line is {LINE_MM:g} mm wide")


def _thinnest(body: Solid, limit: float) -> tuple[float, int]:
    return thinnest(body.vertices, body.faces, body.manifold, limit)


def _gaps(bodies: list[Solid], clearance: float) -> Kind:
    far = FAR_GAPS * clearance
    pairs = [(bodies[i], bodies[j]) for i, j in close_pairs([body.vertices for body in bodies], far)]
    gaps = [(float(a.manifold.min_gap(b.manifold, far)), a.name, b.name) for a, b in pairs]
    narrow = sum(gap < CLOSED_MM for gap, _, _ in gaps)
    least, first, second = min(gaps, default=(far, "", ""))
    text = f"least {least:.3f} mm, between {first} and {second}" if least < far else "no two bodies are near each other"
    return Kind("narrow gaps", True, narrow, f"{text}; slicers close {CLOSED_MM:.3f} mm")


def _hanging(bodies: list[Solid], clearance: float) -> tuple[Kind, Kind]:
    near = FAR_GAPS * clearance
    total, close = overhang_areas(bodies, near)
    sloping = f"mm² flatter than 45°, {close:.0f} of them less than {near:g} mm above a body" if total else ""
    regions = floating(bodies, LAYER_MM)
    high = [region for region in regions if region.drop > near]
    text = (
        f"{len(regions) - len(high)} start less than {near:g} mm above a body" if regions else "all start on something"
    )
    if high:
        text += f"; {high[0].body} starts {high[0].drop:.1f} mm up in the air"
    return (
        Kind("overhangs", False, round(total, 1), sloping),
        Kind("floating regions", False, len(regions), text),
    )
