"""What the solver finds in all recipes along the three axes, and how long it takes; a report for people, never a test.

python benchmarks/solve_benchmark.py [RECIPE ...] [--ordering greedy|optimal|both] [--reference FILE.csv] ...

A RECIPE is a file, a folder of files or the name of a shipped recipe; without any, all shipped ones are solved.

result   folded; deleted: folded with patches taken away (`gone`); refused; crashed; unreadable
units    folding units (section 5.2); patches: foldable patches, those taken away included; hinges: inserted ones
cost     eq. 1; bound: no solution is cheaper; gap: what one could save at most, or `proven`
valid    by `foldfab.verify`: ok or the number of violations, with thickness / without
ms       process time of one cold solve, imports and abstraction not counted; with --repeat the median of several
abstract process time of the abstraction of the same, ms

With --reference, a table with the columns model, axis, result, units, foldable_patches, hinges, cost, ms, the other's
result stands beside each row. ABOVE: units and patches agree, and our cost is higher; MISSED: it folds and we do not.
"""

from __future__ import annotations

import argparse
import csv
import json
import statistics
import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from measuring import Column, Table, clocked, forget, ready, recipe_files, timed, told

import foldfab
import foldfab.fitting
from foldfab.folding.model import FoldSolution
from foldfab.folding.units import decompose
from foldfab.pipeline import compose
from foldfab.recipe.edit import override
from foldfab.recipe.model import Recipe

AXES = ("-x", "-y", "-z")
FOLDS = ("folded", "deleted")
"""The results that are a solution."""
SAME_COST = 5e-5
"""Costs that are closer than this are the same: a reference has them to four digits."""
PROVEN = 1e-9
"""A solution this close to its bound is cheapest but for rounding."""
Other = Mapping[str, str]
"""A row of the reference."""


@dataclass
class Row:
    """What came of one recipe along one axis."""

    model: str
    axis: str
    ordering: str
    result: str
    ms: float | None = None
    abstraction_ms: float | None = None
    deleted: int | None = None
    units: int | None = None
    foldable_patches: int | None = None
    hinges: int | None = None
    cost: float | None = None
    lower_bound: float | None = None
    valid: str | None = None
    reason: str = ""
    """Why it was refused or crashed, or the first thing that is not valid."""

    @property
    def folds(self) -> bool:
        """Whether there is a solution."""
        return self.result in FOLDS

    @property
    def is_proven(self) -> bool:
        """Whether nothing cheaper exists."""
        return self.folds and self.cost - self.lower_bound < PROVEN

    @property
    def gap(self) -> str | None:
        """What a better solution could save at most."""
        if not self.folds:
            return None
        return "proven" if self.is_proven else f"{(self.cost - self.lower_bound) / self.cost:.1%}"


def main() -> int:
    arguments = parsed()
    files = recipe_files(arguments.recipes)
    options = options_of(arguments)
    reference = read_reference(arguments.reference) if arguments.reference else {}
    orderings = ("greedy", "optimal") if arguments.ordering == "both" else (arguments.ordering,)
    ready()
    table = table_for(files, has_reference=bool(reference))
    table.head()
    rows: list[Row] = []
    try:
        for file in files:
            for axis in AXES:
                for ordering in orderings:
                    row = solved(file, axis, ordering, options, arguments.repeat, verify=not arguments.no_verify)
                    before = rows[-1] if ordering != orderings[0] else None
                    show(table, row, reference.get((row.model, row.axis[-1])), before)
                    rows.append(row)
    finally:
        if arguments.json:
            arguments.json.write_text(json.dumps([asdict(row) for row in rows], indent=1) + "\n", encoding="utf-8")
    sums(rows, orderings, reference)
    return 0


def parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recipes", nargs="*", metavar="RECIPE", help="files, folders or shipped recipes (all shipped)")
    parser.add_argument("--ordering", choices=("greedy", "optimal", "both"), default="greedy")
    parser.add_argument("--collisions", choices=("swept", "regions"), help="what makes two options conflict")
    parser.add_argument("--thickness", type=float, metavar="MM", help="thickness of plates and panels in print")
    parser.add_argument("--time-limit", type=float, metavar="S", help="work of the optimal ordering")
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="solves that the median is of (1)")
    parser.add_argument("--no-verify", action="store_true", help="do not verify what was found")
    parser.add_argument("--reference", type=Path, metavar="FILE.csv", help="results of another program to compare with")
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep the rows in this file")
    return parser.parse_args()


