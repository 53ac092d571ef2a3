"""The noun of the room stands alone."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from foldfab.recipe.model import Part, Pattern

SPLIT: Any = ("in-place", 1, "l", (0.0, 0.6))
SLANTED: Any = ("slanted", 0, "r", (0.0, 1.0))
DELETED: Any = ("deleted", 0, None, (0.0, 0.0))


def test_the_model_does_not_import_pydantic() -> None:
    code = "import sys, foldfab.recipe.model; sys.exit('pydantic' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(
    ("pattern", "fitting"),
    [
        (Pattern(), [SPLIT, SLANTED, DELETED]),
        (Pattern("in-place"), [SPLIT]),
        (Pattern("deleted"), [DELETED]),
        (Pattern(hinges=0), [SLANTED]),
        (Pattern(side="l"), [SPLIT]),
        (Pattern(window=(0.0, 1.0)), [SLANTED]),
        (Pattern("in-place", 1, "l", (0.0, 3 / 5)), [SPLIT]),
        (Pattern("in-place", 1, "l", (0.2, 0.6)), []),
    ],
)
def test_what_a_pattern_fits(pattern: Pattern, fitting: list[Any]) -> None:
    assert [asked for asked in (SPLIT, SLANTED, DELETED) if pattern.fits(*asked)] == fitting


@pytest.mark.parametrize(
    ("pin", "forbid", "allowed"),
    [
        (None, (), [SPLIT, SLANTED, DELETED]),
        (Pattern(hinges=1), (), [SPLIT]),
        (None, (Pattern(window=(0.0, 1.0)), Pattern("deleted")), [SPLIT]),
        (Pattern("in-place"), (Pattern(side="l"),), []),
    ],
)
def test_what_a_part_allows(pin: Pattern | None, forbid: tuple[Pattern, ...], allowed: list[Any]) -> None:
    part = Part("seat", np.zeros(3), np.ones(3), np.eye(3), True, pin, forbid)
    assert [asked for asked in (SPLIT, SLANTED, DELETED) if part.allows(*asked)] == allowed
