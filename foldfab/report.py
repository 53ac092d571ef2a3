"""What the command line says about a fold and a print: pure functions from items to text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from foldfab.fabrication.latches import FILAMENT
from foldfab.fabrication.model import AS_READ, LEVEL, Assembly
from foldfab.folding.model import FoldSolution, Modification
from foldfab.geometry.arrays import Array
from foldfab.postures import Row as PostureRow
from foldfab.recipe.hinges import HingeKind
from foldfab.scaffold.directions import title
from foldfab.validity.model import Verdict

WINDOW = 1e-9
"""How far a window may be from [0, 1] and still be the whole width."""
PROVEN = 1e-9
"""A cost that is no further above its bound is the least there is."""
LAYERS = 20
"""A panel is printed in at least that many layers."""
COLUMNS = ("step", "part", "fold", "hinges", "width kept", "cost", "why")
ALTERNATIVES = ("rank", "cost", "no less than", "hinges", "narrowed", "order", "otherwise than the first")

_SCREWED = "drive an {} screw into each hinge until its head is home, then turn it back until the hinge moves freely"
PINNED: Mapping[HingeKind, str] = MappingProxyType(
    {
        "filament": "push 1.75 mm filament through each hinge, cut it 1 mm long and melt its end flat",
        "screw-m2": _SCREWED.format("M2"),
        "screw-m3": _SCREWED.format("M3"),
        "clip": "snap the pins of each hinge into their sockets",
    }
)
"""By kind of hinge, how parts that were printed apart are put together; cones never are."""


def summary(assembly: Assembly, folder: Path, printable: str = "") -> str:
    """What a maker wants to know: what was changed and why, its sizes, how to print it, and how `printable` it is."""
    blocks = [_headline(assembly), _changes(assembly.solution), _figures(assembly), _printing(assembly)]
    blocks += [_findings(assembly), printable, f"Written to {folder}"]
    return "\n\n".join(block for block in blocks if block)


def fold_table(solution: FoldSolution, milliseconds: float) -> str:
    """What is changed in each patch, in folding order, and at which cost."""
    rows = [COLUMNS] + [
        (str(number), *_cells(solution.modification(patch)))
        for number, step in enumerate(solution.steps, 1)
        for patch in step.patches
    ]
    scaffold = solution.scaffold
    total = (
        f"{scaffold.recipe.name} folds along {title(scaffold.direction)}: {_count(len(solution.steps), 'unit')}, "
        f"{_count(len(scaffold.patches), 'foldable patch')}, cost {cost_and_gap(solution)}, "
        f"ordering {scaffold.recipe.fold.ordering}, solved in {milliseconds:.0f} ms"
    )
    return "\n".join([total, "", *aligned(rows), *_notes(solution)])


def fold_facts(solution: FoldSolution, milliseconds: float) -> dict[str, Any]:
    """The same as JSON data, for programs."""
    return {
        "status": "folded",
        "reason": "",
        "name": solution.scaffold.recipe.name,
        "direction": [float(entry) + 0.0 for entry in solution.scaffold.direction],
        "scale": float(solution.scaffold.scale),
        "units": len(solution.steps),
        "foldable_patches": len(solution.scaffold.patches),
        "ordering": solution.scaffold.recipe.fold.ordering,
        "cost": float(solution.cost),
        "lower_bound": float(solution.lower_bound),
        "gap": gap(solution),
        "proven": is_proven(solution),
        "milliseconds": round(milliseconds, 3),
        "order": [{"unit": step.unit, "patches": list(step.patches)} for step in solution.steps],
        "modifications": [_modification(modification) for modification in solution.modifications],
        "notes": list(solution.notes),
    }


def alternatives_table(solutions: Sequence[FoldSolution], milliseconds: float) -> str:
    """One row for each solution, cheapest first, with what it does otherwise than the first."""
    first = solutions[0]
    rows = [ALTERNATIVES]
    for rank, solution in enumerate(solutions, 1):
        kept = [modification for modification in solution.modifications if not modification.is_deleted]
        hinges, narrowed = sum(m.hinges for m in kept), sum(_is_narrowed(m) for m in kept)
        order = ", ".join(step.unit for step in solution.steps)
        cells = (f"{solution.cost:.4f}", f"{solution.lower_bound:.4f}", str(hinges), str(narrowed), order)
        rows.append((str(rank), *cells, "; ".join(_differences(first, solution)) if rank > 1 else ""))
    scaffold = first.scaffold
    total = (
        f"{scaffold.recipe.name} along {title(scaffold.direction)}: {_count(len(solutions), 'fold')}, "
        f"cost {cost_and_gap(first)}, solved in {milliseconds:.0f} ms"
    )
    return "\n".join([total, "", *aligned(rows)])


def alternatives_facts(solutions: Sequence[FoldSolution], milliseconds: float) -> dict[str, Any]:
    """The same as JSON data; each says how long all of them took together."""
    return {"status": "folded", "alternatives": [fold_facts(solution, milliseconds) for solution in solutions]}


def refused_facts(reason: str, advice: Sequence[str] = ()) -> dict[str, Any]:
    """The JSON data of furniture that cannot be folded, and of what would help."""
    return {"status": "refused", "reason": reason, "advice": list(advice)}


def is_proven(solution: FoldSolution) -> bool:
    """Whether no solution over the same options is cheaper."""
    return solution.cost - solution.lower_bound < PROVEN


def gap(solution: FoldSolution) -> float:
    """The share of its cost that a better solution could save at most; 0 where it is proven."""
    return 0.0 if is_proven(solution) else float((solution.cost - solution.lower_bound) / solution.cost)


def cost_and_gap(solution: FoldSolution) -> str:
    """What it costs, and how much less would do at best."""
    if is_proven(solution):
        return f"{solution.cost:.4f}, proven least"
    return f"{solution.cost:.4f}, no less than {solution.lower_bound:.4f} (gap {100 * gap(solution):.1f} %)"


def judgement(verdict: Verdict) -> str:
    """Whether a fold is valid: one line, or one for each violation."""
    if verdict.violations:
        return "\n".join(["not valid", *(f"  {violation.text}" for violation in verdict.violations)])
    closing = _count(verdict.closing, "hinge")
    return f"valid: {verdict.moments} moments, {closing} beyond the spanning tree, with and without thickness"


def verdict_facts(*verdicts: Verdict) -> dict[str, Any]:
    """The same as JSON data, of one or more solutions."""
    told = [
        {
            "kind": violation.kind,
            "model": violation.model,
            "time": violation.time,
            "parts": list(violation.parts),
            "amount": violation.amount,
            "text": violation.text,
        }
        for verdict in verdicts
        for violation in verdict.violations
    ]
    return {"valid": not told, "violations": told}


def change(modification: Modification) -> str:
    """One sentence on what is done to a patch; empty where nothing is."""
    low, high = modification.window
    done = []
    if modification.is_deleted:
        done.append("is taken away")
    else:
        if modification.hinges:
            done.append(f"gets {_count(modification.hinges, 'hinge')}")
        if _is_narrowed(modification):
            done.append(f"is narrowed to {100 * (high - low):.0f} % of its width")
    return f"{modification.patch} {' and '.join(done)} {modification.reason}".strip() if done else ""


def aligned(rows: Iterable[Sequence[str]]) -> list[str]:
    """Rows of cells as lines, every column but the last padded to its widest cell."""
    cells = [tuple(row) for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in cells]


def _is_narrowed(modification: Modification) -> bool:
    low, high = modification.window
    return not modification.is_deleted and high - low < 1 - WINDOW


def _differences(first: FoldSolution, other: FoldSolution) -> list[str]:
    """What is done to a patch in the other solution and not in the first."""
    done = {modification.patch: _done(modification) for modification in first.modifications}
    changed = [(m.patch, _done(m)) for m in other.modifications if done.get(m.patch) != _done(m)]
    return [f"{patch} {how}" for patch, how in changed] or ["the same in another order"]


def _done(modification: Modification) -> str:
    """`in-place, left, 1 hinge, 20 % to 100 %`: all that tells a modification from others of its patch."""
    low, high = modification.window
    hinges = [_count(modification.hinges, "hinge")] if modification.hinges else []
    window = [f"{100 * low:.3g} % to {100 * high:.3g} %"] if _is_narrowed(modification) else []
    return ", ".join([_fold(modification), *hinges, *window])


def _fold(modification: Modification) -> str:
    side = {"l": ", left", "r": ", right", None: ""}[modification.side]
    return modification.mechanism + side


def sizes(assembly: Assembly) -> tuple[Array, Array]:
    """(3,), (3,) mm: width, depth and height of the print along the recipe's axes, open and folded."""
    return _extent(assembly, 0), _extent(assembly, -1)


