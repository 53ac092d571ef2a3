"""The folding solutions of a basic scaffold in isolation: windows, costs and variants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from foldfab.folding.basic import Option, Variant, chain, cost, modification, variants, window_span, windows
from foldfab.folding.model import Thickness
from foldfab.folding.site import Site, sites
from foldfab.recipe.model import FoldOptions
from foldfab.scaffold.model import Scaffold

Make = Callable[..., Scaffold]
THICK = Thickness(4.0, 0.3)


def only_site(scaffold: Scaffold) -> Site:
    (site,) = sites(scaffold, THICK)
    return site


def mechanisms(site: Site, *, may_slant: bool = True, **options: Any) -> set[tuple[str, int, str]]:
    found = variants(site, replace(FoldOptions(), **options), THICK, may_slant=may_slant)
    return {(v.mechanism, v.hinges, v.side) for v in found}


def both(mechanism: str, *hinges: int) -> set[tuple[str, int, str]]:
    return {(mechanism, n, side) for n in hinges for side in "lr"}


def test_a_patch_cut_into_four_pieces_has_ten_windows() -> None:
    """Figure 10."""
    found = windows(4)
    assert len(found) == len(set(found)) == 10
    assert found[0] == (0, 4)
    assert all(0 <= a < b <= 4 for a, b in found)


@pytest.mark.parametrize("steps", range(1, 9))
def test_there_are_as_many_windows_as_the_paper_says(steps: int) -> None:
    assert len(windows(steps)) == steps * (steps + 1) // 2


def test_larger_windows_come_first() -> None:
    sizes = [b - a for a, b in windows(5)]
    assert sizes == sorted(sizes, reverse=True)


@pytest.mark.parametrize(
    ("alpha", "hinges", "kept", "expected"),
    [
        (0.5, 0, 1.0, 0.0),
        (0.5, 1, 1.0, 1 / 6),
        (0.5, 3, 1.0, 0.5),
        (0.5, 0, 0.0, 0.5),
        (0.5, 1, 0.6, 1 / 6 + 0.5 * 0.16),
        (0.25, 2, 0.8, 0.25 * 2 / 3 + 0.75 * 0.04),
        (1.0, 1, 0.2, 1 / 3),
        (0.0, 3, 0.5, 0.25),
    ],
)
def test_cost_is_equation_3(alpha: float, hinges: int, kept: float, expected: float) -> None:
    assert cost(hinges, kept, FoldOptions(alpha=alpha)) == pytest.approx(expected)


def test_a_t_scaffold_slants_or_zigzags_with_any_number_of_hinges(scaffold: Make) -> None:
    """Figure 9 a: to either side, and slanting is on by default."""
    leg = only_site(scaffold("t_scaffold"))
    expected = both("slanted", 0) | both("in-place", 1, 2, 3)
    assert mechanisms(leg) == mechanisms(leg, slanting=False) == expected


def test_an_h_scaffold_folds_in_place_with_odd_hinges_only(scaffold: Make) -> None:
    """Figure 9 b."""
    leg = only_site(scaffold("h_scaffold"))
    assert mechanisms(leg) == both("slanted", 0) | both("in-place", 1, 3)
    assert mechanisms(leg, max_hinges=5) == both("slanted", 0) | both("in-place", 1, 3, 5)
    assert mechanisms(leg, max_hinges=2) == both("slanted", 0) | both("in-place", 1)


def test_an_h_scaffold_slants_only_where_it_may(scaffold: Make) -> None:
    leg = only_site(scaffold("h_scaffold"))
    assert mechanisms(leg, slanting=False) == both("in-place", 1, 3)
    assert mechanisms(leg, may_slant=False) == both("in-place", 1, 3)


def test_an_unhingeable_patch_is_never_split(scaffold: Make) -> None:
    for name in ("t_scaffold", "h_scaffold"):
        site = only_site(scaffold(name))
        rigid = replace(site, patch=replace(site.patch, hingeable=False))
        assert mechanisms(rigid) == both("slanted", 0)


def test_a_patch_too_short_for_its_hinges_has_fewer_variants(
    scaffold: Make, board_at: Callable[..., object], wall_at: Callable[..., object]
) -> None:
    short = only_site(scaffold((board_at("ground", 0), board_at("top", 26), wall_at("leg", 0, 0, 26))))
    assert mechanisms(short) == both("slanted", 0) | both("in-place", 1)


def test_a_chain_has_a_panel_more_than_hinges_and_fills_the_clear_height(scaffold: Make) -> None:
    leg = only_site(scaffold("h_scaffold"))
    for hinges in (1, 3):
        made = chain(leg, Variant("in-place", hinges, "r"), leg.span, THICK)
        assert made is not None and len(made.lengths) == len(made.panels) == hinges + 1
        assert made.lengths.sum() == pytest.approx(80 - 2 * (2 + 0.3))
        assert made.lengths == pytest.approx(np.full(hinges + 1, made.lengths[0]))


@pytest.mark.parametrize("name", ["slanted_h", "two_ways"])
def test_from_a_slanted_start_all_panels_but_one_are_equal(scaffold: Make, name: str) -> None:
    """Section 5.3: N_h panels of a and one of a + Δ, at opposite ends for the two sides."""
    for leg in sites(scaffold(name), THICK):
        for hinges in (1, 3):
            right, left = (chain(leg, Variant("in-place", hinges, s), leg.span, THICK) for s in ("r", "l"))
            assert right is not None and left is not None
            assert right.lengths == pytest.approx(left.lengths[::-1])
            *short, long = sorted(right.lengths)
            assert short == pytest.approx([short[0]] * hinges)
            assert long - short[0] == pytest.approx(right.lengths.sum() * abs(np.sin(leg.lean)))


def test_windows_share_the_width_evenly_and_too_narrow_ones_are_none(scaffold: Make) -> None:
    leg = only_site(scaffold("h_scaffold"))
    half = THICK.gap / 2
    assert window_span(leg, (0, 4), 4, THICK) == pytest.approx([-30, 30])
    assert window_span(leg, (0, 2), 4, THICK) == pytest.approx([-30, -half])
    assert window_span(leg, (1, 2), 4, THICK) == pytest.approx([-15 + half, -half])
    assert window_span(leg, (0, 1), 10, THICK) is None


def test_a_whole_patch_narrower_than_a_hinge_is_widened_to_it(
    scaffold: Make, box: Callable[..., object], board_at: Callable[..., object]
) -> None:
    rod = only_site(scaffold((board_at("ground", 0), box("rod", (0, 0, 40), (4, 5, 76)))))
    span = window_span(rod, (0, 5), 5, THICK)
    assert span == pytest.approx([-THICK.hinge_width / 2, THICK.hinge_width / 2])


def test_a_modification_says_what_an_option_does_in_the_terms_of_the_paper(scaffold: Make) -> None:
    leg, options = only_site(scaffold("h_scaffold")), FoldOptions(shrink_steps=5)
    split = modification(leg, Option(Variant("in-place", 1, "l"), (1, 5), 0.2), options, "because")
    assert (split.patch, split.mechanism, split.hinges, split.side) == ("leg", "in-place", 1, "l")
    assert split.window == (0.2, 1.0) and split.cost == 0.2 and split.reason == "because"
    gone = modification(leg, Option(None, (0, 0), 0.5), options, "")
    assert gone.is_deleted and gone.window == (0.0, 0.0) and gone.side is None
