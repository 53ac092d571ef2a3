"""Which parts touch by their shapes, against what their boxes say."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.geometry.arrays import Array
from foldfab.intake import contacts as module
from foldfab.intake.contacts import are_close, contacts, heaps, surface, told
from foldfab.intake.meshes import joined
from foldfab.intake.model import Body, Shapes, Wishes
from foldfab.intake.understand import Grouping, named, parts
from foldfab.recipe.contacts import Contacts
from foldfab.recipe.model import Mesh

from .furniture import box, cylinder

ANGLE = joined([box((0, 0, 10), (600, 400, 20)), box((-290, 0, 210), (20, 400, 380))])
"""An L of 600 × 400 × 400 mm, the corner of its box empty."""


def found(smallest: float = 1, **bodies: Mesh) -> Contacts:
    shapes = Shapes(tuple(Body(name, mesh) for name, mesh in bodies.items()), millimetres=1.0)
    wishes = Wishes(smallest=smallest)
    made = parts("a.obj", named("a.obj", shapes, wishes)[0], wishes, Grouping())
    return contacts(made.parts, made.hardware)


def corners(mesh: Mesh) -> Array:
    some: Array = mesh.vertices[mesh.faces]
    return some


def test_boxes_tell_all_about_boxes() -> None:
    assert found(a=box((0, 0, 0), (500, 300, 18)), b=box((0, 0, 159), (18, 300, 300))) == Contacts()
    assert found(a=box((0, 0, 0), (500, 300, 18)), b=box((0, 0, 900), (18, 300, 300))) == Contacts()


def test_what_stands_clear_in_the_corner_of_an_angle_does_not_touch_it() -> None:
    inside = box((200, 0, 300), (100, 390, 100))
    assert found(angle=ANGLE, inside=inside).apart == {("angle", "inside")}
    on_it = box((200, 0, 75), (100, 390, 100))
    assert found(angle=ANGLE, on_it=on_it) == Contacts()
    close = box((200, 0, 75), (100, 390, 95))
    assert found(angle=ANGLE, close=close) == Contacts()


def test_what_is_stuck_into_a_round_leg_touches_it() -> None:
    leg = cylinder(100, 700, 64)
    assert found(leg=leg, core=box((0, 0, 350), (20, 20, 400))) == Contacts()
    assert found(leg=leg, rail=box((250, 0, 350), (400, 30, 30))) == Contacts()
    assert found(leg=leg, corner=box((95, 95, 350), (20, 20, 600))).apart == {("corner", "leg")}


def test_a_sheet_bent_to_an_open_shell_does_not_touch_what_it_goes_around() -> None:
    pipe = Mesh(cylinder(300, 700, 64).vertices, cylinder(300, 700, 64).faces[:128])
    assert found(pipe=pipe, inner=box((0, 0, 350), (100, 100, 400))).apart == {("inner", "pipe")}


def test_hardware_holds_together_what_it_touches() -> None:
    top, leg = box((0, 0, 785), (1600, 800, 30)), box((-700, 0, 365), (60, 60, 730))
    spacer = box((-700, 0, 750), (20, 20, 40))
    assert found(50, top=top, leg=leg, spacer=spacer) == Contacts(touching=frozenset({("leg", "top")}))
    assert found(50, top=top, leg=leg, glide=box((700, 0, 750), (20, 20, 40))) == Contacts()
    assert found(1, top=top, leg=leg, spacer=spacer) == Contacts()


def test_hardware_beside_a_bent_part_holds_nothing() -> None:
    panel = box((0, 0, 500), (600, 390, 20))
    free, held = (box((x, 0, 445), (20, 20, 84)) for x in (200, -290))
    assert found(95, angle=ANGLE, panel=panel, peg=free) == Contacts()
    assert found(95, angle=ANGLE, panel=panel, peg=held).touching == {("angle", "panel")}


def test_both_are_told() -> None:
    text = "\n".join(told(Contacts(frozenset({("a", "b")}), frozenset({("c", "d")}))))
    assert (
        text == "held together by hardware that was left out: a and b\ndo not touch, although their boxes do: c and d"
    )


def test_a_turned_box_has_the_surface_of_its_shape() -> None:
    turn = np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]])
    mesh = box((5, 6, 7), (500, 300, 18), turn)
    made = parts("a.obj", [Body("a", mesh)], Wishes(), Grouping()).parts[0]
    assert made.shape is None
    of_box, of_mesh = (np.unique(np.round(some.reshape(-1, 3), 6), axis=0) for some in (surface(made), corners(mesh)))
    assert np.array_equal(of_box, of_mesh)


@pytest.mark.parametrize("limit", ["MOST_TRIANGLES", "MOST_PAIRS"])
def test_what_is_too_fine_to_be_measured_touches_as_its_box_does(monkeypatch: pytest.MonkeyPatch, limit: str) -> None:
    near = corners(cylinder(100, 700, 64)), corners(cylinder(100, 700, 64)) + np.array([150, 150, 30])
    assert not are_close(*near, 5)
    monkeypatch.setattr(module, limit, 1)
    assert are_close(*near, 5)


def test_pieces_at_a_time_find_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    leg, rail = corners(cylinder(100, 700, 64)), corners(box((250, 0, 350), (310, 30, 30)))
    away = np.array([7.0, 0, 0])
    for at_once, dense in ((1, 1), (7, 40), (1 << 14, 1 << 22)):
        monkeypatch.setattr(module, "_AT_ONCE", at_once)
        monkeypatch.setattr(module, "_DENSE", dense)
        assert are_close(leg, rail, 0)
        assert are_close(leg, rail + away, 3)
        assert not are_close(leg, rail + away, 1)


def test_heaps_of_what_touches() -> None:
    row = [box((x, 0, 0), (10, 400, 400)) for x in (0, 5, 300, 10, 305, 900)]
    assert heaps(row) == [[0, 1, 3], [2, 4], [5]]
    assert heaps([ANGLE, box((200, 0, 300), (100, 390, 100))]) == [[0], [1]]
    assert heaps([]) == []
