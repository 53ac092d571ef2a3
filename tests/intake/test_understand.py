"""Bodies become parts."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.intake.meshes import joined
from foldfab.intake.model import Body, Shapes, Wishes
from foldfab.intake.understand import Grouping, named, parts
from foldfab.recipe.model import Mesh, Part
from foldfab.recipe.names import fits

from .furniture import box, cylinder, meshes

NO_WISHES = Wishes()


def understood(
    bodies: dict[str, Mesh], wishes: Wishes = NO_WISHES, grouping: Grouping | None = None
) -> tuple[dict[str, Part], str]:
    shapes = Shapes(tuple(Body(name, mesh) for name, mesh in bodies.items()), millimetres=1.0)
    some, told = named("a.obj", shapes, wishes)
    found = parts("a.obj", some, wishes, grouping or Grouping())
    return {part.name: part for part in found.parts}, "\n".join((*told, *found.notes))


def test_boxes_stay_boxes() -> None:
    found, notes = understood(meshes())
    assert notes == ""
    assert {name: part.shape for name, part in found.items()} == dict.fromkeys(meshes())
    assert found["Top"].size.tolist() == [500, 300, 18]


def test_what_is_no_box_keeps_its_shape_and_is_told() -> None:
    leg = cylinder(40, 764)
    found, notes = understood(meshes() | {"leg": leg})
    shape = found["leg"].shape
    assert shape is not None
    assert np.array_equal(shape.vertices, leg.vertices)
    assert "no boxes, taken as their boxes, which are off by: leg 16" in notes


def test_hardware_is_left_out_and_told() -> None:
    screw = box((250, 150, 20), (4, 4, 10))
    found, notes = understood(meshes() | {"screw": screw})
    assert "screw" not in found
    assert "no longer than 16 mm, left out as hardware (--smallest): screw" in notes
    assert "screw" in understood(meshes() | {"screw": screw}, Wishes(smallest=5))[0]
    assert "screw" in understood(meshes() | {"screw": screw}, grouping=Grouping(kept=("SCREW",)))[0]
    assert set(understood(meshes(), Wishes(smallest=700))[0]) == {"Side left", "Side right"}


def test_names_are_made_unique_and_shells_split() -> None:
    pair = joined([box((0, 0, 0), (40, 40, 700)), box((400, 0, 0), (40, 40, 700))])
    assert list(understood({"legs": pair, "top": box((0, 0, 0), (500, 9, 9))})[0]) == ["legs", "top"]
    split = Wishes(split_shells=True)
    more, last = (Mesh(pair.vertices + np.array([0, y, 0]), pair.faces) for y in (300, 600))
    assert list(understood({"legs": pair, "Legs-1": more, "": last}, split)[0]) == [
        "legs-1", "legs-2", "Legs-1-1", "Legs-1-2", "part-1", "part-2",
    ]  # fmt: skip


def test_ignored_and_merged() -> None:
    grouping = Grouping(ignored=("top",), merged=(("side *", "sides"),))
    found, notes = understood(meshes(), grouping=grouping)
    assert list(found) == ["sides", "Bottom", "Shelf"]
    assert found["sides"].size.tolist() == [500, 300, 764]
    assert "ignored as asked: Top" in notes


def test_sheets_and_lines() -> None:
    line = Mesh(np.array([[0.0, 0, 0], [0, 0, 500], [0, 0, 900]]), np.array([[0, 1, 2]]))
    found, notes = understood({"sheet": box((0, 0, 0), (500, 300, 0)), "line": line})
    assert found["sheet"].size.tolist() == [500, 300, 1]
    assert "sheets without thickness, taken as 1 mm thick: sheet" in notes
    assert "without area, left out: line" in notes


def test_parts_in_one_place_are_told() -> None:
    _, notes = understood({"a": box((0, 0, 0), (500, 300, 18)), "b": box((0, 0, 0), (500, 300, 18))})
    assert "stand in the very same place, as if the file had lost where they belong: a; b" in notes


def test_many_parts_in_one_place_are_refused() -> None:
    lost = {name: box((0, 0, 0), (500, 300, 18)) for name in ("a", "b", "c")}
    with pytest.raises(RecipeError, match=r"a; b; c stand in the very same place.*--ignore NAME"):
        understood(lost)
    assert list(understood(lost, grouping=Grouping(ignored=("b", "c")))[0]) == ["a"]


def test_a_piece_of_furniture_that_stands_askew_is_the_same_one() -> None:
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    askew = {name: Mesh(3 * mesh.vertices @ turn.T + 7, mesh.faces) for name, mesh in meshes().items()}
    straight, turned = understood(meshes())[0], understood(askew)[0]
    for name, part in straight.items():
        assert np.allclose(np.sort(turned[name].size), 3 * np.sort(part.size), atol=1e-3)
        assert np.allclose(turned[name].center, 3 * turn @ part.center + 7, atol=1e-3)


@pytest.mark.parametrize(
    ("bodies", "grouping", "says"),
    [
        ({"a": box((0, 0, 0), (1, 1, 1))}, Grouping(ignored=("*",)), "ignore less"),
        ({"a": box((0, 0, 0), (0, 0, 9))}, Grouping(), "an area"),
        ({"a": box((0, 0, 0), (1e7, 1e5, 9))}, Grouping(), "is the unit right"),
    ],
)
def test_what_is_wrong_is_said(bodies: dict[str, Mesh], grouping: Grouping, says: str) -> None:
    with pytest.raises(RecipeError, match=says):
        understood(bodies, Wishes(smallest=0), grouping)


def test_patterns() -> None:
    assert fits("Side left", "side*") and fits("leg1", "LEG?") and not fits("leg12", "leg?")
    assert fits("leg [2]", "leg [2]") and fits("leg [2]", "leg*]") and not fits("leg 2", "leg [2]")
