"""How a print stands on the bed, by posture: the turn from the canonical frame, and which end is up.

Open, it is turned about z so that it takes least of the bed. On edge, all hinge axes are vertical, so that every gap is
a sideways gap; this needs parallel axes. Of the two ends, that which leaves fewer bodies in the air is down.
"""

from __future__ import annotations

import numpy as np

from foldfab.errors import FabricationError
from foldfab.fabrication import solids
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.solids import Solid
from foldfab.folding.model import Chain, FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.geometry.rotation import cross
from foldfab.recipe.model import Posture
from foldfab.scaffold.frame import straight
from foldfab.scaffold.model import Scaffold

PARALLEL = 1e-6
"""Sines of angles between hinge axes below this are rounding."""
ON_BED = 0.01
"""A body this close to the bed stands on it, mm."""
HANGS = 0.5
"""A body higher than this over the bed wants something below it, mm."""


def needs_pins(posture: Posture) -> bool:
    """Whether the hinges are put together by hand, because the parts are printed apart."""
    return posture == "plate"


def cuts_parts(solution: FoldSolution, posture: Posture) -> bool:
    """Whether parts longer than the bed are cut: where each is printed for itself, at a scale that was asked for."""
    return needs_pins(posture) and solution.scaffold.recipe.print.scale is not None


def edge_problem(solution: FoldSolution) -> str | None:
    """Why it cannot stand with all hinge axes vertical, or None."""
    if not solution.chains:
        return None
    first = solution.chains[0]
    for chain in solution.chains[1:]:
        if float(np.linalg.norm(np.cross(first.along, chain.along))) > PARALLEL:
            return (
                f"it cannot stand on edge, because the hinges {_hinge(first)} and {_hinge(chain)} are not parallel; "
                "print it open, folded or plate"
            )
    return None


def edge_up(solution: FoldSolution, made: dict[str, Solid], poses: dict[str, Array]) -> Array:
    """(3,) the hinge direction that points up on edge, canonical frame: with the fewest bodies in the air.

    Raises:
        FabricationError: the hinge axes are not all parallel.
    """
    problem = edge_problem(solution)
    if problem is not None:
        raise FabricationError(f"{solution.scaffold.recipe.name}: {problem}")
    along = solution.chains[0].along if solution.chains else np.array([0.0, 1.0, 0.0])
    ends: list[Array] = [along, -along]
    hanging = [_in_the_air(made, poses, end) for end in ends]
    return ends[int(hanging[1] < hanging[0])]


def bed_turn(up: Array | None) -> Array:
    """(3, 3) whose rows are the bed's x, y and z in the canonical frame, for what is folded: lying flat where not `up`.

    On edge, the stack's thickness runs along y.
    """
    if up is None:
        return np.eye(3)
    across = np.array([0.0, 0.0, 1.0])
    return np.stack([cross(across, up), across, up])


def open_turn(scaffold: Scaffold) -> Array:
    """(3, 3) whose rows are the bed's axes in the canonical frame, for what is open: upright as in its file."""
    turn: Array = straight(scaffold.recipe) @ scaffold.rotation.T
    return turn


def printed_pose(assembly: Assembly, name: str) -> Array:
    """(4, 4) where a body stands as it is printed, or assembled where it is printed apart; canonical frame."""
    is_open = assembly.posture in ("open", "plate")
    pose: Array = assembly.poses[name][0 if is_open else -1]
    return pose


def printed_turn(assembly: Assembly) -> Array:
    """(3, 3) rows: the bed's axes in the canonical frame."""
    if assembly.posture == "open":
        return open_turn(assembly.solution.scaffold)
    return bed_turn(assembly.up)


def hanging(assembly: Assembly) -> list[str]:
    """The bodies that begin in the air as they are printed, and have no prop; by name."""
    turn, low = printed_turn(assembly), dict[str, float]()
    for body in assembly.bodies:
        pose = printed_pose(assembly, body.name)
        low[body.name] = float(((body.vertices @ pose[:3, :3].T + pose[:3, 3]) @ turn[2]).min())
    held = {body.name for body in assembly.propped}
    return [name for name, at in low.items() if name not in held and at - min(low.values()) > HANGS]


def _in_the_air(made: dict[str, Solid], poses: dict[str, Array], up: Array) -> tuple[int, float]:
    """How many bodies do not reach the bed, and about what volume there is below them, mm³."""
    reach = {name: solids.mesh(body)[0] @ (poses[name][-1][:3, :3].T @ up) for name, body in made.items()}
    low = {name: float(r.min() + poses[name][-1][:3, 3] @ up) for name, r in reach.items()}
    bed = min(low.values())
    areas = {name: float(body.volume() / np.ptp(reach[name])) for name, body in made.items()}
    hanging = [name for name in sorted(made) if low[name] - bed > ON_BED]
    return len(hanging), round(sum((low[name] - bed) * areas[name] for name in hanging), 1)


def _hinge(chain: Chain) -> str:
    return f"{chain.anchor}~{chain.panels[0]}"
