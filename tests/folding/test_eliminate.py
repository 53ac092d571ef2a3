"""Elimination equals branch and bound."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.folding import choose, eliminate
from foldfab.folding.choose import cheapest
from foldfab.geometry.arrays import Array, Bools


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 9), st.booleans())
def test_it_finds_what_branch_and_bound_finds(seed: int, count: int, is_ring: bool) -> None:
    random = np.random.default_rng(seed)
    costs, table = _graph(random, count, is_ring=is_ring)
    alive = {g: np.isfinite(price) for g, price in enumerate(costs)}
    found = eliminate.eliminated(alive, costs, table)
    pairs = {(g, h): m for g, row in enumerate(table) for h, m in row.items() if g < h}
    known = cheapest(costs, pairs)
    if known is None:
        assert found is None
    else:
        assert found is not None
        assert not any(m[found[g], found[h]] for (g, h), m in pairs.items())
        assert sum(costs[g][o] for g, o in found.items()) == pytest.approx(
            sum(costs[g][o] for g, o in enumerate(known))
        )


def test_it_gives_up_where_the_graph_is_wide(monkeypatch: pytest.MonkeyPatch) -> None:
    costs, table = _graph(np.random.default_rng(0), 6, is_ring=True)
    monkeypatch.setattr(eliminate, "LARGEST", 4)
    assert eliminate.eliminated({g: np.isfinite(c) for g, c in enumerate(costs)}, costs, table) is None


def test_it_gives_up_where_a_table_would_have_more_entries_than_a_machine_can_count() -> None:
    """Patches that all conflict with one another, 32 options each: 2^65 combinations."""
    alike = np.eye(32, dtype=bool)
    table = [{h: alike for h in range(14) if h != g} for g in range(14)]
    costs = [np.arange(32.0)] * 14
    assert eliminate.eliminated({g: np.ones(32, dtype=bool) for g in range(14)}, costs, table) is None


def test_long_rows_of_patches_are_eliminated(monkeypatch: pytest.MonkeyPatch) -> None:
    costs, table = _graph(np.random.default_rng(1), 60, is_ring=False)
    pairs = {(g, h): m for g, row in enumerate(table) for h, m in row.items() if g < h}
    monkeypatch.setattr(choose, "proven", lambda *_: pytest.fail("CP-SAT was asked"))
    assert cheapest(costs, pairs) is not None


def _graph(random: np.random.Generator, count: int, *, is_ring: bool) -> tuple[list[Array], list[dict[int, Bools]]]:
    """A row or a ring of groups of three options, neighbours in conflict; the last option of each is free of any."""
    costs = [np.append(random.integers(0, 6, 2).astype(float), 9.0) for _ in range(count)]
    table: list[dict[int, Bools]] = [{} for _ in range(count)]
    for g in range(count if is_ring and count > 2 else count - 1):
        h = (g + 1) % count
        excluded = random.random((3, 3)) < 0.6
        excluded[2, :] = excluded[:, 2] = False
        table[g][h], table[h][g] = excluded, excluded.T
    return costs, table
