"""How the bodies lie on the bed."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from foldfab.export.bed import on_bed
from foldfab.export.shell import bounds
from foldfab.fabrication.model import Assembly
from foldfab.recipe.model import Printer


def test_open_it_stands_in_the_middle_of_the_bed(assembly: Assembly) -> None:
    low, high = bounds(on_bed(assembly))
    assert low[2] == 0.0
    assert np.allclose((low + high)[:2] / 2, [125.0, 105.0], atol=1e-4)
    assert np.allclose(high - low, [125, 50, 72.6], atol=1e-4)


def test_folded_it_lies_flat_whatever_the_direction(turned_assembly: Assembly) -> None:
    low, high = bounds(on_bed(turned_assembly))
    assert low[2] == 0.0
    assert np.allclose(high - low, [125, 50, 16.9], atol=1e-3)


@pytest.mark.parametrize(("bed", "size"), [((130.0, 60.0, 90.0), [125, 50]), ((60.0, 130.0, 90.0), [50, 125])])
def test_it_is_turned_only_where_that_makes_it_fit(
    make: Callable[..., Assembly], bed: tuple[float, float, float], size: list[int]
) -> None:
    low, high = bounds(on_bed(_on_printer(make(), bed)))
    assert np.allclose((high - low)[:2], size, atol=1e-4)
    assert np.all(low >= 0) and np.all(high <= bed)


def _on_printer(assembly: Assembly, bed: tuple[float, float, float]) -> Assembly:
    solution = assembly.solution
    recipe = solution.scaffold.recipe
    options = dataclasses.replace(recipe.print, printer=Printer("own", bed))
    scaffold = dataclasses.replace(solution.scaffold, recipe=dataclasses.replace(recipe, print=options))
    return dataclasses.replace(assembly, solution=dataclasses.replace(solution, scaffold=scaffold))
