"""Every solution that a figure is tested with is first checked to fold: no collision, flat at the end."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest

from foldfab.folding.model import FoldSolution
from foldfab.pipeline import foldabilize, load
from foldfab.recipe.model import Part

from .builder import recipe

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def assert_folds() -> Callable[[FoldSolution], None]:
    """The independent check of the tests of folding; fixtures of a folder beside this one are out of reach."""
    spec = spec_from_file_location("folding_checks", ROOT / "tests" / "folding" / "conftest.py")
    assert spec and spec.loader
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    check: Callable[[FoldSolution], None] = module.check_folds
    return check


@pytest.fixture(scope="session")
def fold(assert_folds: Callable[[FoldSolution], None]) -> Callable[..., FoldSolution]:
    """Makes the folding solution of thin parts, given `along` and options of the fold, and checks it."""

    def make(*parts: Part, **options: Any) -> FoldSolution:
        solution = foldabilize(recipe(*parts, **options))
        assert_folds(solution)
        return solution

    return make


@pytest.fixture(scope="session")
def shipped(assert_folds: Callable[[FoldSolution], None]) -> Callable[..., FoldSolution]:
    """Makes the folding solution of a recipe that foldfab ships, as thick as it is printed, and checks it."""

    def make(name: str, **options: Any) -> FoldSolution:
        solution = foldabilize(load(str(ROOT / "recipes" / f"{name}.json"), **options))
        assert_folds(solution)
        return solution

    return make