def options_of(arguments: argparse.Namespace) -> dict[str, str | float]:
    """What the arguments put over the recipes' own options; ends the program where foldfab does not take it."""
    keys = ("collisions", "thickness", "time_limit")
    options = {key: getattr(arguments, key) for key in keys if getattr(arguments, key) is not None}
    try:
        override(compose("bench", "1x1"), **options)
    except foldfab.FoldfabError as error:
        sys.exit(str(error))
    return options


def solved(
    file: Path, axis: str, ordering: str, options: Mapping[str, str | float], repeat: int, *, verify: bool
) -> Row:
    """What comes of one recipe along one axis, whatever happens."""
    recipe, _ = timed(lambda: foldfab.load(str(file), direction=axis, ordering=ordering, **options))
    if isinstance(recipe, Exception):
        return Row(file.stem, axis, ordering, "unreadable", reason=told(recipe))
    solution, *times = cold_solves(recipe, repeat)
    if isinstance(solution, Exception):
        result = "refused" if isinstance(solution, foldfab.FoldfabError) else "crashed"
        return Row(file.stem, axis, ordering, result, *times, reason=told(solution))
    deleted = sum(m.is_deleted for m in solution.modifications)
    return Row(
        file.stem, axis, ordering, "deleted" if deleted else "folded", *times, deleted,
        len(decompose(solution.scaffold)), len(solution.modifications), sum(m.hinges for m in solution.modifications),
        float(solution.cost), float(solution.lower_bound), *(validity(solution) if verify else ()),
    )  # fmt: skip


def cold_solves(recipe: Recipe, repeat: int) -> tuple[FoldSolution | Exception, float, float]:
    """What a solve returns or raises, and the medians of its process times without abstraction and in that, ms."""
    times, beside = [], []
    for _ in range(max(repeat, 1)):
        forget()
        with clocked(foldfab.fitting, "abstracted") as clock:
            solution, ms = timed(lambda: foldfab.foldabilize(recipe))
        times.append(ms - clock.ms)
        beside.append(clock.ms)
    return solution, statistics.median(times), statistics.median(beside)


def validity(solution: FoldSolution) -> tuple[str, str]:
    """Whether a solution is valid, with thickness / without, and the first thing that is wrong with it."""
    found, _ = timed(lambda: foldfab.verify(solution))
    if isinstance(found, Exception):
        return "crashed", told(found)
    # What concerns both models names neither.
    counts = [sum(v.model in (model, "") for v in found) for model in ("with thickness", "without thickness")]
    return "/".join(str(count) if count else "ok" for count in counts), found[0].text if found else ""


def table_for(files: list[Path], *, has_reference: bool) -> Table:
    columns = [
        Column("recipe", max((len(file.stem) for file in files), default=6)), Column("axis", 4),
        Column("ordering", 8), Column("result", 10), Column("gone", 4), Column("units", 5), Column("patches", 7),
        Column("hinges", 6), Column("cost", 7, ".4f"), Column("bound", 7, ".4f"), Column("gap", 6),
        Column("valid", 7), Column("ms", 7, ".1f"), Column("abstract", 8, ".1f"),
    ]  # fmt: skip
    return Table((*columns, Column("reference", 29)) if has_reference else tuple(columns))


def show(table: Table, row: Row, other: Other | None, before: Row | None) -> None:
    values = [
        row.model, row.axis, row.ordering, row.result, row.deleted or None, row.units, row.foldable_patches,
        row.hinges, row.cost, row.lower_bound, row.gap, row.valid, row.ms, row.abstraction_ms,
    ]  # fmt: skip
    notes = [verdict(row, other), compared(row, before), row.reason]
    table.row(*values, beside(other), note="  ".join(note for note in notes if note))


def read_reference(file: Path) -> dict[tuple[str, str], Other]:
    """The rows of a reference by model and axis."""
    with file.open(encoding="utf-8", newline="") as lines:
        return {(row["model"], row["axis"]): row for row in csv.DictReader(lines)}


def beside(other: Other | None) -> str | None:
    """The reference's result in short: units/patches, hinges, cost."""
    if other is None or other["result"] not in FOLDS:
        return other["result"] if other else None
    return (
        f"{other['result']} {other['units']}/{other['foldable_patches']} {other['hinges']}h {float(other['cost']):.4f}"
    )


