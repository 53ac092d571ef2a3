"""Printers by name and by size."""

from __future__ import annotations

import pytest

from foldfab.recipe.printers import PRINTERS, printer


def test_known() -> None:
    assert printer("makerbot-replicator-2").build_volume == (285, 153, 155)
    assert all(name == known.name for name, known in PRINTERS.items())


@pytest.mark.parametrize("text", ["200x200x180", "200 x 200 x 180", "200×200×180.0"])
def test_own(text: str) -> None:
    assert printer(text).build_volume == (200, 200, 180)


@pytest.mark.parametrize("text", ["", "prusa", "200x200", "-1x2x3", "9x200x200", "1e9x1x1"])
def test_unknown(text: str) -> None:
    with pytest.raises(ValueError, match=r"prusa-mk4|20 to 5000"):
        printer(text)
