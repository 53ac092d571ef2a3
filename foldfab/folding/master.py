"""The choice of modifications and the order of units as one constraint program (beyond section 5.5).

One Boolean for each option of each patch, exactly one true a patch, and a place in the order for each unit. Options of
one unit that conflict exclude each other whatever the order; all that depends on the order is added as *cuts*, as it is
found by playing choices through. The program is a relaxation throughout, so its optimum is a lower bound on any fold,
and a fold that costs no more is optimal. CP-SAT runs with one worker, a fixed seed and a limit in work and not in time,
so that the same furniture always gets the same answer.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from foldfab.folding.options import Options
from foldfab.geometry.arrays import Array, Bools

if TYPE_CHECKING:
    from ortools.sat.python import cp_model

UNITS_PER_COST = 1e8
"""Costs are rounded to integers of this resolution."""
POSING = 4e-3
"""Charge for handing a program to the engine, s; its deterministic time does not count that."""
READING = 7e-6
"""Charge for each literal of a conflict that it reads, s."""

Order = tuple[str, str]
"""Names of two units: the first one folds before the second."""


@dataclass(frozen=True, slots=True)
class Cut:
    """What must not all be true together."""

    options: tuple[tuple[str, tuple[int, ...]], ...]
    """Patches, each with the options of which one is taken."""
    order: tuple[Order, ...]


@dataclass(frozen=True, slots=True)
class Proposal:
    """The cheapest choice and order that no cut forbids."""

    chosen: Mapping[str, int]
    """By patch, its option."""
    order: tuple[str, ...]
    """Names of the units."""
    bound: float
    """No choice that the cuts allow counts less."""


class Master:
    """The constraint program of some units."""

    def __init__(
        self, units: Mapping[str, tuple[str, ...]], options: Mapping[str, Options],
        tables: Mapping[tuple[str, str], Bools], worth: Mapping[str, Iterable[int]],
    ) -> None:  # fmt: skip
        """
        Args:
            units: by name, the patches of each unit.
            options: by patch.
            tables: by two patches, which of their options exclude each other (n, m).
            worth: by patch, the options that may be taken.
        """
        from ortools.sat.python import cp_model

        self.model = cp_model.CpModel()
        self.worth = {p: sorted(keep) for p, keep in worth.items()}
        self.literals = 0
        self.on = {(p, i): self.model.new_bool_var(f"{p}/{i}") for p, keep in self.worth.items() for i in keep}
        for keep_patch, keep in self.worth.items():
            self.model.add_exactly_one(self.on[keep_patch, i] for i in keep)
        for (p, q), excluded in tables.items():
            self._exclude(p, q, excluded)
        self.names = sorted(units)
        self.place = {n: self.model.new_int_var(0, len(units) - 1, n) for n in self.names}
        self.model.add_all_different(self.place.values())
        self.before: dict[Order, Any] = {}
        terms = [round(float(options[p].weight[i]) * UNITS_PER_COST) * var for (p, i), var in self.on.items()]
        self.model.minimize(sum(terms))
        self.solver: cp_model.CpSolver = cp_model.CpSolver()

    def add(self, cut: Cut) -> None:
        """Forbids what a cut says."""
        terms = [sum(self.on[p, i] for i in many if (p, i) in self.on) for p, many in cut.options]
        terms += [self._is_before(*pair) for pair in cut.order]
        self.model.add(sum(terms) <= len(terms) - 1)

    def one_of(self, ways: list[dict[str, Bools]]) -> None:
        """Demands that all patches take options (n,) of the same one of several ways."""
        chosen = [self.model.new_bool_var(f"way {k}") for k in range(len(ways))]
        if ways:
            self.model.add_exactly_one(chosen)
        for way, literal in zip(ways, chosen, strict=True):
            for p, mask in way.items():
                for i in self.worth[p]:
                    if not mask[i]:
                        self.model.add_implication(self.on[p, i], ~literal)

    def treat_alike(self, p: str, q: str, apart: Bools) -> None:
        """Demands options of two patches that are not apart (n, m)."""
        self._exclude(p, q, apart)

    def at_least(self, terms: Mapping[str, Array], least: float) -> None:
        """Demands that the weights (n,) of the options of some patches add up to no less."""
        every = [
            round(float(weight[i]) * UNITS_PER_COST) * self.on[p, i]
            for p, weight in terms.items()
            for i in self.worth[p]
        ]
        self.model.add(sum(every) >= int(np.floor(least * UNITS_PER_COST)) - len(every))

    def solved(self, work: float, hint: Proposal | None) -> tuple[Proposal | None, float, float]:
        """The best proposal, the lower bound and the work it took; no proposal where there is none within the work."""
        from ortools.sat.python import cp_model

        self.model.clear_hints()  # type: ignore[no-untyped-call]
        for p, i in (hint.chosen if hint else {}).items():
            if (p, i) in self.on:
                self.model.add_hint(self.on[p, i], True)
        for k, name in enumerate(hint.order if hint else ()):
            self.model.add_hint(self.place[name], k)
        self.solver.parameters.num_workers = 1
        self.solver.parameters.random_seed = 0
        # The relaxation of conflicts between pairs is too weak to pay for itself.
        self.solver.parameters.linearization_level = 0
        # Nor does probing: the programs are small, and solved again after every few cuts.
        self.solver.parameters.cp_model_probing_level = 0
        # Nor does presolve where no options exclude each other: it takes longer than all the rest.
        self.solver.parameters.cp_model_presolve = self.literals > 0
        self.solver.parameters.max_deterministic_time = work
        status = self.solver.solve(self.model)
        spent = float(self.solver.response_proto.deterministic_time) + POSING + READING * self.literals
        if status == cp_model.INFEASIBLE:
            return None, np.inf, spent
        bound = float(self.solver.best_objective_bound) / UNITS_PER_COST
        if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            return None, bound, spent
        chosen = {p: i for (p, i), var in self.on.items() if self.solver.value(var)}
        order = tuple(sorted(self.names, key=lambda n: self.solver.value(self.place[n])))
        return Proposal(chosen, order, bound), bound, spent

    def _exclude(self, p: str, q: str, excluded: Bools) -> None:
        columns = np.array(self.worth[q])
        for i in self.worth[p]:
            others = columns[excluded[i, columns]] if len(columns) else columns
            if len(others):
                self.literals += 1 + len(others)
                self.model.add_at_most_one([self.on[p, i], *(self.on[q, int(j)] for j in others)])

    def _is_before(self, first: str, second: str) -> Any:
        """A literal: the first unit folds before the second."""
        if (first, second) not in self.before:
            literal = self.model.new_bool_var(f"{first}<{second}")
            self.model.add(self.place[first] < self.place[second]).only_enforce_if(literal)
            self.model.add(self.place[first] > self.place[second]).only_enforce_if(~literal)
            self.before[first, second], self.before[second, first] = literal, ~literal
        return self.before[first, second]
