"""Four ways to the maximum-weight independent set of section 5.4, on the conflict graphs that really occur.

python benchmarks/mwisp_benchmark.py [RECIPE ...] [--most 40]

Each RECIPE (a file, a folder or a shipped recipe; without any, all shipped ones) is solved along its own direction, and
every call of `foldfab.folding.choose.cheapest` on the way is kept, each graph once. A report for people, never a test.

graphs     how many; options, edges: nodes and conflicts of the largest, the cliques of options of one patch left out
ours       `foldfab.folding.choose.cheapest`: dominance, islands, branch and bound, CP-SAT where that takes too long
CP-SAT     the plain model by ortools: one option a patch, at most one of an option and those it excludes of a patch
HiGHS      the same as an integer program by highspy, where that is installed (`pip install -e '.[benchmark]'`)
networkx   `max_weight_clique` on the complement graph, only where it is small; (n) is how many graphs it has ended on
agree      graphs on which all that were run find the same cost, or all find that there is no choice

Times are medians of process time in ms, from the tables to the answer, one thread each. HiGHS runs in a process of its
own, because ortools brings along another version of its library, and two of them cannot be loaded together.
"""

from __future__ import annotations

import argparse
import signal
import statistics
import sys
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.util import find_spec
from itertools import combinations, product
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
from measuring import Column, Table, ready, recipe_files, timed, told

import foldfab
from foldfab.folding import choose
from foldfab.folding.choose import Combination
from foldfab.geometry.arrays import Array, Bools

SAME = 1e-6
"""Costs that are closer than this are the same: below it lie what integers round and what HiGHS tolerates."""
UNITS_PER_COST = 1e8
"""Costs are integers of this resolution where a solver wants integers."""
SECONDS = 60.0
"""What CP-SAT and HiGHS may take for one graph; what they have by then may not agree."""
NETWORKX_SECONDS = 5.0
"""What networkx may take for one graph, wall time: without conflicts to prune by it is exponential in the patches."""
NOTES = 3
"""What went wrong with one recipe is told up to this many times."""
Picked = tuple[int, ...] | None
"""The option of each group; None where there is no choice."""
Times = Mapping[str, float]
"""By way, ms for one graph."""
Way = Callable[["ConflictGraph"], Picked]
Run = Callable[["ConflictGraph"], tuple[Picked | Exception, float]]
"""A way with its time, ms."""


