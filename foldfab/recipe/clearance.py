"""Which clearance a hinge is printed with where nobody says: by profile, or as a printer was calibrated.

0.3 mm is the safe default for a nozzle of 0.4 mm, 0.2 for a fine one, 0.4 where layers or lines are coarse; slicers
close gaps below 0.1 mm, so 0.15 is the floor. Filaments that string or stay soft need a little more.

Calibrations are kept per printer in `printers.json` in the user's configuration directory
(`$XDG_CONFIG_HOME/foldfab`, or `~/.config/foldfab`).
"""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path
from tempfile import NamedTemporaryFile
from types import MappingProxyType

from foldfab.errors import Problem, RecipeError
from foldfab.recipe.model import Recipe

LEAST, MOST = 0.15, 1.0
"""mm."""
COARSE_LAYER = 0.2
"""Layers above this sag more than a clearance of 0.3 mm forgives, mm."""
_BY_NOZZLE = ((0.3, 0.2), (0.5, 0.3), (float("inf"), 0.4))
"""Up to a nozzle of so much, a clearance of so much, mm."""
_MORE = MappingProxyType({"pla": 0.0, "abs": 0.0, "petg": 0.05, "nylon": 0.05})
"""mm."""


def profile(nozzle: float, layer: float, material: str) -> float:
    """The clearance for a nozzle, a layer height (mm) and a material, mm."""
    fine = next(clearance for widest, clearance in _BY_NOZZLE if nozzle <= widest)
    return round(max(fine, 0.4 if layer > COARSE_LAYER else 0.0) + _MORE[material], 3)


def calibrated(recipe: Recipe) -> Recipe:
    """The recipe with the clearance that its printer was calibrated to, where it asks for none of its own.

    Raises:
        RecipeError: the calibration file cannot be understood.
    """
    if recipe.print.clearance_from != "profile":
        return recipe
    known = calibrations().get(recipe.print.printer.name)
    if known is None:
        return recipe
    return replace(recipe, print=replace(recipe.print, clearance=known, clearance_from="calibration"))


def calibrations() -> dict[str, float]:
    """By printer, the clearance that it was calibrated to, mm; none where there is no file.

    Raises:
        RecipeError: the file is not what `calibrate` writes.
    """
    path = calibration_file()
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return {}
    except (OSError, UnicodeDecodeError) as error:
        raise _broken(path, str(error)) from error
    try:
        entries = json.loads(text)["printers"]
        found = {str(name): float(entry["clearance"]) for name, entry in entries.items()}
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise _broken(path, "is not what foldfab calibrate writes") from error
    if not all(LEAST <= clearance <= MOST for clearance in found.values()):
        raise _broken(path, f"holds a clearance that is not from {LEAST:g} to {MOST:g} mm")
    return found


def calibrate(printer: str, clearance: float) -> Path:
    """Keeps a clearance (mm) for a printer; what is kept for others stays. Returns the file.

    Raises:
        RecipeError: the clearance is out of range, or the file is broken.
        OSError: the file cannot be written; what stood there still stands.
    """
    if not LEAST <= clearance <= MOST:
        text = f"should be from {LEAST:g} to {MOST:g} mm, not {clearance:g}"
        raise RecipeError("command line", (Problem("CLEARANCE", text),))
    kept = {**calibrations(), printer: clearance}
    path = calibration_file()
    path.parent.mkdir(parents=True, exist_ok=True)
    entries = {"printers": {name: {"clearance": kept[name]} for name in sorted(kept)}}
    with NamedTemporaryFile("w", encoding="utf-8", dir=path.parent, suffix=".new", delete=False) as fresh:
        fresh.write(json.dumps(entries, indent=1) + "\n")
    os.replace(fresh.name, path)
    return path


def calibration_file() -> Path:
    """Where calibrations are kept."""
    home = os.environ.get("XDG_CONFIG_HOME") or str(Path.home() / ".config")
    return Path(home) / "foldfab" / "printers.json"


def _broken(path: Path, why: str) -> RecipeError:
    return RecipeError(
        str(path), (Problem("printers", f"{why}; calibrate again after deleting it, or give --clearance"),)
    )
