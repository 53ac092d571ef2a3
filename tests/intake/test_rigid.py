"""Which shapes of a rigid body are a part."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.intake.rigid import Geom, Link, shapes_of

from .furniture import SHELF, box

FILE = Path("a.urdf")
SHELF_GEOMS = tuple(Geom(name, box(*where)) for name, where in SHELF.items())


def link(name: str, *geoms: Geom) -> Link:
    return Link(name, geoms, np.eye(4))


def names(*links: Link) -> list[str]:
    return [body.name for body in shapes_of(FILE, list(links)).bodies]


def test_a_carcass_is_as_many_parts_as_it_has_boards() -> None:
    found = shapes_of(FILE, [link("carcass", *SHELF_GEOMS)])
    assert [body.name for body in found.bodies] == list(SHELF)
    assert found.notes == ("rigid bodies taken as several parts: carcass (5)",)
    assert names(link("carcass", *(Geom("", geom.mesh) for geom in SHELF_GEOMS))) == ["carcass"] * 5


def test_a_door_and_its_handle_are_one() -> None:
    leaf, knob = Geom("leaf", box((0, 0, 0), (500, 18, 700))), Geom("", box((200, 12, 0), (20, 15, 20)))
    assert names(link("door", leaf, knob)) == ["door"]


def test_shapes_of_one_name_belong_together() -> None:
    halves = [Geom("Top", box((x, 150, 791), (250, 300, 18))) for x in (125, 375)]
    others = [geom for geom in SHELF_GEOMS if geom.name != "Top"]
    assert sorted(names(link("carcass", *others, *halves))) == sorted(SHELF)


@pytest.mark.parametrize(
    ("given", "shape", "name"),
    [
        ("door", "leaf", "door"), ("link_3", "leaf", "leaf"), ("Body 12", "leaf", "leaf"), ("link_3", "", "link_3"),
        ("", "leaf", "leaf"),
    ],
)  # fmt: skip
def test_a_number_is_no_name(given: str, shape: str, name: str) -> None:
    assert names(link(given, Geom(shape, box((0, 0, 0), (1, 1, 1))))) == [name]


def test_links_without_shapes_are_nothing() -> None:
    assert names(link("base"), link("top", Geom("", box((0, 0, 0), (1, 1, 1))))) == ["top"]
    with pytest.raises(RecipeError, match="holds no shapes"):
        shapes_of(FILE, [link("base")])
