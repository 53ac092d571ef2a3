"""The same furniture in every format is the same recipe; recipes that name files."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import foldfab
from foldfab.errors import RecipeError
from foldfab.intake.door import load
from foldfab.intake.meshes import joined
from foldfab.intake.model import Wishes
from foldfab.recipe.model import Part, Recipe
from foldfab.recipe.read import parse
from foldfab.recipe.write import as_text

from .furniture import SHELF, box, cylinder, glb, gltf, meshes, mjcf, model_xml, obj, stl, threemf

NO_WISHES = Wishes()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The shelf in every format that can be written by hand."""
    (tmp_path / "shelf.obj").write_text(obj(meshes()), encoding="utf-8")
    (tmp_path / "shelf.glb").write_bytes(glb(*gltf(meshes(), embed=False)))
    (tmp_path / "shelf.gltf").write_text(json.dumps(gltf(meshes())[0]), encoding="utf-8")
    threemf(tmp_path / "shelf.3mf", model_xml(meshes()))
    (tmp_path / "shelf.xml").write_text(mjcf(), encoding="utf-8")
    (tmp_path / "shelf").mkdir()
    for name, mesh in meshes().items():
        (tmp_path / "shelf" / f"{name}.stl").write_bytes(stl(mesh))
    return tmp_path


def assert_is_the_shelf(recipe: Recipe) -> None:
    found = {part.name: part for part in recipe.parts}
    assert set(found) == set(SHELF)
    for name, (center, size) in SHELF.items():
        assert np.allclose(found[name].center, center, atol=0.01)
        assert np.allclose(found[name].size, size, atol=0.01)
        assert np.array_equal(found[name].axes, np.eye(3))


@pytest.mark.parametrize("name", ["shelf.obj", "shelf.glb", "shelf.gltf", "shelf.3mf", "shelf.xml", "shelf"])
def test_every_format_gives_the_same_recipe(folder: Path, name: str) -> None:
    recipe = load(folder / name, NO_WISHES)
    assert (recipe.name, recipe.direction) == ("shelf", None)
    assert_is_the_shelf(recipe)


def folded(recipe: Recipe) -> tuple[list[object], float]:
    """What is done to the parts, and the cost."""
    asked = replace(recipe, print=replace(recipe.print, scale=0.2))
    found = foldfab.foldabilize(replace(asked, direction=np.array([0.0, -1.0, 0.0])))
    return [(m.patch, m.mechanism, m.hinges, m.side, m.window) for m in found.modifications], found.cost


def test_every_format_folds_the_same(folder: Path) -> None:
    names = ("shelf.obj", "shelf.glb", "shelf.gltf", "shelf.3mf", "shelf")
    first, *others = (folded(with_back(load(folder / name, NO_WISHES))) for name in names)
    assert len(first[0]) == 5
    assert others == [first] * 4


def with_back(recipe: Recipe) -> Recipe:
    back = Part("back", np.array([250.0, 309, 400]), np.array([500.0, 18, 800]), np.eye(3))
    return replace(recipe, parts=(*recipe.parts, back))


def test_step_and_build123d_give_the_same_recipe(tmp_path: Path) -> None:
    b3d = pytest.importorskip("build123d", reason="needs build123d and libGL", exc_type=ImportError)
    solids = []
    for name, (center, size) in SHELF.items():
        solid = b3d.Solid.make_box(*size, b3d.Plane(tuple(np.subtract(center, np.array(size) / 2))))
        solid.label = name
        solids.append(solid)
    shelf = b3d.Compound(label="shelf", children=solids)
    b3d.export_step(shelf, tmp_path / "shelf.step")
    for source in (shelf, tmp_path / "shelf.step"):
        recipe = load(source, NO_WISHES)
        assert recipe.name == "shelf"
        assert_is_the_shelf(recipe)
        boxes = [Part(name, np.array(c), np.array(s), np.eye(3)) for name, (c, s) in SHELF.items()]
        assert folded(with_back(recipe)) == folded(with_back(replace(recipe, parts=tuple(boxes))))


def test_a_recipe_as_understood_is_understood_again(folder: Path) -> None:
    first = load(folder / "shelf.obj", NO_WISHES)
    again = parse(json.loads(as_text(first)), "shelf.json", "shelf")
    assert as_text(again) == as_text(first)


