"""Parts that are longer than the bed become pieces with joints between them, where the maker asked for a scale.

The fold was inspected with whole parts, and pieces of a part never move against each other; so what is looked at here
are the pieces for themselves: each sound, each on the bed, the seams a fit apart and not to be pulled open.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.bodies import body
from foldfab.fabrication.cutting import ROOM, Key, Piece, Stock, cut_up, ideals, ways
from foldfab.fabrication.hinges import Mark, knuckles
from foldfab.fabrication.inspect import HELD, fits
from foldfab.fabrication.lying import laid
from foldfab.fabrication.model import Assembly, Body, Finding, Joint, Seam
from foldfab.fabrication.posture import cuts_parts
from foldfab.fabrication.room import footprint
from foldfab.fabrication.seams import fit_of
from foldfab.fabrication.shapes import Shape
from foldfab.fabrication.soles import PIECE, eased
from foldfab.fabrication.solids import Solid
from foldfab.folding.basic import holds
from foldfab.folding.model import Chain, FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Posture

PULL_FITS = 3.0
"""Pieces must meet before they are pulled so many fits apart."""
ROUNDING = 0.01
"""By how much a gap may be off, mm."""
STRAIGHT = 1 - 1e-9
"""Cosine above which a hinge runs along an axis of the bed."""
PROBE = 0.1
"""Half the side of the cube that looks for a piece, mm."""

Marks = dict[str, tuple[tuple[Mark, ...], tuple[Mark, ...]]]
"""By hinge, the knuckles of the first and of the second of its parts, from where to where along its axis, mm."""


def with_breaks(solution: FoldSolution, posture: Posture) -> FoldSolution:
    """The solution with a stretch free of knuckles in all hinges of a patch where its panels will have to be cut."""
    if not cuts_parts(solution, posture):
        return solution
    return replace(solution, chains=tuple(_with_breaks(solution, c) for c in solution.chains))


def _with_breaks(solution: FoldSolution, chain: Chain) -> Chain:
    """A chain with more breaks in its hinges, as long as each still has a stretch that holds it."""
    marks = sorted([*chain.breaks, *_breaks(solution, chain)])
    made = replace(chain, breaks=tuple(_joined(marks)))
    return made if not chain.breaks or holds(made, solution.thickness) else chain


def _breaks(solution: FoldSolution, chain: Chain) -> tuple[Mark, ...]:
    """Where the panels of a chain, and the bases that it stands on, would best be cut."""
    x, y, _ = solution.scaffold.recipe.print.printer.build_volume
    low, high = (float(end) for end in chain.span)
    middles = set[float]()
    for length in chain.lengths:
        middles |= _lines((low, high), float(length) + 2 * chain.panel, (x, y))
    for base in solution.scaffold.bases:
        axis = int(np.argmax(np.abs(chain.along)))
        if base.name in chain.bodies and abs(chain.along[axis]) > STRAIGHT:
            least, most = footprint(base, solution.thickness)
            lines = _lines((float(least[axis]), float(most[axis])), float((most - least)[1 - axis]), (x, y))
            middles |= {(line - float(chain.root[axis])) * float(chain.along[axis]) for line in lines}
    wanted = [mark for mark in _merged(middles) if mark[0] < high and low < mark[1]]
    return tuple(wanted)


def _lines(reach: Mark, width: float, bed: tuple[float, float]) -> set[float]:
    """Across a part that reaches so far along the hinges and is so wide, in the way with the fewest pieces."""
    able = ways((reach[1] - reach[0], width), bed)
    return {line for side, limits in able[:1] for line in ideals(*reach, limits[0])} if able else set()


def _merged(middles: set[float]) -> list[Mark]:
    return _joined([(middle - ROOM, middle + ROOM) for middle in sorted(middles)])


def _joined(marks: list[Mark]) -> list[Mark]:
    """Stretches in ascending order, those that overlap as one."""
    found: list[Mark] = []
    for mark in marks:
        if found and mark[0] <= found[-1][1]:
            first = found.pop()
            mark = (first[0], max(first[1], mark[1]))
        found.append(mark)
    return found


def cut_to_bed(assembly: Assembly, made: dict[str, Solid]) -> tuple[Assembly, list[Finding]]:
    """The assembly with pieces in the place of parts that are longer than the bed, and what there is to say of them.

    Raises:
        FabricationError: such a part can be cut nowhere.
    """
    if not cuts_parts(assembly.solution, assembly.posture):
        return assembly, []
    marks = _marks(assembly)
    x, y, _ = assembly.solution.scaffold.recipe.print.printer.build_volume
    fit = fit_of(assembly.solution.thickness.gap)
    cut: dict[str, dict[str, Piece]] = {}
    seams: list[Joint] = []
    for one in assembly.bodies:
        stock = Stock(one.name, (x, y), fit, laid(one), tuple(_taken(assembly, marks, one.name)))
        whole = Piece(made[one.name], assembly.shapes[one.name])
        if not stock.fits(whole):
            pieces, keys = cut_up(whole, stock)
            cut[one.name] = {f"{one.name}{PIECE}{i}": piece for i, piece in enumerate(pieces, 1)}
            seams += _seams(cut[one.name], keys, fit)
    solid_of, shapes = _eased(assembly, made, cut)
    if not cut:
        done = replace(assembly, bodies=_bodies(assembly, solid_of, cut), shapes=shapes)
        return done, fits(done)
    joints = [part for joint in assembly.joints for part in _shared(joint, marks[joint.name], cut, solid_of)]
    done = replace(
        assembly,
        bodies=_bodies(assembly, solid_of, cut),
        joints=tuple(sorted([*joints, *seams], key=lambda joint: joint.name)),
        poses=assembly.poses | {n: assembly.poses[part] for part, pieces in cut.items() for n in pieces},
        shapes=assembly.shapes | shapes,
        pieces={part: tuple(pieces) for part, pieces in cut.items()},
    )
    return done, [*fits(done), *_hold(done, solid_of), *_told(done, fit)]


def _eased(
    assembly: Assembly, made: dict[str, Solid], cut: dict[str, dict[str, Piece]]
) -> tuple[dict[str, Solid], dict[str, Shape]]:
    """All whole parts and pieces, with their edges on the bed drawn in."""
    pieces = {name: piece for some in cut.values() for name, piece in some.items()}
    solid_of = {name: solid for name, solid in made.items() if name not in cut}
    solid_of |= {name: piece.solid for name, piece in pieces.items()}
    shapes = {name: pieces[name].shape if name in pieces else assembly.shapes[name] for name in solid_of}
    return eased(assembly, _bodies(assembly, solid_of, cut), solid_of, shapes)


def _bodies(assembly: Assembly, solid_of: dict[str, Solid], cut: dict[str, dict[str, Piece]]) -> tuple[Body, ...]:
    part_of = {name: part for part, pieces in cut.items() for name in pieces}
    return tuple(body(assembly.solution, n, part_of.get(n, n), solid_of[n]) for n in sorted(solid_of))


def _marks(assembly: Assembly) -> Marks:
    found: Marks = {}
    for chain in assembly.solution.chains:
        thickness = assembly.solution.thickness.of(chain.panel)
        for hinge, pair in enumerate(pairwise(chain.bodies)):
            own, start = knuckles(chain.hinge_spans[hinge], thickness, chain.breaks), float(chain.hinge_spans[hinge][0])
            carrier, follower = (tuple((a - start, b - start) for a, b in m) for m in (own.carrier, own.follower))
            # Bases carry, and of two panels the earlier one does.
            is_far = hinge == len(chain.lengths)
            found["~".join(pair)] = (follower, carrier) if is_far else (carrier, follower)
    return found


def _taken(assembly: Assembly, marks: Marks, part: str) -> list[Array]:
    """(8, 3) corners of each knuckle of a part."""
    found = []
    for joint in assembly.joints:
        if part in joint.parts:
            along = _along(joint)
            side = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
            side /= np.linalg.norm(side)
            ring = joint.radius * np.array([a * side + b * np.cross(along, side) for a in (-1, 1) for b in (-1, 1)])
            for mark in marks[joint.name][joint.parts.index(part)]:
                found.append(np.concatenate([joint.axis[0] + along * end + ring for end in mark]))
    return found


def _along(joint: Joint) -> Array:
    along: Array = joint.axis[1] - joint.axis[0]
    return along / np.linalg.norm(along)


def _seams(pieces: dict[str, Piece], keys: list[Key], fit: float) -> list[Joint]:
    """A joint for each two pieces that tongues hold together."""
    solid_of = {name: piece.solid for name, piece in pieces.items()}
    held: dict[tuple[str, str], list[Key]] = {}
    for key in keys:
        pair = _owner(solid_of, key.inside, PROBE), _owner(solid_of, key.beyond, PROBE)
        held.setdefault(pair, []).append(key)
    found = []
    for pair, own in sorted(held.items()):
        x, y, z = own[0].pull.tolist()
        seam = Seam("dovetail" if all(k.kind == "dovetail" for k in own) else "splice", len(own), fit, (x, y, z))
        found.append(Joint("~".join(pair), pair, own[0].line, own[0].half, (0.0, 0.0), False, seam=seam))
    return found


def _owner(solid_of: dict[str, Solid], point: Array, half: float) -> str:
    """The solid that has most of a cube around a point."""
    cube = solids.box(point - half, point + half)
    return max(sorted(solid_of), key=lambda name: solids.overlap(solid_of[name], cube))


def _shared(
    joint: Joint, marks: tuple[tuple[Mark, ...], tuple[Mark, ...]], cut: dict[str, dict[str, Piece]],
    solid_of: dict[str, Solid],
) -> list[Joint]:  # fmt: skip
    """A hinge as those of its pieces share it whose knuckles are neighbours on its axis."""
    if not set(joint.parts) & set(cut):
        return [joint]
    along, row = _along(joint), list[tuple[Mark, int, str]]()
    for side, part in enumerate(joint.parts):
        candidates = {name: solid_of[name] for name in cut.get(part, {part: None})}
        for mark in marks[side]:
            middle = joint.axis[0] + along * sum(mark) / 2
            row.append((mark, side, _owner(candidates, middle, joint.radius)))
    found: dict[tuple[str, str], list[float]] = {}
    for (one, side, name), (two, other, neighbour) in pairwise(sorted(row)):
        if side != other:
            pair = (name, neighbour) if side == 0 else (neighbour, name)
            found.setdefault(pair, []).extend([*one, *two])
    shared = []
    for pair, reach in sorted(found.items()):
        axis = joint.axis[0] + along * np.array([[min(reach)], [max(reach)]])
        shared.append(replace(joint, name="~".join(pair), parts=pair, axis=axis))
    return shared


def _hold(assembly: Assembly, solid_of: dict[str, Solid]) -> list[Finding]:
    """Seams that are not as they should be: too narrow, too wide, open, or missing."""
    findings = []
    for joint in assembly.joints:
        if joint.seam is not None:
            a, b = (solid_of[name] for name in joint.parts)
            gap, pull = solids.gap(a, b, 2 * joint.seam.fit), PULL_FITS * joint.seam.fit * np.array(joint.seam.pull)
            if abs(gap - joint.seam.fit) > ROUNDING or solids.overlap(a, b.translate(pull.tolist())) < HELD:
                text = f"the seam {joint.name} does not hold ({gap:.3f} mm apart); print at a slightly different scale"
                findings.append(Finding("seam", text, is_fatal=True))
    for part, pieces in assembly.pieces.items():
        if len(_hanging_together(pieces, assembly.joints)) < len(pieces):
            text = f"the pieces of {part} do not hang together; print at a slightly different scale"
            findings.append(Finding("seam", text, is_fatal=True))
    return findings


def _hanging_together(pieces: tuple[str, ...], joints: tuple[Joint, ...]) -> set[str]:
    """The pieces of a part that seams tie to its first one."""
    pairs = [set(j.parts) for j in joints if j.seam is not None and set(j.parts) <= set(pieces)]
    reached = {pieces[0]}
    while more := set().union(*(pair for pair in pairs if pair & reached)) - reached:
        reached |= more
    return reached


def _told(assembly: Assembly, fit: float) -> list[Finding]:
    found = []
    for part, pieces in sorted(assembly.pieces.items()):
        own = [j.seam for j in assembly.joints if j.seam is not None and set(j.parts) <= set(pieces)]
        count = Counter[str]()
        for seam in own:
            count[seam.kind] += seam.keys
        joined = " and ".join(f"{n} {kind}{'s' * (n > 1)}" for kind, n in sorted(count.items()))
        text = f"{part} is longer than the bed: {len(pieces)} pieces, joined by {joined} with a gap of {fit:g} mm"
        found.append(Finding("cut", text + ("; splices want glue" if count["splice"] else "")))
    return found
