"""Inspection of an assembly by the kernel: what was made, not what was meant.

Watertight and one body a part; no two parts closer than the clearance as printed; no two parts that meet at any
sampled instant of the fold; hinges on their axes; everything fits the bed. A pair is tested again only where its
relative pose has changed, so a fold costs as many booleans as there are moving neighbours.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.lying import lying
from foldfab.fabrication.model import Assembly, Finding
from foldfab.fabrication.passing import STILL
from foldfab.fabrication.posture import cuts_parts, needs_pins, printed_pose, printed_turn
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.turning import PAST, meets, stops_at, turn
from foldfab.folding.kinematics import configuration
from foldfab.geometry.arrays import Array
from foldfab.recipe.hinges import STYLES, HingeKind, hinge_problem

CLASH = 0.01
"""Shared volume below this is rounding, mm³."""
GAP_SHARE = 0.93
"""The least gap as printed, as a share of the clearance; facets take a little."""
FRAMES = 60
"""Equal intervals at whose ends a fold is looked at."""
FRAMES_PER_STEP = 14
"""Instants of each step that are looked at besides."""
PULL_GAPS = 4.0
"""The halves of a hinge must meet before they are pulled this many clearances (or a knuckle's radius) apart."""
HELD = 0.02
"""Halves that share this volume hold each other, mm³."""
TIGHT = 0.1
"""A clearance that always holds, as a share of the plates' thickness."""
MOST_NAMES = 4
"""More hinges than these are counted, not listed."""


def inspect(
    assembly: Assembly,
    made: dict[str, Solid],
    tell: Callable[[float], None],
) -> list[Finding]:
    """All findings about the assembly; fatal where it would not print or not fold."""
    findings = _soundness(made)
    # What is cut is looked at again in pieces.
    findings += [] if cuts_parts(assembly.solution, assembly.posture) else fits(assembly)
    if not any(f.is_fatal for f in findings):
        findings += _gaps(assembly, made)
        findings += _fold(assembly, made, tell)
        findings += _latches(assembly)
        findings += _axes(assembly)
        findings += _stops(assembly, made)
        # A pin that is put in later is not there yet to hold its hinge.
        if not STYLES[assembly.solution.thickness.hinge].has_loose_pin:
            findings += _captive(assembly, made)
    return findings


def extent(assembly: Assembly, *, folded: bool) -> Array:
    """(3,) size of the axis-aligned bounds of all bodies in the recipe's axes, mm."""
    turn = assembly.solution.scaffold.rotation.T
    return _spread(assembly, -1 if folded else 0, turn)


def printed_extent(assembly: Assembly) -> Array:
    """(3,) size on the bed in the posture it is printed in, mm."""
    return _spread(assembly, 0 if assembly.posture == "open" else -1, printed_turn(assembly))


def _spread(assembly: Assembly, key: int, turn: Array) -> Array:
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for body in assembly.bodies:
        pose = assembly.poses[body.name][key]
        points = (body.vertices @ pose[:3, :3].T + pose[:3, 3]) @ turn.T
        low, high = np.minimum(low, points.min(0)), np.maximum(high, points.max(0))
    size: Array = high - low
    return size


def _soundness(made: dict[str, Solid]) -> list[Finding]:
    findings = []
    for name, solid in sorted(made.items()):
        count = solids.pieces(solid)
        if solid.volume() <= 0 or count != 1:
            text = f"{name} falls into {count} bodies; print larger, or with thinner plates"
            findings.append(Finding("body", text, is_fatal=True))
        elif not solids.stays_closed(solid):
            text = f"the mesh of {name} touches itself along an edge; print at a slightly different scale"
            findings.append(Finding("mesh", text, is_fatal=True))
    return findings


def fits(assembly: Assembly) -> list[Finding]:
    """A fatal finding where something is larger than the printer's room."""
    printer = assembly.solution.scaffold.recipe.print.printer
    bed = np.array(printer.build_volume)
    too_large = [(n, s) for n, s in _sizes(assembly) if not ((s <= bed).all() or (s[[1, 0, 2]] <= bed).all())]
    if not too_large:
        return []
    shares = [max(float((bed / s).min()), float((bed / s[[1, 0, 2]]).min())) for _, s in too_large]
    share, (name, size) = min(zip(shares, too_large, strict=True), key=lambda row: row[0])
    told = " x ".join(f"{v:.1f}" for v in size)
    least = assembly.solution.scaffold.scale * min(share, 0.999)
    text = f"{assembly.posture} {name} is {told} mm and does not fit the {printer.name}; "
    text += f"print at scale {least:.4g} or smaller, with --scale fit{_or_in_parts(assembly)}"
    return [Finding("bed", text, is_fatal=True)]


def _or_in_parts(assembly: Assembly) -> str:
    options = assembly.solution.scaffold.recipe.print
    hinge: HingeKind = "filament" if options.hinge == "cone" else options.hinge
    is_able = options.scale is not None and hinge_problem(hinge, options.thickness, "plate") is None
    return ", or with --posture plate, which cuts parts that are longer than the bed" if is_able else ""


def _sizes(assembly: Assembly) -> list[tuple[str, Array]]:
    """(3,) mm of each thing that has to fit the bed, by name."""
    if needs_pins(assembly.posture):
        return [(body.name, np.ptp(lying(body), axis=0)) for body in assembly.bodies]
    return [("it", printed_extent(assembly))]


def _gaps(assembly: Assembly, made: dict[str, Solid]) -> list[Finding]:
    clearance = assembly.solution.thickness.gap
    placed = {n: solids.moved(s, printed_pose(assembly, n)) for n, s in made.items()}
    reach = {n: solids.bounds(s) for n, s in placed.items()}
    findings = []
    for a, b in itertools.combinations(sorted(placed), 2):
        if not _near(reach[a], reach[b], clearance):
            continue
        shared = solids.overlap(placed[a], placed[b])
        if shared > CLASH:
            text = f"{a} and {b} overlap by {shared:.2f} mm³ as printed; print larger, or with thinner plates"
            findings.append(Finding("overlap", text, is_fatal=True))
            continue
        gap = solids.gap(placed[a], placed[b], 2 * clearance)
        if gap < GAP_SHARE * clearance:
            text = f"{a} and {b} are only {gap:.3f} mm apart as printed, less than the clearance of {clearance:g} mm"
            findings.append(Finding("gap", text + "; print larger, or with thinner plates", is_fatal=True))
    return findings


def _fold(assembly: Assembly, made: dict[str, Solid], tell: Callable[[float], None]) -> list[Finding]:
    times = instants(assembly)
    poses = configuration(assembly.solution, times)
    corners = {n: box_corners(*solids.bounds(s)) for n, s in made.items()}
    last: dict[tuple[str, str], Array] = {}
    clashes: dict[tuple[str, str], tuple[float, float]] = {}
    for k, t in enumerate(times):
        tell(k / len(times))
        reach = {n: _reach(corners[n], poses[n][k]) for n in made}
        for a, b in itertools.combinations(sorted(made), 2):
            if not _near(reach[a], reach[b], 0.0):
                continue
            relative = np.linalg.inv(poses[a][k]) @ poses[b][k]
            if (a, b) in last and np.abs(last[a, b] - relative).max() < STILL:
                continue
            last[a, b] = relative
            shared = solids.overlap(made[a], solids.moved(made[b], relative))
            if shared > max(CLASH, clashes.get((a, b), (0.0, 0.0))[0]):
                clashes[a, b] = (shared, float(t))
    return [
        Finding("clash", f"{a} and {b} meet at t = {t:.2f} ({v:.2f} mm³); {_advice(assembly, a, b)}", is_fatal=True)
        for (a, b), (v, t) in sorted(clashes.items())
    ]


def _advice(assembly: Assembly, a: str, b: str) -> str:
    patches = {c.patch for c in assembly.solution.chains for name in (a, b) if name in c.panels}
    if patches:
        return f"allow {' or '.join(sorted(patches))} more shrink steps, or print with thinner plates"
    return "print larger, or with thinner plates"


def _axes(assembly: Assembly) -> list[Finding]:
    """Both halves of every hinge keep the same axis, but for half the clearance."""
    limit = assembly.solution.thickness.gap / 2
    findings = []
    for joint in assembly.joints:
        a, b = (assembly.poses[n] for n in joint.parts)
        ends = [np.einsum("kij,ej->kei", p[:, :3, :3], joint.axis) + p[:, None, :3, 3] for p in (a, b)]
        off = float(np.linalg.norm(ends[0] - ends[1], axis=-1).max())
        if off > limit:
            text = f"{joint.name} would have to give {off:.2f} mm, more than half the clearance"
            findings.append(Finding("axis", text, is_fatal=True))
        elif off > limit / 2:
            findings.append(Finding("play", f"{joint.name} gives {off:.2f} mm of its play while folding"))
    return findings


def _captive(assembly: Assembly, made: dict[str, Solid]) -> list[Finding]:
    """No hinge can be pulled apart; hinges of the same kind, radius and width are tried once, but on edge.

    There, hinges that mirror each other have their ramps at different ends.
    """
    gap = assembly.solution.thickness.gap
    tried: set[tuple[str, bool, float, float]] = set()
    findings = []
    for joint in assembly.joints:
        along = joint.axis[1] - joint.axis[0]
        name = joint.name if assembly.up is not None else ""
        kind = (name, joint.is_inserted, round(joint.radius, 3), round(float(np.linalg.norm(along)), 2))
        if kind in tried:
            continue
        tried.add(kind)
        a, b = (made[name] for name in joint.parts)
        if not is_captive(a, b, joint.axis, joint.radius, gap):
            text = (
                f"{joint.name} can be pulled apart, because a clearance of {gap:g} mm is too much for plates of "
                f"{2 * joint.radius:g} mm; print with a clearance of {TIGHT * 2 * joint.radius:.2f} mm or thicker"
            )
            findings.append(Finding("loose", text, is_fatal=True))
    return findings


def is_captive(a: Solid, b: Solid, axis: Array, radius: float, gap: float) -> bool:
    """Whether the halves of a hinge around an axis (2, 3) meet when they are pulled apart, whichever way."""
    reach = max(PULL_GAPS * gap, radius)
    return all(solids.overlap(a, b.translate((way * reach).tolist())) > HELD for way in _pulls(axis[1] - axis[0]))


def _stops(assembly: Assembly, made: dict[str, Solid]) -> list[Finding]:
    """Every hinge meets material when it is turned on past the ends of its range, both halves alone."""
    free: dict[tuple[str, float | None], list[str]] = {}
    for joint in assembly.joints:
        a, b = joint.parts
        range_ = turn(joint, assembly.poses[a], assembly.poses[b])
        ends = ("straight" if joint.is_inserted else "where it stands open", "where it lies folded")
        for is_folded, end in enumerate(ends):
            if not meets(range_, made[a], made[b], PAST, is_folded=bool(is_folded)):
                angle = stops_at(range_, made[a], made[b], is_folded=bool(is_folded))
                free.setdefault((end, angle), []).append(joint.name)
    return [_unstopped(end, angle, names) for (end, angle), names in free.items()]


def _latches(assembly: Assembly) -> list[Finding]:
    """Base hinges that were to be held open and are not."""
    if not assembly.solution.scaffold.recipe.print.latch:
        return []
    free = [joint.name for joint in assembly.joints if not joint.is_inserted and joint.latch is None]
    advice = "other postures have it" if assembly.posture == "edge" else "wider or thicker parts have it"
    return [Finding("latch", f"no room for a lock pin at {listing(free)}; {advice}")] if free else []


def listing(names: list[str]) -> str:
    """The first few names, and how many more there are."""
    return ", ".join(names[:MOST_NAMES]) + (f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else "")


def _unstopped(end: str, angle: float | None, names: list[str]) -> Finding:
    told = listing(names)
    how_far = "as far as one likes" if angle is None else f"{angle:g}°"
    text = f"no room for a stop within {PAST:g}°: {told} can be turned {how_far} past {end}"
    return Finding("stop", text if angle is None else f"{text}; thicker plates or less clearance would make it less")


def _pulls(along: Array) -> list[Array]:
    """Unit vectors (3,) along an axis both ways, and eight across it."""
    axis = along / np.linalg.norm(along)
    side = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    turns = np.arange(8) * np.pi / 4
    return [axis, -axis, *(np.cos(t) * side + np.sin(t) * other for t in turns)]


def instants(assembly: Assembly) -> Array:
    """(k,) the times at which a fold is looked at."""
    marks = [np.linspace(s.start, s.end, FRAMES_PER_STEP * _sections(s.travel) + 1) for s in assembly.solution.steps]
    found: Array = np.unique(np.concatenate([np.linspace(0.0, 1.0, FRAMES + 1), *marks]))
    return found


def _sections(travel: dict[str, Array]) -> int:
    """How many different base motions a step has: stages of a press, at least one."""
    return max(1, min(4, len({round(float(np.abs(way[-1]).sum()), 3) for way in travel.values()})))


def _near(a: tuple[Array, Array], b: tuple[Array, Array], gap: float) -> bool:
    return bool((a[0] <= b[1] + gap).all() and (b[0] <= a[1] + gap).all())


def box_corners(low: Array, high: Array) -> Array:
    """(8, 3) those of the box between two of them."""
    return np.array(list(itertools.product(*zip(low, high, strict=True))))


def _reach(corners: Array, pose: Array) -> tuple[Array, Array]:
    points = corners @ pose[:3, :3].T + pose[:3, 3]
    return points.min(0), points.max(0)