@dataclass(frozen=True)
class ConflictGraph:
    """What `cheapest` is asked; groups are patches."""

    costs: list[Array]
    conflicts: Mapping[tuple[int, int], Bools]
    forbidden: frozenset[Combination]
    alive: list[Array] = field(init=False)
    """By group, its options of finite cost."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "alive", [np.nonzero(np.isfinite(price))[0] for price in self.costs])

    @property
    def options(self) -> int:
        """How many nodes there are."""
        return sum(map(len, self.alive))

    @property
    def edges(self) -> int:
        """How many pairs of options of different patches exclude each other."""
        return sum(int(m[np.ix_(self.alive[g], self.alive[h])].sum()) for (g, h), m in self.conflicts.items())

    def nodes(self) -> list[tuple[int, int]]:
        """All options as (group, option)."""
        return [(g, int(o)) for g, own in enumerate(self.alive) for o in own]

    def cliques(self) -> Iterator[list[tuple[int, int]]]:
        """An option and all those of one other group that it excludes, for each that excludes any."""
        for (g, h), excluded in sorted(self.conflicts.items(), key=lambda item: item[0]):
            for o in self.alive[g]:
                others = [int(p) for p in self.alive[h] if excluded[o, p]]
                if others:
                    yield [(g, int(o)), *((h, p) for p in others)]

    def cost(self, picked: Picked) -> float:
        """What a choice costs; infinite where there is none."""
        return np.inf if picked is None else float(sum(c[o] for c, o in zip(self.costs, picked, strict=True)))

    def holds(self, picked: Picked) -> bool:
        """Whether a choice is free of conflicts."""
        if picked is None:
            return True
        clear = not any(m[picked[g], picked[h]] for (g, h), m in self.conflicts.items())
        return clear and not any(all(picked[g] in held for g, held in many) for many in self.forbidden)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recipes", nargs="*", metavar="RECIPE", help="files, folders or shipped recipes (all shipped)")
    parser.add_argument(
        "--most", type=int, default=40, metavar="N", help="graphs of one recipe, from small to large (40)"
    )
    parser.add_argument(
        "--networkx", type=int, default=300, metavar="N", help="options up to which networkx is run (300)"
    )
    parser.add_argument("--ordering", choices=("greedy", "optimal"), help="instead of the recipe's own")
    arguments = parser.parse_args()
    ready()
    ways = {name: way for name, way in WAYS.items() if name != "HiGHS" or find_spec("highspy") is not None}
    if len(ways) < len(WAYS):
        print("highspy is not installed: no HiGHS; pip install -e '.[benchmark]'\n")
    files = recipe_files(arguments.recipes)
    table = Table(
        (
            Column("recipe", max((len(file.stem) for file in files), default=6)), Column("graphs", 9),
            Column("options", 7), Column("edges", 7), *(Column(name, 16) for name in ways), Column("agree", 7),
        )
    )  # fmt: skip
    table.head()
    every: list[Times] = []
    with apart() as elsewhere:
        run = {name: elsewhere(way) if name == "HiGHS" else here(way) for name, way in ways.items()}
        for file in files:
            every += compared(table, file, run, arguments)
    print()
    table.row("in all", len(every), None, None, *(median(every, name) for name in ways))
    table.row("worst", None, None, None, *(worst(every, name) for name in ways))
    return 0


def compared(table: Table, file: Path, ways: Mapping[str, Run], arguments: argparse.Namespace) -> list[Times]:
    """One row; the times of each of its graphs by way, ms."""
    graphs, error = collected(file, arguments.ordering)
    if not graphs:
        table.row(file.stem, 0, note=error)
        return []
    graphs.sort(key=lambda graph: graph.options)
    chosen = graphs
    if len(graphs) > arguments.most:
        chosen = [graphs[int(i)] for i in np.linspace(0, len(graphs) - 1, arguments.most).round()]
    times: list[Times] = []
    agree, notes = 0, [error]
    for graph in chosen:
        spent, costs = {}, {}
        for name, way in ways.items():
            if name == "networkx" and (graph.options > arguments.networkx or graph.forbidden):
                continue
            picked, ms = way(graph)
            if name == "networkx" and isinstance(picked, TimeoutError):
                continue
            spent[name] = ms
            if isinstance(picked, Exception):
                notes.append(f"{name}: {told(picked)}")
            elif not graph.holds(picked):
                notes.append(f"{name}: a choice with conflicts")
            else:
                costs[name] = graph.cost(picked)
        is_same = len(costs) == len(spent) and differ(costs) <= SAME
        agree += is_same
        if not is_same:
            notes.append(f"{graph.options} options: {', '.join(f'{n} {c:.7f}' for n, c in costs.items())}")
        times.append(spent)
    shown = f"{len(chosen)} of {len(graphs)}" if len(chosen) < len(graphs) else str(len(graphs))
    values = [median(times, name) for name in ways]
    table.row(
        file.stem, shown, graphs[-1].options, graphs[-1].edges, *values, f"{agree}/{len(chosen)}",
        note="; ".join([*dict.fromkeys(note for note in notes if note)][:NOTES]),
    )  # fmt: skip
    return times


def differ(costs: Mapping[str, float]) -> float:
    """By how much the costs differ at most; nothing where all are infinite."""
    values = list(costs.values())
    return 0.0 if np.isinf(values).all() else max(values) - min(values)


def median(times: list[Times], name: str) -> str | None:
    """The median of one way's times, ms, and of how many graphs where not all were tried."""
    own = [spent[name] for spent in times if name in spent]
    if not own:
        return None
    return f"{statistics.median(own):.2f}" + (f" ({len(own)})" if len(own) < len(times) else "")


def worst(times: list[Times], name: str) -> str | None:
    return f"{max(own):.2f}" if (own := [spent[name] for spent in times if name in spent]) else None


def collected(file: Path, ordering: str | None) -> tuple[list[ConflictGraph], str]:
    """The conflict graphs of one solve, each once, and what went wrong."""
    with kept() as graphs:
        result, _ = timed(lambda: foldfab.foldabilize(foldfab.load(str(file), ordering=ordering)))
    return list(graphs.values()), told(result) if isinstance(result, Exception) else ""


@contextmanager
def kept() -> Iterator[dict[object, ConflictGraph]]:
    """What `cheapest` is asked meanwhile, by all that it depends on."""
    graphs: dict[object, ConflictGraph] = {}
    own = choose.cheapest

    def keeping(
        costs: list[Array], conflicts: Mapping[tuple[int, int], Bools],
        forbidden: frozenset[Combination] = frozenset(), *rest: Any, **more: Any,
    ) -> Picked:  # fmt: skip
        tables = tuple((pair, conflicts[pair].tobytes()) for pair in sorted(conflicts))
        key = (tuple(price.tobytes() for price in costs), tables, forbidden)
        if key not in graphs:
            copied = {pair: excluded.copy() for pair, excluded in conflicts.items()}
            graphs[key] = ConflictGraph([price.copy() for price in costs], copied, forbidden)
        return own(costs, conflicts, forbidden, *rest, **more)

    # Wherever it was imported to.
    users = [module for name, module in sys.modules.items() if name.startswith("foldfab.")]
    users = [module for module in users if vars(module).get("cheapest") is own]
    for module in users:
        module.cheapest = keeping
    try:
        yield graphs
    finally:
        for module in users:
            module.cheapest = own


