"""A shape for CAD has true cylinders and cones, and is what is printed but for facets."""

from __future__ import annotations

import builtins
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from foldfab.errors import FabricationError, MissingLibraryError
from foldfab.fabrication import solids
from foldfab.fabrication.analytic import analytic, require
from foldfab.fabrication.panels import panels
from foldfab.fabrication.plates import plate
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, box, common, cone, cut, facets, hull, placed, prism, rod, union, wrap
from foldfab.folding.model import Chain, Thickness
from foldfab.scaffold.model import BasePatch

CUBE = box((0, 0, 0), (10, 10, 10))
TRIANGLE = [(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]
AT = np.array([100.0, 0.0, 0.0])
LIBGL = "libGL.so.1: cannot open shared object file: No such file or directory"


@pytest.mark.parametrize(
    ("shape", "volume", "low", "high"),
    [
        (CUBE, 1000.0, (0, 0, 0), (10, 10, 10)),
        (rod(2.0, -1.0, 9.0, 5.0, 7.0), 40 * np.pi, (3, -1, 5), (7, 9, 9)),
        (rod(2.0, -1.0, 9.0, 5.0, 7.0, is_hole=True), 40 * np.pi, (3, -1, 5), (7, 9, 9)),
        (cone(3.0, 1.0, 4.0, 0.0, 0.0), 9 * np.pi, (-3, 1, -3), (3, 4, 3)),
        (cone(3.0, 1.0, -2.0, 0.0, 0.0), 9 * np.pi, (-3, -2, -3), (3, 1, 3)),
        (prism(TRIANGLE, 1.0, 3.0), 12.0, (0, 1, 0), (4, 3, 3)),
        (prism(TRIANGLE[::-1], 1.0, 3.0), 12.0, (0, 1, 0), (4, 3, 3)),
        (union([CUBE, box((5, 0, 0), (15, 10, 10))]), 1500.0, (0, 0, 0), (15, 10, 10)),
        (cut(CUBE, [box((5, -1, -1), (11, 11, 11)), box((-1, -1, 5), (11, 11, 11))]), 250.0, (0, 0, 0), (5, 10, 5)),
        (hull([box((0, 0, 0), (1, 1, 1)), box((9, 0, 0), (10, 1, 1))]), 10.0, (0, 0, 0), (10, 1, 1)),
        (wrap(np.array([[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]])), 36.0, (0, 0, 0), (6, 6, 6)),
        (facets(*solids.mesh(solids.box((0, 0, 0), (1, 2, 3)))), 6.0, (0, 0, 0), (1, 2, 3)),
        (common(CUBE, rod(2.0, 5.0, 19.0, 5.0, 5.0)), 20 * np.pi, (3, 5, 3), (7, 10, 7)),
        (placed(box((0, 0, 0), (1, 2, 3)), AT, np.eye(3)[[1, 2, 0]]), 6.0, (100, 0, 0), (103, 1, 2)),
    ],
    ids=[
        "box",
        "rod",
        "hole",
        "cone",
        "cone back",
        "prism",
        "prism back",
        "union",
        "cut",
        "hull",
        "wrap",
        "facets",
        "common",
        "placed",
    ],
)
def test_each_shape(shape: Shape, volume: float, low: tuple[float, ...], high: tuple[float, ...]) -> None:
    made = analytic(shape)
    bounds = made.bounding_box()
    assert made.volume == pytest.approx(volume)
    assert np.allclose([[*bounds.min], [*bounds.max]], [low, high], atol=1e-5)


@pytest.mark.parametrize("thickness", [Thickness(2.5, 0.3), Thickness(4.0, 0.3), Thickness(6.0, 0.2)], ids=str)
def test_what_is_made_for_cad_is_what_is_printed(
    thickness: Thickness, make_chain: Callable[..., Chain], make_base: Callable[..., BasePatch]
) -> None:
    chain = make_chain(thickness, lengths=(30.0, 30.0), width=40.0, pad=3.0)
    ground, _ = plate(make_base((0, 0, 30, 30)), (chain,), thickness)
    for shape in (ground, *panels(chain, thickness)):
        made = analytic(shape)
        assert made.volume == pytest.approx(printed(shape).volume(), rel=0.01)
        assert {"CYLINDER", "CONE"} <= {face.geom_type.name for face in made.faces()}


def test_what_is_apart_may_be_joined_later() -> None:
    two = union([CUBE, box((20, 0, 0), (30, 10, 10))])
    bridge = box((-1, 2, 2), (31, 4, 4))
    assert analytic(union([two, bridge])).volume == pytest.approx(2000 + 4 * 12)
    assert analytic(cut(two, [box((-1, -1, -1), (12, 11, 11))])).volume == pytest.approx(1000)


@pytest.mark.parametrize("shape", [union([CUBE, box((20, 0, 0), (30, 10, 10))]), cut(CUBE, [CUBE])])
def test_what_is_not_one_body_is_refused(shape: Shape) -> None:
    with pytest.raises(FabricationError, match="bodies where there should be one; try another scale"):
        analytic(shape)


def test_what_comes_again_is_a_copy_of_what_was_made() -> None:
    known: dict[Shape, Any] = {}
    a, b = analytic(CUBE, known), analytic(CUBE, known)
    assert len(known) == 1
    assert not a.wrapped.IsPartner(b.wrapped)


@pytest.mark.parametrize(
    ("reason", "message"),
    [
        (LIBGL, "the system library libGL.so.1, which is absent; apt-get install libgl1"),
        (
            "No module named 'build123d'",
            "the library build123d, which cannot be imported (No module named 'build123d')",
        ),
    ],
)
def test_without_the_library_it_says_what_to_install(
    reason: str, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    without_build123d(monkeypatch, reason)
    with pytest.raises(MissingLibraryError) as raised:
        require()
    assert message in str(raised.value)
    assert raised.value.exit_status == 2


def without_build123d(monkeypatch: pytest.MonkeyPatch, reason: str) -> None:
    """A machine where importing build123d fails for a reason."""
    found = builtins.__import__

    def refuse(name: str, *rest: Any, **more: Any) -> Any:
        if name == "build123d":
            raise ImportError(reason)
        return found(name, *rest, **more)

    monkeypatch.delitem(sys.modules, "build123d", raising=False)
    monkeypatch.setattr(builtins, "__import__", refuse)
