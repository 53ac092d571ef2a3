"""Running PrusaSlicer: the only place that starts it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from foldfab.errors import MissingLibraryError, SlicingError
from foldfab.recipe.model import Printer
from foldfab.slicing import gcode
from foldfab.slicing.model import MeshInfo, SliceReport
from foldfab.slicing.profile import DENSITY, LAYER_MM, profile

NAMES = ("prusa-slicer", "PrusaSlicer", "prusa-slicer-console")
"""What the program is called on one system or another."""
VARIABLE = "PRUSA_SLICER"
"""The environment variable that names another."""
LONGEST = 1800
"""Seconds after which it is given up; the slowest shipped print takes a minute."""
REPAIRS = ("open_edges", "degenerate_facets", "edges_fixed", "facets_removed", "facets_reversed", "backwards_edges")
"""What `--info` counts, where there is any, of what slicing mends without a word."""
_PROGRESS = re.compile(r"\d+ => |\[[^\]]*\] \[\w+\] \[(trace|debug|info)\]|Slicing result exported|\s*$")
_STABILITY = re.compile(
    r"(print warning: )?Detected print stability issues.*?Consider enabling supports\.?[^\n]*", re.DOTALL
)
"""Later versions look for what floats and say so here; that is no fault, and `printability` tells it too."""


@dataclass(frozen=True, slots=True)
class Sliced:
    """A print file with the G-code that came of it."""

    report: SliceReport
    gcode: str


def find_slicer(wanted: str = "") -> str:
    """The path of PrusaSlicer: `wanted`, or what PRUSA_SLICER names, or what is installed.

    Raises:
        MissingLibraryError: it is not there.
    """
    asked = wanted or os.environ.get(VARIABLE, "")
    found = next((path for name in ([asked] if asked else NAMES) if (path := shutil.which(name))), None)
    if found is None:
        missing = f"{asked} is no program that can be run" if asked else "PrusaSlicer is not installed"
        raise MissingLibraryError(
            f"{missing}; apt-get install prusa-slicer, or name it: --slicer=PATH or {VARIABLE}=PATH"
        )
    return found


def slice_print(file: Path, printer: Printer, *, support: bool, slicer: str = "") -> SliceReport:
    """What PrusaSlicer makes of a 3MF or STL exactly as it lies; with `support`, it adds all that it thinks is needed.

    Raises:
        MissingLibraryError: PrusaSlicer is not there.
        SlicingError: it made no G-code of the file; the message is its own.
    """
    return run(file, printer, support=support, slicer=slicer).report


def run(file: Path, printer: Printer, *, support: bool, slicer: str = "") -> Sliced:
    """The same, with the G-code."""
    program = find_slicer(slicer)
    info = mesh_info(file, program)
    with tempfile.TemporaryDirectory() as folder:
        text, log = _slice(program, Path(file).resolve(), info, profile(printer, support=support), Path(folder))
    return Sliced(_report(text, log, info), text)


def mesh_info(file: Path, program: str) -> MeshInfo:
    """What the slicer says about the mesh before it mends it.

    Raises:
        SlicingError: it cannot read the file.
    """
    log = _call([program, "--info", str(file)])
    found = re.findall(r"^(\w+) =\s+(\S+)", log, re.MULTILINE)
    try:
        low, high = (tuple(_bounds(found, f"{side}_{axis}", side) for axis in "xyz") for side in ("min", "max"))
    except ValueError as error:
        raise SlicingError(f"{Path(file).name}: PrusaSlicer cannot read it: {_last(log)}") from error
    repairs = {name: sum(int(value) for key, value in found if key == name) for name in REPAIRS}
    return MeshInfo(
        low=(low[0], low[1], low[2]),
        high=(high[0], high[1], high[2]),
        is_manifold=all(value == "yes" for key, value in found if key == "manifold"),
        bodies=sum(int(value) for key, value in found if key == "number_of_parts"),
        repairs=tuple((name, count) for name, count in repairs.items() if count),
    )


def _bounds(found: list[tuple[str, str]], name: str, side: str) -> float:
    values = [float(value) for key, value in found if key == name]
    return min(values) if side == "min" else max(values)


def _slice(program: str, file: Path, info: MeshInfo, settings: str, folder: Path) -> tuple[str, str]:
    """G-code and log. The middle that is asked for is the one that it has, so nothing moves."""
    (folder / "settings.ini").write_text(settings, encoding="utf-8")
    x, y = ((info.low[axis] + info.high[axis]) / 2 for axis in (0, 1))
    target = folder / "print.gcode"
    settled = ["--load", str(folder / "settings.ini"), "--datadir", str(folder / "data")]
    placed = ["--dont-arrange", "--no-ensure-on-bed", "--center", f"{x:.6f},{y:.6f}"]
    log = _call([program, "--export-gcode", *settled, *placed, "-o", str(target), str(file)])
    if not target.is_file():
        raise SlicingError(f"{file.name}: PrusaSlicer made no G-code: {_last(log)}")
    return target.read_text(encoding="utf-8", errors="replace"), log


def _call(command: list[str]) -> str:
    try:
        done = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LONGEST, stdin=subprocess.DEVNULL
        )
    except subprocess.TimeoutExpired as error:
        raise SlicingError(f"PrusaSlicer took longer than {LONGEST} s and was given up") from error
    except OSError as error:
        raise MissingLibraryError(f"{command[0]}: cannot be run ({error.strerror})") from error
    return done.stdout.decode("utf-8", "replace")


def _report(text: str, log: str, info: MeshInfo) -> SliceReport:
    length, volume = gcode.figure(text, "filament used [mm]"), gcode.figure(text, "filament used [cm3]")
    tops = gcode.heights(text)
    made_by = re.match(r"; generated by (\S+ \S+)", text)
    return SliceReport(
        slicer=made_by[1] if made_by else "PrusaSlicer",
        seconds=gcode.seconds(text),
        filament_mm=length,
        filament_cm3=volume,
        filament_g=gcode.figure(text, "filament used [g]"),
        support_g=round(gcode.support_mm(text) / length * volume * DENSITY, 2) if length else 0.0,
        height_mm=max(tops, default=0.0),
        layers=len(tops),
        is_manifold=info.is_manifold,
        bodies=info.bodies,
        repairs=info.repairs,
        warnings=warnings(log) + _moved(info, max(tops, default=0.0)),
    )


def _moved(info: MeshInfo, top: float) -> tuple[str, ...]:
    """What lies in the air alone is dropped to the bed without a word; its height tells."""
    if abs(top - info.high[2]) <= LAYER_MM:
        return ()
    return (f"sliced up to {top:.2f} mm, but the print reaches {info.high[2]:.2f} mm: it was moved",)


def warnings(log: str) -> tuple[str, ...]:
    """Every line of a slicer's log that does not merely tell of its progress."""
    return tuple(line.strip() for line in _STABILITY.sub("", log).splitlines() if not _PROGRESS.match(line))


def _last(log: str) -> str:
    said = warnings(log)
    return said[-1] if said else "it does not say why"
