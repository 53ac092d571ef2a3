"""Which posture is chosen, and why."""

from __future__ import annotations

import shutil

import pytest

from foldfab import pipeline, postures
from foldfab.errors import FoldingError, MissingLibraryError
from foldfab.recipe.model import Recipe

NEEDS_SLICER = pytest.mark.skipif(shutil.which("prusa-slicer") is None, reason="PrusaSlicer is not installed")


def _absent(recipe: Recipe, tell: object = None) -> tuple[postures.Row, ...]:
    raise MissingLibraryError("PrusaSlicer is not installed")


def _rows(*given: postures.Row) -> object:
    return lambda recipe, tell=None: given


@pytest.mark.parametrize(("name", "posture"), [("bench-legs", "edge"), ("bench", "folded"), ("bed", "folded")])
def test_without_a_slicer_a_rule_decides(monkeypatch: pytest.MonkeyPatch, name: str, posture: str) -> None:
    monkeypatch.setattr(postures, "compared", _absent)
    settled = postures.settled(pipeline.load(name, posture="auto"))
    assert settled.print.posture == posture
    assert "no slicer" in settled.print.why


def test_least_support_then_least_time(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = (
        postures.Row("open", seconds=10, support_g=20),
        postures.Row("folded", seconds=50, support_g=0.2),
        postures.Row("edge", seconds=40, support_g=0.0),
        postures.Row("plate", seconds=1),
    )
    monkeypatch.setattr(postures, "compared", _rows(*rows))
    recipe = pipeline.load("bench-legs", posture="auto")
    assert postures.settled(recipe).print.posture == "edge"
    monkeypatch.setattr(postures, "compared", _rows(*rows[:2], postures.Row("edge", problem="askew")))
    assert postures.settled(recipe).print.posture == "folded"


def test_auto_must_be_settled_first() -> None:
    with pytest.raises(FoldingError, match="settled"):
        pipeline.foldabilize(pipeline.load("bench-legs", posture="auto"))


@NEEDS_SLICER
def test_on_edge_the_slicer_finds_nothing_to_support() -> None:
    rows = {row.posture: row for row in postures.compared(pipeline.load("bench-legs"))}
    assert rows["edge"].support_g == 0.0
    assert rows["open"].support_g > rows["folded"].support_g > 0.0
    assert rows["plate"].files == 1