def recipe(folder: Path, wishes: Wishes = NO_WISHES, **content: Any) -> Recipe:
    (folder / "mine.json").write_text(json.dumps(content), encoding="utf-8")
    return load(folder / "mine.json", wishes)


def test_a_model_with_flags(folder: Path) -> None:
    flags = [
        {"name": "Side *", "hingeable": False},
        {"name": "side left", "thickness": 3, "shape": "own", "pin": {"mechanism": "slanted"}},
        {"name": "Top", "ignore": True},
        {"name": "b*", "merge": "floor"},
        {"name": "lid", "box": {"center": [0, 0, 90], "size": [50, 30, 2]}},
    ]
    found = recipe(folder, model="shelf.3mf", parts=flags, direction="-y", units="cm")
    parts = {part.name: part for part in found.parts}
    assert list(parts) == ["Side left", "Side right", "floor", "Shelf", "lid"]
    assert [part.hingeable for part in found.parts] == [False, False, True, True, True]
    assert (parts["Side left"].thickness, parts["Side right"].thickness) == (3.0, None)
    assert parts["Side left"].pin is not None
    assert [part.look for part in found.parts] == ["own", None, None, None, None]
    assert parts["lid"].size.tolist() == [500, 300, 20]
    assert parts["floor"].size.tolist() == [500, 300, 18]
    assert found.notes == ("ignored as asked: Top",)
    assert found.direction is not None and found.direction.tolist() == [0, -1, 0]


def test_the_recipes_unit_is_that_of_files_without_one(folder: Path) -> None:
    assert recipe(folder, model="shelf.obj", units="in").parts[0].size.tolist() == [457.2, 7620, 19405.6]
    assert recipe(folder, Wishes(units="mm"), model="shelf.obj", units="in").parts[0].size.tolist() == [18, 300, 764]
    assert recipe(folder, model="shelf.obj").notes[0].startswith("the file states no unit")


