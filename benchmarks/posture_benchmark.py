"""What printing open, folded, on edge and in loose parts takes by PrusaSlicer, at one scale; a report, never a test.

python benchmarks/posture_benchmark.py [RECIPE ...]

The scale is the largest at which all postures that print in one piece fit the recipe's printer.
"""

from __future__ import annotations

import argparse

from measuring import Column, Table, recipe_files, told

import foldfab
from foldfab.postures import compared

TABLE = Table(
    (
        Column("recipe", 14),
        Column("posture", 8),
        Column("h", 6, ".1f"),
        Column("g", 6, ".0f"),
        Column("support g", 9, ".1f"),
        Column("mm high", 7, ".0f"),
        Column("plates", 6),
    )
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recipes", nargs="*", metavar="RECIPE", help="recipes to measure (all shipped)")
    TABLE.head()
    for file in recipe_files(parser.parse_args().recipes):
        try:
            rows = compared(foldfab.load(str(file)))
        except foldfab.FoldfabError as error:
            TABLE.row(file.stem, note=told(error))
            continue
        for row in rows:
            show(file.stem, row)
    return 0


def show(name: str, row: foldfab.postures.Row) -> None:
    """One line of the table."""
    if row.problem:
        TABLE.row(name, row.posture, note=row.problem)
        return
    note = f"props under {row.propped} parts" if row.propped else ""
    hours = row.seconds / 3600
    TABLE.row(name, row.posture, hours, row.filament_g, row.support_g, row.height_mm, row.files, note=note)


if __name__ == "__main__":
    raise SystemExit(main())
