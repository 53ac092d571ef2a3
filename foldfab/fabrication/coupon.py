"""The coupon: the same base hinge in a row of clearances, to find the least one that a printer still frees.

One plate with its numbers raised on it, and a flap for each clearance, as it is printed: standing (posture `open`, axes
lying in the air) or lying on the plate's level (`folded`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.errors import FabricationError
from foldfab.fabrication import solids
from foldfab.fabrication.inspect import CLASH, GAP_SHARE, is_captive
from foldfab.fabrication.model import Body
from foldfab.fabrication.numbers import HEIGHT, strokes, text_width
from foldfab.fabrication.panels import panels
from foldfab.fabrication.plates import plate
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import union
from foldfab.fabrication.soles import bevelled
from foldfab.fabrication.solids import Solid
from foldfab.folding.mechanism import frames
from foldfab.folding.model import Chain, Thickness
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Posture
from foldfab.scaffold.model import BasePatch, Outline

CLEARANCES = (0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5)
"""mm."""
SPACE = 4.0
"""Between flaps, mm."""
LENGTH = 18.0
"""Of a flap, mm."""
TAIL = 11.0
"""How far the plate reaches behind the hinge, mm: room for the numbers."""
RAISED, SUNK = 0.6, 0.3
"""How high the numbers stand on the plate, and how deep they are rooted in it, mm."""
LAYER = 0.2
"""Height of its layers, mm."""


@dataclass(frozen=True, slots=True)
class Coupon:
    """A printed row of hinges."""

    bodies: tuple[Body, ...]
    """`plate`, and a flap for each clearance, named after it; as printed, on z = 0."""
    clearances: tuple[float, ...]
    """mm, from left to right when its numbers are read."""
    thickness: float
    """K, mm."""
    posture: Posture


def coupon(thickness: float, posture: Posture) -> Coupon:
    """The coupon for plates of a thickness (mm), in a posture.

    Clearances at which a hinge of that thickness would fall apart are left out.

    Raises:
        FabricationError: no clearance is left.
    """
    kept = [gap for gap in CLEARANCES if _holds(Thickness(thickness, gap))]
    if not kept:
        raise FabricationError(
            f"hinges of plates of {thickness:g} mm hold at no clearance; try a thickness of 3 or more"
        )
    width = max(Thickness(thickness, gap).hinge_width for gap in kept) + 2.0
    width = max(width, text_width("0.00"))
    halves = [_half(Thickness(thickness, gap), i * -(width + SPACE), width, posture) for i, gap in enumerate(kept)]
    made = {"plate": solids.tidied(solids.union([base for base, _ in halves]))}
    made |= {f"{gap:.2f}": solids.tidied(flap) for gap, (_, flap) in zip(kept, halves, strict=True)}
    lift = np.eye(4)
    lift[2, 3] = -min(float(solids.bounds(solid)[0][2]) for solid in made.values())
    made, _ = bevelled(made, {}, dict.fromkeys(made, lift), LAYER)
    _inspect(made, kept)
    bodies = tuple(_body(name, solid, lift[:3, 3]) for name, solid in made.items())
    return Coupon(bodies, tuple(kept), thickness, posture)


def _holds(thickness: Thickness) -> bool:
    base, flap = _half(thickness, 0.0, thickness.hinge_width + 2.0, "open")
    chain = _chain(thickness, 0.0, thickness.hinge_width + 2.0)
    axis = chain.root + chain.hinge_spans[0][:, None] * chain.along
    return is_captive(base, flap, axis, thickness.panel / 2, thickness.gap)


def _half(thickness: Thickness, y: float, width: float, posture: Posture) -> tuple[Solid, Solid]:
    """The piece of plate and the flap of one hinge in the middle at `y`."""
    chain, half = _chain(thickness, y, width), thickness.panel / 2
    # A flap that is printed folded lies on its plate, as it does in furniture.
    front = half + SPACE / 2 if posture == "open" else LENGTH
    middle, reach = (front - TAIL) / 2, (front + TAIL) / 2
    # A little wider than its share of the row, so that neighbours are one.
    tile = Outline("plate", np.array([middle, y]), np.array([1.0, 0.0]), np.array([reach, (width + SPACE) / 2 + 0.1]))
    base, _ = plate(BasePatch("plate", ("plate",), 0.0, 0.0, (tile,)), (chain,), thickness)
    number = f"{thickness.gap:.2f}"
    corner = np.array([-TAIL + 1.0, y + text_width(number) / 2, 0.0])
    assert TAIL - half > HEIGHT + 2.0
    axes = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    (flap,) = panels(chain, thickness, np.array([0.0, 0.0, 1.0]) if posture == "open" else None)
    whole = union([base, *strokes(number, half - SUNK, half + RAISED, corner, axes)])
    return printed(whole), _posed(printed(flap), chain, posture)


def _posed(flap: Solid, chain: Chain, posture: Posture) -> Solid:
    origins, axes = frames(chain, np.array([0.0, 1.0]))
    if posture == "open":
        return flap
    turn = axes[1, 0].T @ axes[0, 0]
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, origins[1, 0] - turn @ origins[0, 0]
    return solids.moved(flap, pose)


def _chain(thickness: Thickness, y: float, width: float) -> Chain:
    span = np.array([-width / 2, width / 2])
    return Chain(
        patch=f"{thickness.gap:.2f}", anchor="plate", far=None, mechanism="in-place",
        root=np.array([0.0, y, thickness.panel / 2 + thickness.axis_height]),
        across=np.array([1.0, 0.0, 0.0]), along=np.array([0.0, 1.0, 0.0]), rise=np.array([0.0, 0.0, 1.0]),
        lean=0.0, turn=np.pi / 2, lengths=np.array([LENGTH]), offsets=np.zeros(2), span=span,
        hinge_spans=np.tile(span, (2, 1)), pads=(0.0, 0.0), panel=thickness.panel,
    )  # fmt: skip


def _inspect(made: dict[str, Solid], kept: list[float]) -> None:
    names = [f"{gap:.2f}" for gap in kept]
    for gap, name in zip(kept, names, strict=True):
        shared = solids.overlap(made["plate"], made[name])
        apart = solids.gap(made["plate"], made[name], 2 * gap)
        if shared > CLASH or apart < GAP_SHARE * gap:
            raise FabricationError(f"the coupon's hinge {name} is only {apart:.3f} mm apart; try another thickness")
    for name, solid in made.items():
        if solids.pieces(solid) != 1:
            raise FabricationError(f"the coupon's body {name} falls apart; try another thickness")


def _body(name: str, solid: Solid, lift: Array) -> Body:
    vertices, faces = solids.mesh(solid)
    none, volume = np.zeros(0, np.int64), float(solid.volume())
    if name == "plate":
        return Body(name, "base", vertices + lift, faces, np.array([0.0, 0.0, 1.0]), volume, none)
    return Body(name, "panel", vertices + lift, faces, np.array([1.0, 0.0, 0.0]), volume, none)
