"""How long each stage of a print takes and how much memory it needs; a report for people, never a test.

python benchmarks/print_benchmark.py [RECIPE ...] [--all]

Each recipe is printed in a process of its own, stage by stage: solve, solids, inspection of the whole fold, writing of
the folder, and the STEP file (build123d's import counted with it, because nobody else asks for it). A cell shows the
stage's process time in seconds and the process's peak resident memory so far in MB. `print` is that of `foldfab
print` from start to end without STEP, imports and all, and `solve` the second of two, so that imports are not counted.
`volumes` is the largest difference between a solid that is read back from the STEP file and the printed one.

Below stands one hinge, the two halves of the first inserted one of the bench, made by the print kernel and by
build123d's own booleans.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from measuring import Column, Table, forget, recipe_files, told

import foldfab
from foldfab.pipeline import prepare

STAGES = ("solve", "solids", "inspection", "writing", "STEP")
KILOBYTE = 1 if sys.platform == "darwin" else 1024
"""What the system counts peak memory in, bytes."""
REPEATS = 5
HINGE = "bench"
"""The recipe whose first inserted hinge is made by both kernels."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recipes", nargs="*", default=["bench"], metavar="RECIPE", help="recipes to measure (bench)")
    parser.add_argument("--all", action="store_true", help="measure all recipes that foldfab ships")
    parser.add_argument("--stages", metavar="RECIPE", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.stages:
        print(json.dumps(staged(arguments.stages)))
        return 0
    columns = [
        Column("recipe", 16),
        Column("bodies", 6),
        *(Column(name, 16) for name in STAGES),
        Column("volumes", 7),
        Column("print", 8),
    ]
    table = Table(tuple(columns))
    table.head()
    for file in recipe_files([] if arguments.all else arguments.recipes):
        table.row(*row(file))
    print()
    hinge_table()
    return 0


def row(file: Path) -> list[object]:
    """The cells of one recipe; a recipe that fails says so in its row."""
    command = [sys.executable, __file__, "--stages", str(file)]
    child = subprocess.run(command, capture_output=True, text=True, encoding="utf-8")
    if child.returncode != 0:
        return [file.stem, None, child.stderr.strip().splitlines()[-1]]
    facts = json.loads(child.stdout)
    if "error" in facts:
        return [file.stem, None, facts["error"]]
    cells = [f"{seconds:.2f} s {memory:5.0f} MB" for seconds, memory in facts["stages"]]
    return [file.stem, facts["bodies"], *cells, f"{facts['off']:.2%}", f"{print_seconds(file):.2f} s"]


def staged(recipe: str) -> dict[str, Any]:
    """Seconds and peak MB of each stage of one print in this process."""
    prepare()
    try:
        furniture = foldfab.load(recipe)
        foldfab.foldabilize(furniture)
        forget()
        solution, *solve = measured(lambda: foldfab.foldabilize(furniture))
        assembly, solids, inspection = built(solution)
        with tempfile.TemporaryDirectory() as folder:
            _, *writing = measured(lambda: foldfab.write(assembly, Path(folder) / "print"))
        from foldfab.export.step import step_bytes

        data, *step = measured(lambda: step_bytes(assembly))
    except foldfab.FoldfabError as error:
        return {"error": told(error)}
    return {
        "bodies": len(assembly.bodies),
        "stages": [solve, solids, inspection, writing, step],
        "off": volumes_off(assembly, data),
    }


def volumes_off(assembly: Any, data: bytes) -> float:
    """Largest share by which a solid of a STEP file differs from the printed one."""
    import build123d as b3d

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "print.step"
        file.write_bytes(data)
        solids = [child for child in b3d.import_step(file).children if child.solids()]
    pairs = zip(solids, assembly.bodies, strict=True)
    return max(abs(solid.volume / body.volume - 1) for solid, body in pairs)


def built(solution: Any) -> tuple[Any, list[float], list[float]]:
    """The assembly of a solution, and what its solids and their inspection took."""
    marks: dict[str, tuple[float, float]] = {}

    def mark(what: str) -> None:
        # What is being done is told from its beginning on.
        marks.setdefault(what.split()[0], (time.process_time(), peak()))

    assembly = foldfab.fabricate(solution, progress=mark)
    mark("done")
    (start, _), (between, made), (end, looked) = (marks[name] for name in ("solids", "inspection", "done"))
    return assembly, [between - start, made], [end - between, looked]


def measured(call: Callable[[], Any]) -> tuple[Any, float, float]:
    """What a call returns, its seconds, and the peak memory of this process after it."""
    start = time.process_time()
    result = call()
    return result, time.process_time() - start, peak()


def peak() -> float:
    """Peak resident memory of this process so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * KILOBYTE / 1e6


def print_seconds(file: Path) -> float:
    """Process time of `foldfab print`, without STEP."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "foldfab.cli", "print", str(file), "-q", "-o", folder]
        before = children_seconds()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env={**os.environ, "PYTHONPATH": path()})
        return children_seconds() - before


def children_seconds() -> float:
    """Process time of all processes that this one has waited for."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def path() -> str:
    """Where this foldfab is imported from, for processes that are to use the same."""
    return os.pathsep.join([str(Path(foldfab.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])


def hinge_table() -> None:
    """One hinge, by either kernel: the median of some cold runs."""
    from foldfab.fabrication.analytic import analytic, require
    from foldfab.fabrication.printed import printed

    assembly = foldfab.fabricate(foldfab.foldabilize(foldfab.load(HINGE)))
    joint = next(joint for joint in assembly.joints if joint.is_inserted)
    halves = [assembly.shapes[name] for name in joint.parts]
    _, start, _ = measured(require)
    table = Table((Column(f"hinge {joint.name}", 26), Column("made in", 9), Column("volume", 14), Column("faces", 7)))
    table.head()
    facets, made = repeated(lambda: [printed(half) for half in halves])
    table.row(
        "manifold3d",
        f"{1000 * made:.1f} ms",
        f"{sum(f.volume() for f in facets):.2f} mm³",
        sum(f.num_tri() for f in facets),
    )
    solids, made = repeated(lambda: [analytic(half) for half in halves])
    note = f"and {start:.1f} s for its import"
    table.row(
        "build123d",
        f"{1000 * made:.1f} ms",
        f"{sum(s.volume for s in solids):.2f} mm³",
        sum(len(s.faces()) for s in solids),
        note=note,
    )


def repeated(call: Callable[[], list[Any]]) -> tuple[list[Any], float]:
    """What a call returns, and the median of its seconds."""
    times = []
    for _ in range(REPEATS):
        result, seconds, _ = measured(call)
        times.append(seconds)
    return result, statistics.median(times)


if __name__ == "__main__":
    sys.exit(main())