def verdict(row: Row, other: Other | None) -> str:
    """How a row stands to the reference: ABOVE, MISSED, `below`, or nothing."""
    if other is None or other["result"] not in FOLDS:
        return ""
    if not row.folds:
        return "MISSED"
    if not is_alike(row, other) or abs(row.cost - float(other["cost"])) <= SAME_COST:
        return ""
    return "ABOVE" if row.cost > float(other["cost"]) else "below"


def is_alike(row: Row, other: Other) -> bool:
    """Whether both see the same number of units and patches."""
    return (str(row.units), str(row.foldable_patches)) == (other["units"], other["foldable_patches"])


def compared(row: Row, before: Row | None) -> str:
    """How the optimal ordering stands to the greedy one."""
    if before is None or (row.folds, row.result, row.deleted) != (before.folds, before.result, before.deleted):
        return f"greedy: {before.result}" if before is not None else ""
    if not row.folds or abs(row.cost - before.cost) <= PROVEN:
        return ""
    return f"{'cheaper' if row.cost < before.cost else 'DEARER'} by {abs(before.cost - row.cost):.4f}"


def sums(rows: list[Row], orderings: tuple[str, ...], reference: Mapping[tuple[str, str], Other]) -> None:
    for ordering in orderings:
        own = [row for row in rows if row.ordering == ordering]
        print(f"\n{ordering}: {len(own)} rows, {counted(Counter(row.result for row in own))}")
        times = [row.ms for row in own if row.ms is not None]
        if times:
            worst = max((row for row in own if row.ms is not None), key=lambda row: row.ms)
            print(f"  median {statistics.median(times):.1f} ms, in all {sum(times) / 1000:.1f} s, ", end="")
            print(f"worst {worst.ms:.0f} ms ({worst.model} {worst.axis})")
        folded = [row for row in own if row.folds]
        invalid = [row for row in folded if row.valid not in (None, "ok/ok")]
        proven = sum(row.is_proven for row in folded)
        print(f"  proven {proven} of {len(folded)}, cost in all {sum(row.cost for row in folded):.4f}, ", end="")
        print(f"not valid {len(invalid)}")
        if reference:
            against(own, reference)
    if len(orderings) == 2:
        savings(rows)


def against(rows: list[Row], reference: Mapping[tuple[str, str], Other]) -> None:
    """The sums of a comparison with the reference."""
    pairs = [(row, reference[row.model, row.axis[-1]]) for row in rows if (row.model, row.axis[-1]) in reference]
    alike = [(row, other) for row, other in pairs if row.folds and other["result"] in FOLDS and is_alike(row, other)]
    found = Counter(verdict(row, other) or "equal" for row, other in alike)
    missed = sum(verdict(row, other) == "MISSED" for row, other in pairs)
    both = sum(row.folds and other["result"] in FOLDS for row, other in pairs)
    ours = sum(row.folds and other["result"] not in FOLDS for row, other in pairs)
    print(
        f"  reference: {len(pairs)} rows in common; both fold {both}, {len(alike)} of them alike in units and patches"
    )
    print(f"  ({counted(found)}); MISSED {missed}; folds here only {ours}")


def savings(rows: list[Row]) -> None:
    """Where the optimal ordering is better than the greedy one, in all."""
    pairs = [(a, b) for a, b in zip(rows[::2], rows[1::2], strict=False) if a.folds and b.folds]
    cheaper = [a.cost - b.cost for a, b in pairs if a.deleted == b.deleted and a.cost - b.cost > PROVEN]
    dearer = sum(b.cost - a.cost > PROVEN for a, b in pairs if a.deleted == b.deleted)
    fewer = sum(b.deleted < a.deleted for a, b in pairs)
    only = sum(b.folds and not a.folds for a, b in zip(rows[::2], rows[1::2], strict=False))
    greedy, proven = sum(a.cost for a, _ in pairs), sum(b.is_proven and not a.is_proven for a, b in pairs)
    share = sum(cheaper) / greedy if greedy else 0.0
    print(
        f"\noptimal against greedy: cheaper {len(cheaper)} of {len(pairs)}, by {sum(cheaper):.4f} in all ({share:.1%})"
    )
    print(f"  dearer {dearer}, fewer deleted {fewer}, folds where greedy does not {only}, proven only now {proven}")


def counted(counter: Counter[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in sorted(counter.items())) or "none"


if __name__ == "__main__":
    sys.exit(main())