def _extent(assembly: Assembly, key: int) -> Array:
    poses = {body.name: assembly.poses[body.name][key] for body in assembly.bodies}
    moved = [body.vertices @ poses[body.name][:3, :3].T + poses[body.name][:3, 3] for body in assembly.bodies]
    # The scaffold turned the recipe by `rotation`; rows times the matrix turn it back.
    return np.asarray(np.ptp(np.vstack(moved) @ assembly.solution.scaffold.rotation, axis=0))


def postures_table(rows: Iterable[PostureRow]) -> str:
    """What the slicer says of each posture, side by side."""
    cells: list[Sequence[str]] = [("posture", "time", "filament", "support", "height", "")]
    for row in rows:
        if row.problem:
            cells.append((row.posture, "-", "-", "-", "-", row.problem))
            continue
        notes = [f"{row.files} plates"] * (row.files > 1) + [f"props under {row.propped} parts"] * (row.propped > 0)
        hours = f"{row.seconds / 3600:.1f} h"
        figures = (f"{row.filament_g:.0f} g", f"{row.support_g:.1f} g", f"{row.height_mm:.0f} mm")
        cells.append((row.posture, hours, *figures, ", ".join(notes)))
    return "\n".join(aligned(cells))


def _headline(assembly: Assembly) -> str:
    recipe = assembly.solution.scaffold.recipe
    way = title(assembly.solution.scaffold.direction)
    head = f"{recipe.name}: folds flat along {way} in {_count(len(assembly.solution.steps), 'step')}"
    return "\n".join([head, recipe.about]) if recipe.about else head