def here(way: Way) -> Run:
    return lambda graph: timed(lambda: way(graph))


@contextmanager
def apart() -> Iterator[Callable[[Way], Run]]:
    """Runs ways in a fresh process, which measures them itself; it is not started before it is needed."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        yield lambda way: lambda graph: pool.submit(measured, way, graph).result()


def measured(way: Way, graph: ConflictGraph) -> tuple[Picked | Exception, float]:
    return here(way)(graph)


def ours(graph: ConflictGraph) -> Picked:
    return choose.cheapest(graph.costs, graph.conflicts, graph.forbidden)


def by_cp_sat(graph: ConflictGraph) -> Picked:
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    on = {node: model.new_bool_var("") for node in graph.nodes()}
    for g, own in enumerate(graph.alive):
        model.add_exactly_one(on[g, int(o)] for o in own)
    for clique in graph.cliques():
        model.add_at_most_one(on[node] for node in clique)
    for many in graph.forbidden:
        model.add(sum(sum(on[g, o] for o in held if (g, o) in on) for g, held in many) <= len(many) - 1)
    model.minimize(sum(round(float(graph.costs[g][o]) * UNITS_PER_COST) * var for (g, o), var in on.items()))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.max_time_in_seconds = SECONDS
    if solver.solve(model) not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return None
    return tuple(next(int(o) for o in own if solver.value(on[g, int(o)])) for g, own in enumerate(graph.alive))


def by_highs(graph: ConflictGraph) -> Picked:
    import highspy

    if any(len(own) == 0 for own in graph.alive):
        return None
    nodes = graph.nodes()
    place = {node: i for i, node in enumerate(nodes)}
    exact = [[place[g, int(o)] for o in own] for g, own in enumerate(graph.alive)]
    most = [[place[node] for node in clique] for clique in graph.cliques()]
    never = [[place[g, o] for g, held in many for o in held if (g, o) in place] for many in graph.forbidden]
    rows = [*exact, *most, *never]
    program = highspy.HighsLp()
    program.num_col_, program.num_row_ = len(nodes), len(rows)
    program.col_cost_ = np.array([graph.costs[g][o] for g, o in nodes])
    program.col_lower_, program.col_upper_ = np.zeros(len(nodes)), np.ones(len(nodes))
    program.row_lower_ = np.array([1.0] * len(exact) + [-highspy.kHighsInf] * (len(most) + len(never)))
    program.row_upper_ = np.array([1.0] * (len(exact) + len(most)) + [len(many) - 1.0 for many in graph.forbidden])
    program.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    program.a_matrix_.start_ = np.cumsum([0, *map(len, rows)])
    program.a_matrix_.index_ = np.concatenate([np.array(row) for row in rows])
    program.a_matrix_.value_ = np.ones(len(program.a_matrix_.index_))
    program.integrality_ = [highspy.HighsVarType.kInteger] * len(nodes)
    solver = highspy.Highs()
    solver.silent()
    given = {"threads": 1, "time_limit": SECONDS, "mip_rel_gap": 0.0, "mip_abs_gap": SAME / 10}
    for option, value in given.items():
        solver.setOptionValue(option, value)
    solver.passModel(program)
    solver.run()
    if solver.getInfo().primal_solution_status != highspy.SolutionStatus.kSolutionStatusFeasible:
        return None
    value = np.array(solver.getSolution().col_value)
    return tuple(nodes[max(own, key=lambda i: value[i])][1] for own in exact)


def by_networkx(graph: ConflictGraph) -> Picked:
    """Any option more outweighs all costs, so the heaviest clique has one of each group where that is possible."""
    nodes = graph.nodes()
    free: nx.Graph[tuple[int, int]] = nx.Graph()
    dearest = 1 + sum(round(UNITS_PER_COST * float(graph.costs[g][own].max())) for g, own in enumerate(graph.alive))
    for g, o in nodes:
        free.add_node((g, o), weight=dearest - round(UNITS_PER_COST * float(graph.costs[g][o])))
    for g, h in combinations(range(len(graph.costs)), 2):
        excluded = graph.conflicts.get((g, h))
        pairs = product(graph.alive[g], graph.alive[h])
        free.add_edges_from(((g, int(o)), (h, int(p))) for o, p in pairs if excluded is None or not excluded[o, p])
    with limited(NETWORKX_SECONDS):
        found = dict(nx.max_weight_clique(free)[0])
    return tuple(found[g] for g in range(len(graph.costs))) if len(found) == len(graph.costs) else None


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Ends Python code that takes longer with a TimeoutError."""

    def end(_signal: int, _frame: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


WAYS: Mapping[str, Way] = {
    "ours": ours,
    "CP-SAT": by_cp_sat,
    "HiGHS": by_highs,
    "networkx": by_networkx,
}


if __name__ == "__main__":
    sys.exit(main())
