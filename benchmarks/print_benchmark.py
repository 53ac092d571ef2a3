"""How long a solve and a whole print take, and how much memory; a report for people, never a test.

python benchmarks/print_benchmark.py [RECIPE ...] [--all]

solve    the median of five calls of `foldfab.foldabilize` in this process, ms
print    wall time of `foldfab print` as a process of its own, imports and all, s
memory   its peak resident memory, MB
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time

import foldfab

REPEATS = 5
KILOBYTE = 1 if sys.platform == "darwin" else 1024
"""What the system counts peak memory in, bytes."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recipes", nargs="*", default=["bench"], metavar="RECIPE", help="recipes to measure (bench)")
    parser.add_argument("--all", action="store_true", help="measure all recipes that foldfab ships")
    arguments = parser.parse_args()
    recipes = [str(path) for path in foldfab.shipped()] if arguments.all else arguments.recipes
    print(f"{'recipe':<20} {'solve':>9} {'print':>9} {'memory':>9}")
    for recipe in recipes:
        print(row(recipe), flush=True)
    return 0


def row(recipe: str) -> str:
    """One line of the table; a recipe that fails says so in its line."""
    try:
        furniture = foldfab.load(recipe)
        solve = statistics.median(solve_times(furniture))
    except foldfab.FoldfabError as error:
        return f"{recipe:<20} fails: {str(error).splitlines()[0]}"
    seconds, memory, status = print_cost(recipe)
    told = f"{furniture.name:<20} {solve:>6.0f} ms {seconds:>7.2f} s {memory:>6.0f} MB"
    return told if status == 0 else f"{told}  print fails with status {status}"


def solve_times(furniture: foldfab.pipeline.Recipe) -> list[float]:
    """Milliseconds of each solve."""
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        foldfab.foldabilize(furniture)
        times.append(1000 * (time.perf_counter() - start))
    return times


def print_cost(recipe: str) -> tuple[float, float, int]:
    """Seconds, peak megabytes and exit status of `foldfab print`."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "foldfab.cli", "print", recipe, "-q", "-o", folder]
        start = time.perf_counter()
        # wait4 gives this child's usage alone; getrusage(RUSAGE_CHILDREN) would keep the largest of all so far.
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as child:
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
        return time.perf_counter() - start, usage.ru_maxrss * KILOBYTE / 1e6, child.returncode


if __name__ == "__main__":
    sys.exit(main())
