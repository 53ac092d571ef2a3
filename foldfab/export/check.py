"""`foldfab check`: does a print folder, by its files alone, still print, hinge and fold?"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path

from foldfab.errors import FoldfabError, MissingLibraryError
from foldfab.export.check_motion import check_motion
from foldfab.export.check_slicer import check_slicer
from foldfab.export.check_solids import check_stl, check_threemf
from foldfab.export.check_step import check_step
from foldfab.export.printability import Kind, Mesh, printability, side_by_side
from foldfab.export.read_files import read_threemf
from foldfab.export.report import Report, Row, listed
from foldfab.export.stated import Stated, inside, read_sheet, stated

MORE = ("recipe.json", "preview.png", "printability.json", "printability.txt")
AREAS = 0.01
"""By how much, as a share, areas may be off that are measured from a file."""
COST = 1e-6
"""By how much sums of cost terms and importances may be off."""


def inspect_folder(folder: Path, slicer: str | None = None) -> Report:
    """All checks of a print folder; with the path of a `slicer`, by the printer's own program too.

    Raises:
        PrintFolderError: it has no readable `sheet.json`, so that there is nothing to check against.
        MissingLibraryError: something that checking needs is absent.
    """
    folder = Path(folder)
    sheet = read_sheet(folder)
    try:
        facts = stated(sheet)
    except KeyError as error:
        return Report((Row("sheet", False, f"sheet.json has no field {error}"),))
    except (TypeError, ValueError, AttributeError) as error:
        return Report((Row("sheet", False, f"sheet.json is malformed: {error}"),))
    checks: list[tuple[str, Callable[[], list[Row]]]] = [
        ("files", lambda: check_files(folder, facts)),
        ("stl", lambda: check_stl(folder, facts)),
        ("3mf", lambda: check_threemf(folder, facts)),
        ("printable", lambda: check_printability(folder, facts)),
        ("motion", lambda: check_motion(folder, facts)),
        ("cost", lambda: check_cost(facts)),
        ("step", lambda: check_step(folder, facts)),
    ]
    if slicer is not None:
        checks.append(("slicer", lambda: check_slicer(folder, facts, slicer)))
    return Report(tuple(row for code, check in checks for row in _guarded(code, check)))


def check_files(folder: Path, facts: Stated) -> list[Row]:
    """Every file of a print folder is there, and those that no other check opens can be read."""
    names = [*facts.print_files, f"{facts.name}.glb", *(part.stl for part in facts.parts), *MORE]
    problems = [f"{name} is missing" for name in names if not inside(folder, name).is_file()]
    if not problems:
        if not isinstance(json.loads((folder / "recipe.json").read_text(encoding="utf-8")), dict):
            problems.append("recipe.json holds no JSON object")
        if facts.recipe_sha256 != hashlib.sha256((folder / "recipe.json").read_bytes()).hexdigest():
            problems.append("recipe.json is not the one that the sheet was made from")
        if not _is_whole_png((folder / "preview.png").read_bytes()):
            problems.append("preview.png is cut off, or no PNG")
    return [Row("files", not problems, listed(problems) or f"{len(names) + 1} files")]


def check_printability(folder: Path, facts: Stated) -> list[Row]:
    """No kind of error is found in the print files, and `printability.json` counts what is found."""
    is_loose = facts.posture == "plate"
    plates = [_meshes(inside(folder, name), is_loose=is_loose) for name in facts.print_files]
    found = printability(side_by_side(plates), facts.clearance, facts.propped)
    told = json.loads((folder / "printability.json").read_text(encoding="utf-8"))
    counts = {kind["name"]: kind["count"] for kind in told["kinds"]}
    problems = list(found.errors)
    problems += [
        f"{k.name}: {k.count}, but told are {counts.get(k.name)}" for k in found.kinds if not _agrees(k, counts)
    ]
    notes = ", ".join(f"{kind.name} {kind.count:.0f}" for kind in found.kinds if not kind.is_error and kind.count)
    kinds = {kind.name.replace(" ", "_"): kind.count for kind in found.kinds}
    return [Row("printable", not problems, listed(problems) or f"no errors; notes: {notes or 'none'}", kinds)]


def _agrees(kind: Kind, counts: dict[str, float | None]) -> bool:
    stated = counts.get(kind.name)
    if kind.count is None or stated is None:
        return kind.count is stated
    return abs(stated - kind.count) <= AREAS * kind.count


def _meshes(file: Path, *, is_loose: bool) -> list[Mesh]:
    one = read_threemf(file, is_loose=is_loose)
    return [(name, one.vertices, one.faces[first : last + 1]) for name, first, last in one.volumes]


def check_cost(facts: Stated) -> list[Row]:
    """The cost is the sum of its terms (eq. 1 to 3), and no less than the lower bound."""
    total = 0.0
    for term in facts.terms:
        shrink = 1.0 if term.is_deleted else 1.0 - (term.window[1] - term.window[0])
        hinges = 0.0 if term.is_deleted or term.hinges == 0 else term.hinges / facts.max_hinges
        total += term.importance * (facts.alpha * hinges + (1 - facts.alpha) * shrink**2)
    share = sum(term.importance for term in facts.terms)
    problems = []
    if not abs(total - facts.cost) <= COST:
        problems.append(f"the terms add up to {total:.6f}, the sheet says {facts.cost:.6f}")
    if facts.terms and not abs(share - 1) <= COST:
        problems.append(f"the importances add up to {share:.6f}")
    if not facts.lower_bound <= facts.cost + 1e-9:
        problems.append(f"the lower bound {facts.lower_bound:.6f} exceeds the cost {facts.cost:.6f}")
    return [Row("cost", not problems, listed(problems) or f"{facts.cost:.4f}, proven at least {facts.lower_bound:.4f}")]


def _guarded(code: str, check: Callable[[], list[Row]]) -> list[Row]:
    try:
        return check()
    except FoldfabError:
        raise
    except ImportError as error:
        raise MissingLibraryError(f"checking needs the library {error.name}; pip install {error.name}") from error
    # A damaged file fails in its reader in as many ways as there are readers: each means that the promise is broken.
    except Exception as error:
        what = f"no field {error}" if isinstance(error, KeyError) else str(error).splitlines()[0] if str(error) else ""
        return [Row(code, False, f"cannot be read: {what or type(error).__name__}")]


def _is_whole_png(data: bytes) -> bool:
    return data.startswith(b"\x89PNG\r\n\x1a\n") and data[-8:-4] == b"IEND"