def _changes(solution: FoldSolution) -> str:
    told = [text for text in map(change, solution.modifications) if text]
    unchanged = len(solution.modifications) - len(told)
    if unchanged:
        told.append(f"{_count(unchanged, 'other foldable patch' if told else 'foldable patch')} unchanged")
    return "\n".join(["What was changed", *(f"  {text}" for text in told)])


def _figures(assembly: Assembly) -> str:
    opened, folded = sizes(assembly)
    inserted = sum(joint.is_inserted for joint in assembly.hinges)
    scale = assembly.solution.scaffold.scale
    rows = [
        ("open", _size(opened)),
        ("folded", _size(folded)),
        ("space saving", f"{100 * (1 - folded.prod() / opened.prod()):.1f} %"),
        ("hinges", f"{inserted} inserted, {len(assembly.hinges) - inserted} at bases"),
        ("printed bodies", str(len(assembly.bodies))),
        ("scale", f"1:{1 / scale:.3g}" if scale <= 1 else f"{scale:.3g}:1"),
        ("cost", cost_and_gap(assembly.solution)),
    ]
    return "\n".join(["What it is", *(f"  {line}" for line in aligned(rows))])


def _printing(assembly: Assembly) -> str:
    printer = assembly.solution.scaffold.recipe.print.printer
    thickness = assembly.solution.thickness
    volume = " × ".join(f"{side:g}" for side in printer.build_volume)
    lines = [
        f"printer {printer.name} ({volume} mm), posture {assembly.posture}, {_pieces(assembly)}",
        f"plates are {thickness.panel:g} mm thick: use layers of {thickness.panel / LAYERS:.2g} mm or less",
        f"hinges are printed with {thickness.gap:g} mm of clearance: allow no supports in the gaps",
        *_after(assembly),
    ]
    return "\n".join(["How to print it", *(f"  {line}" for line in lines)])