def test_a_part_from_a_mesh(folder: Path) -> None:
    (folder / "leg.obj").write_text(obj({"a": cylinder(4, 40), "b": box((0, 0, 45), (8, 8, 10))}), encoding="utf-8")
    top = {"name": "top", "box": {"center": [0, 0, 51], "size": [50, 50, 2]}}
    found = recipe(folder, units="cm", parts=[{"name": "leg", "mesh": "leg.obj", "hingeable": False}, top])
    leg = found.parts[0]
    assert (leg.name, leg.hingeable) == ("leg", False)
    assert np.allclose(leg.size, [80, 80, 500], atol=1)
    assert leg.shape is not None
    assert leg.shape.vertices.max() == pytest.approx(500)
    assert found.notes[0].startswith("leg: no boxes")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ({"model": "../shelf.obj"}, "model: leads out"),
        ({"model": "none.obj"}, "model: there is no file"),
        ({"parts": [{"name": "a", "mesh": "/etc/passwd"}]}, "parts[0].mesh: leads out"),
        ({"model": "shelf.obj", "parts": [{"name": "leg*"}]}, "parts[0].name: 'leg*' fits no body of the model"),
        ({"model": "shelf.obj", "parts": [{"name": "top", "mesh": "shelf.3mf"}]}, "rename it"),
        ({"model": "shelf.obj", "parts": [{"name": "*", "ignore": True}]}, "ignore less"),
        ({"model": "mine.json"}, "not read"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(folder: Path, content: dict[str, Any], says: str) -> None:
    with pytest.raises(RecipeError) as caught:
        recipe(folder, **content)
    assert says in str(caught.value)


def test_wishes_for_shapes_that_a_recipe_of_boxes_does_not_have() -> None:
    with pytest.raises(RecipeError, match=r"--split-shells: is for files of shapes"):
        load("bench", Wishes(split_shells=True))


def test_a_name_that_is_no_folders(tmp_path: Path) -> None:
    (tmp_path / "Mein Stuhl (2).obj").write_text(obj(meshes()), encoding="utf-8")
    assert load(tmp_path / "Mein Stuhl (2).obj", NO_WISHES).name == "Mein-Stuhl-2"


@pytest.mark.parametrize("name", ["shelf.obj", "shelf", "model", "own", "plain"])
def test_parts_are_left_out_wherever_they_come_from(folder: Path, name: str) -> None:
    top = {"name": "Top", "box": {"center": [250, 150, 791], "size": [500, 300, 18]}}
    recipes: dict[str, dict[str, Any]] = {
        "model": {"model": "shelf.obj"},
        "own": {"model": "shelf.obj", "parts": [{"name": "Top", "ignore": True}, {**top, "name": "Top 2"}]},
        "plain": {"parts": [top, {**top, "name": "Shelf"}], "touching": [["Top", "Shelf"]]},
    }
    wishes = Wishes(ignore=("top*",) if name == "plain" else ("top*", "side r*"))
    found = recipe(folder, wishes, **recipes[name]) if name in recipes else load(folder / name, wishes)
    left = {"Shelf"} if name == "plain" else set(SHELF) - {"Top", "Side right"}
    assert {part.name for part in found.parts} == left
    assert found.touching == ()


@pytest.mark.parametrize("name", ["shelf.obj", "bench", "mine"])
def test_what_is_to_be_left_out_has_to_be_there(folder: Path, name: str) -> None:
    wishes = Wishes(ignore=("foot*",))
    with pytest.raises(RecipeError, match=r"--ignore: 'foot\*' fits no part; there are \w+") as caught:
        recipe(folder, wishes, model="shelf.obj") if name == "mine" else load(find(folder, name), wishes)
    assert caught.value.exit_status == 2
    with pytest.raises(RecipeError, match="ignore less"):
        load(find(folder, name) if name != "mine" else folder / "mine.json", Wishes(ignore=("*",)))


def find(folder: Path, name: str) -> Path | str:
    return folder / name if "." in name else name


def test_true_contacts_come_with_the_recipe_and_stay_as_they_are_edited(folder: Path) -> None:
    angle = joined([box((0, 0, 10), (600, 400, 20)), box((-290, 0, 210), (20, 400, 380))])
    bodies = {"angle": angle, "inside": box((200, 0, 300), (100, 390, 100))}
    (folder / "bent.obj").write_text(obj(bodies), encoding="utf-8")
    first = load(folder / "bent.obj", Wishes(units="mm"))
    assert (first.touching, first.apart) == ((), (("angle", "inside"),))
    assert "do not touch, although their boxes do: angle and inside" in first.notes
    assert parse(json.loads(as_text(first)), "a.json", "a").apart == first.apart
    edited = recipe(folder, model="bent.obj", units="mm", touching=[["angle", "in*"]])
    assert (edited.touching, edited.apart) == (first.apart, ())
    (folder / "angle.obj").write_text(obj({"a": angle}), encoding="utf-8")
    inside = {"center": [200, 0, 300], "size": [100, 390, 100]}
    own = [{"name": "bent", "mesh": "angle.obj"}, {"name": "inside", "box": inside}]
    assert recipe(folder, units="mm", parts=own).apart == (("bent", "inside"),)


def test_bodies_merge_by_contact_into_heaps_with_the_flags_of_their_entry(folder: Path) -> None:
    drawers = {
        f"Drawer {place} {kind}": box((x, y, 100), size)
        for place, x in (("left", 0.0), ("right", 500.0))
        for kind, y, size in (("front", -150.0, (400, 20, 150)), ("bottom", 0.0, (400, 280, 10)))
    }
    (folder / "drawers.obj").write_text(obj(drawers | {"Top": box((250, 0, 185), (900, 320, 20))}), encoding="utf-8")
    entry = {"name": "Drawer*", "merge": "Drawer", "hingeable": False}
    found = recipe(folder, model="drawers.obj", units="mm", parts=[{**entry, "by_contact": True}])
    assert [(part.name, part.hingeable) for part in found.parts] == [
        ("Drawer", False),
        ("Drawer-2", False),
        ("Top", True),
    ]
    assert found.parts[0].size.tolist() == found.parts[1].size.tolist() == [400, 300, 150]
    whole = recipe(folder, model="drawers.obj", units="mm", parts=[entry])
    assert [part.name for part in whole.parts] == ["Drawer", "Top"]
    with pytest.raises(RecipeError, match='"by_contact" says how bodies merge'):
        recipe(folder, model="drawers.obj", parts=[{"name": "Drawer*", "by_contact": True}])
