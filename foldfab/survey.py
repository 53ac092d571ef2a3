"""The directions that furniture may fold along: as a table for makers, as data for programs, and in pictures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from foldfab.directions import HINGE, Row, Way, lacks, losses
from foldfab.errors import MissingLibraryError
from foldfab.report import aligned

FACTS = "directions.json"
"""The data in the folder, by which it is known for one of ours."""
COLUMNS = ("rank", "direction", "score", "saves", "cost", "hinges", "lost", "flat, mm", "otherwise than the first")


def write(rows: tuple[Row, ...], name: str, folder: Path) -> Path:
    """A picture of each line that folds and the data of all, in a folder, in place of an older one of this kind.

    Raises:
        PrintFolderError: `folder` holds something else, or cannot be written; what stood there still stands.
        MissingLibraryError: Pillow is absent.
    """
    from foldfab.export.swap import replace_folder

    files = _pictures(rows, name) | {FACTS: (json.dumps(facts(rows, name), indent=1) + "\n").encode()}

    def save(fresh: Path) -> None:
        for file, data in files.items():
            (fresh / file).write_bytes(data)

    return replace_folder(folder, save, FACTS)


def table(rows: tuple[Row, ...], name: str) -> str:
    """A row for each line that folds, best first, and why the others do not."""
    folding = [row for row in rows if row.best.solution]
    head = f"{name} folds best along {rows[0].best.name}" if folding else f"{name} folds along no direction"
    blocks = [f"{head}; {2 * len(rows)} directions were tried"]
    if folding:
        cells = [_cells(rank, row, rows[0]) for rank, row in enumerate(folding, 1)]
        blocks += ["\n".join(aligned([COLUMNS, *cells]))]
        blocks += [f"score = space saving - cost - {HINGE:g} a hinge - share of the furniture lost"]
    refused = [(f"  {_told(row)}", row.best.problem) for row in rows if not row.best.solution]
    blocks += ["\n".join(["Nothing folds along", *aligned(refused)])] if refused else []
    return "\n\n".join(blocks)


def facts(rows: tuple[Row, ...], name: str) -> dict[str, Any]:
    """The same as JSON data."""
    folds = bool(rows and rows[0].best.solution)
    return {
        "status": "folded" if folds else "refused",
        "name": name,
        "tried": 2 * len(rows),
        "score": f"space_saving - cost - {HINGE:g} * hinges - lost",
        "directions": [_facts(rank, row, rows[0]) for rank, row in enumerate(rows, 1)],
    }


def picture_name(rank: int | str) -> str:
    """The file of the picture of the line of that rank."""
    return f"direction-{rank}.png"


def _pictures(rows: tuple[Row, ...], name: str) -> dict[str, bytes]:
    try:
        from foldfab.export.boxed import folded_png

        return {
            picture_name(rank): folded_png(row.best.solution, f"{name} along {row.best.name}", _caption(rank, row.best))
            for rank, row in enumerate(rows, 1)
            if row.best.solution
        }
    except ImportError as error:
        raise MissingLibraryError("drawing pictures needs the library Pillow; pip install pillow") from error


def _caption(rank: int, way: Way) -> str:
    facts = [
        f"{rank}.", f"score {way.score:.2f}", f"saves {100 * way.saving:.0f} % of its space", f"cost {way.cost:.2f}",
        f"{way.hinges} hinge{'s' * (way.hinges != 1)} added", f"{_size(way.opened)} to {_size(way.folded)} mm",
    ]  # fmt: skip
    return "   ·   ".join(facts)


def _cells(rank: int, row: Row, first: Row) -> tuple[str, ...]:
    way, figures = row.best, (f"{row.best.score:.2f}", f"{100 * row.best.saving:.0f} %", f"{row.best.cost:.4f}")
    lost = f"{100 * way.lost:.0f} %" if way.lost else "-"
    notes = [losses(way) if row is first else lacks(way, first.best), _other(row)]
    told = "; ".join(note for note in notes if note)
    return (str(rank), _told(row), *figures, str(way.hinges), lost, _size(way.folded), told)


def _told(row: Row) -> str:
    return f"{row.best.name} (faces {row.line.part})" if row.line.part else row.best.name


def _other(row: Row) -> str:
    other = row.other
    if other.solution is None:
        return f"{other.name} does not fold"
    return "" if other.score == row.best.score else f"{other.name} scores {other.score:.2f}"


def _size(extent: tuple[float, ...]) -> str:
    """Longest side first: what lies flat is told from what stands by its last number."""
    return " x ".join(f"{side:.0f}" for side in sorted(extent, reverse=True))


def _facts(rank: int, row: Row, first: Row) -> dict[str, Any]:
    folds = row.best.solution is not None
    return {
        "rank": rank if folds else None,
        **_way(row.best),
        "faces": row.line.part,
        "picture": picture_name(rank) if folds else None,
        "against_first": lacks(row.best, first.best) if folds else "",
        "opposite": _way(row.other),
    }


def _way(way: Way) -> dict[str, Any]:
    told = {"direction": [float(entry) + 0.0 for entry in way.direction], "name": way.name}
    if way.solution is None:
        return told | {"status": "refused", "reason": way.problem}
    return told | {
        "status": "folded",
        "reason": "",
        "score": way.score,
        "space_saving": round(way.saving, 6),
        "cost": round(way.cost, 9),
        "lower_bound": round(way.solution.lower_bound, 9),
        "hinges": way.hinges,
        "lost": round(way.lost, 6),
        "taken_away": list(way.gone),
        "laid_level": list(way.level),
        "units": len(way.solution.steps),
        "foldable_patches": len(way.solution.scaffold.patches),
        "scale": float(way.solution.scaffold.scale),
        "size_open_mm": [round(side, 3) for side in way.opened],
        "size_folded_mm": [round(side, 3) for side in way.folded],
    }