def _pieces(assembly: Assembly) -> str:
    return "in loose parts" if assembly.posture == "plate" else "in one piece"


def _after(assembly: Assembly) -> list[str]:
    """How to treat the print once it is off the bed, and how to hold it open."""
    return [*_unfolding(assembly), *_latching(assembly)]


def _latching(assembly: Assembly) -> list[str]:
    """Which pins to cut, and where they go."""
    latches = [joint.latch for joint in assembly.joints if joint.latch is not None]
    lengths = Counter(f"{latch.length:.1f}" for latch in latches)
    cut = ", ".join(
        f"{count} of {length} mm" for length, count in sorted(lengths.items(), key=lambda row: float(row[0]))
    )
    bases = ", ".join(sorted({latch.base for latch in latches}))
    how = (
        f"to hold it open, cut pins of {FILAMENT:g} mm filament ({cut}) and press each into the groove across the slot "
        f"of a hinge, in the outer faces of {bases}; push them out through the slots from the inner faces to fold it"
    )
    return [how] if latches else []


def _unfolding(assembly: Assembly) -> list[str]:
    """How to get it from the bed and to move it."""
    order = "; then ".join(", ".join(step.patches) for step in assembly.solution.steps)
    if assembly.posture == "plate":
        pins = PINNED[assembly.solution.thickness.hinge]
        seams = ["press the pieces of one part into each other, flat on a table"] if assembly.pieces else []
        return ["give supports where the slicer wants them", *seams, pins, f"fold in this order: {order}"]
    if assembly.posture == "edge":
        props = [f"break the props off {', '.join(b.name for b in assembly.propped)}"] if assembly.propped else []
        return [f"it stands on edge: {_supports(assembly)}", *props, f"unfold it; fold in this order: {order}"]
    if assembly.posture == "folded":
        return ["it lies flat on the bed; unfold it in the reverse of this order", f"fold in this order: {order}"]
    return ["give supports from the bed only, and loosen every hinge gently once", f"fold in this order: {order}"]


def _supports(assembly: Assembly) -> str:
    """Where the slicer has to help on edge."""
    from foldfab.fabrication.inspect import listing
    from foldfab.fabrication.posture import hanging

    air = hanging(assembly)
    level = any(finding.code == LEVEL for finding in assembly.findings)
    where = [f"below {listing(air)}"] * bool(air) + ["below knuckles with flat undersides"] * level
    return f"give supports {' and '.join(where)}, and nowhere else" if where else "allow no supports"


def _findings(assembly: Assembly) -> str:
    # What reading had to suppose was told when the file was read.
    notes = [f"  {finding.text}" for finding in assembly.findings if finding.code != AS_READ]
    return "\n".join(["Worth knowing", *notes]) if notes else ""


def _notes(solution: FoldSolution) -> list[str]:
    return ["", *(f"note: {note}" for note in solution.notes)] if solution.notes else []


def _modification(modification: Modification) -> dict[str, Any]:
    return {
        "patch": modification.patch,
        "mechanism": modification.mechanism,
        "hinges": int(modification.hinges),
        "side": modification.side,
        "window": [float(edge) for edge in modification.window],
        "importance": float(modification.importance),
        "cost": float(modification.cost),
        "reason": modification.reason,
    }


def _cells(modification: Modification) -> tuple[str, ...]:
    low, high = modification.window
    kept = f"{100 * (high - low):.0f} %"
    cost = f"{modification.cost:.4f}"
    return (
        modification.patch,
        _fold(modification),
        str(modification.hinges),
        kept,
        cost,
        modification.reason,
    )


def _size(extent: Array) -> str:
    return " × ".join(f"{side:.1f}" for side in extent) + " mm"


def _count(number: int, noun: str) -> str:
    """`1 hinge`, `2 hinges`, `3 patches`."""
    plural = f"{noun}es" if noun.endswith("ch") else f"{noun}s"
    return f"{number} {noun if number == 1 else plural}"
