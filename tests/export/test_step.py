"""The print as CAD knows it, in Python and in its file."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import foldfab
from foldfab import cli
from foldfab.errors import FabricationError, MissingLibraryError
from foldfab.export.check_step import check_step
from foldfab.export.frames import sheet_poses, to_sheet
from foldfab.export.read_files import read_stl
from foldfab.export.report import Row
from foldfab.export.stated import read_sheet, stated
from foldfab.export.step import AXES, compound, step_bytes
from foldfab.fabrication import analytic, solids
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.shapes import box, facets, union


@pytest.fixture(scope="module")
def seat() -> Assembly:
    """Six bodies of bench-down, which folds along -x: its frame is not the canonical one."""
    return foldfab.fabricate(foldfab.foldabilize(foldfab.load("bench-down")))


@pytest.fixture(scope="module")
def model(seat: Assembly) -> Any:
    return compound(seat)


@pytest.fixture(scope="module")
def folder(seat: Assembly, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its print folder with a STEP file, not to be touched."""
    place = tmp_path_factory.mktemp("prints") / "bench-down"
    foldfab.write(seat, place, step=True)
    return place


def test_bodies_have_their_names_colours_and_volumes(seat: Assembly, model: Any) -> None:
    assert model.label == "bench-down"
    bodies = {child.label: child for child in model.children[:-1]}
    assert list(bodies) == [body.name for body in seat.bodies]
    for body in seat.bodies:
        made = bodies[body.name]
        assert made.volume == pytest.approx(body.volume, rel=0.01)
        points, box = to_sheet(seat, body.vertices), made.bounding_box()
        assert np.allclose([[*box.min], [*box.max]], [points.min(axis=0), points.max(axis=0)], atol=0.05)
        warm = (198, 193, 185) if body.kind == "base" else (242, 142, 43)
        assert np.allclose([*made.color][:3], np.array(warm) / 255, atol=1e-6)


def test_axes_of_hinges_are_lines_that_say_how_far_they_turn(seat: Assembly, model: Any) -> None:
    lines = model.children[-1]
    assert lines.label == AXES
    for joint, line in zip(seat.joints, lines.children, strict=True):
        assert line.label == f"hinge {joint.name}, 0 to {joint.range_deg[1]:g} deg"
        assert np.allclose([[*(line @ 0)], [*(line @ 1)]], to_sheet(seat, joint.axis))


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_joints_turn_as_the_furniture_folds(share: float, seat: Assembly) -> None:
    """Turned to the end of its range about its first part, the second part lies where the fold leaves it."""
    bodies = {child.label: child for child in compound(seat).children}
    assert seat.joints
    for joint in seat.joints:
        a, b = (bodies[name] for name in joint.parts)
        before = b.location
        a.joints[joint.name].connect_to(b.joints[joint.name], angle=share * joint.range_deg[1])
        poses = [sheet_poses(seat, name)[-1 if share else 0] for name in joint.parts]
        assert np.allclose(matrix(b.location), np.linalg.inv(poses[0]) @ poses[1] @ matrix(before), atol=0.2)
        b.location = before


def test_a_joint_turns_no_further_than_its_range(seat: Assembly, model: Any) -> None:
    bodies = {child.label: child for child in model.children}
    joint = seat.joints[0]
    a, b = (bodies[name] for name in joint.parts)
    assert a.joints[joint.name].angular_range == joint.range_deg
    with pytest.raises(ValueError, match="must in range"):
        a.joints[joint.name].connect_to(b.joints[joint.name], angle=-10)


def test_the_same_assembly_gives_the_same_bytes(seat: Assembly, folder: Path) -> None:
    assert step_bytes(seat) == (folder / "bench-down.step").read_bytes()


def test_the_file_names_every_body_once_and_has_no_clock(seat: Assembly, folder: Path) -> None:
    text = (folder / "bench-down.step").read_text("ascii")
    names = re.findall(r"PRODUCT\('([^']*)'", text)
    assert sorted(names) == sorted(
        ["bench-down", AXES, *(body.name for body in seat.bodies)]
        + [f"hinge {joint.name}, 0 to {joint.range_deg[1]:g} deg" for joint in seat.joints]
    )
    assert "'1980-01-01T00:00:00'" in text
    assert {"CYLINDRICAL_SURFACE", "CONICAL_SURFACE"} <= set(re.findall(r"= (\w+)\(", text))


def test_another_body_than_is_printed_is_refused(seat: Assembly) -> None:
    thicker = replace(seat.bodies[0], volume=1.02 * seat.bodies[0].volume)
    with pytest.raises(FabricationError, match=f"{thicker.name} has .* mm³ for CAD and .* in print"):
        compound(replace(seat, bodies=(thicker, *seat.bodies[1:])))


def test_on_edge_ramps_and_planed_ends_are_in_it() -> None:
    standing = foldfab.fabricate(foldfab.foldabilize(foldfab.load("bench-legs", posture="edge")))
    volumes = {child.label: child.volume for child in compound(standing).children[:-1]}
    assert volumes == pytest.approx({body.name: body.volume for body in standing.bodies}, rel=1e-3)


def test_what_cannot_be_joined_to_a_mesh_is_as_it_is_printed(seat: Assembly) -> None:
    """A mesh flush with the faces of a hinge is more than the CAD kernel takes; here, one that is in two pieces."""
    body, cube = seat.bodies[0], solids.box((0, 0, 0), (1, 1, 1))
    apart = union([facets(*solids.mesh(cube)), box((5, 5, 5), (6, 6, 6))])
    made = compound(replace(seat, shapes={**seat.shapes, body.name: apart}))
    (child,) = (c for c in made.children if c.label == body.name)
    assert child.volume == pytest.approx(body.volume, rel=1e-4)
    two = union([box((0, 0, 0), (1, 1, 1)), box((5, 5, 5), (6, 6, 6))])
    with pytest.raises(FabricationError, match=f"{body.name}: .* one; try another scale"):
        compound(replace(seat, shapes={**seat.shapes, body.name: two}))


def test_without_build123d_nothing_is_solved_or_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def absent() -> None:
        raise MissingLibraryError("solids for CAD need the system library libGL.so.1")

    monkeypatch.setattr(analytic, "require", absent)
    monkeypatch.setattr(foldfab.pipeline, "foldabilize", lambda recipe: pytest.fail("solved"))
    assert cli.main(["print", "bench-legs", "--step", "-o", str(tmp_path)]) == 2
    assert "need the system library libGL.so.1" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_good_file_passes_and_is_looked_at_only_where_it_is(folder: Path, tmp_path: Path) -> None:
    report = foldfab.check(folder)
    assert report.ok
    assert [row.text for row in report.rows if row.code == "step"] == ["6 named solids, as they are printed"]
    assert looked_at(folder, tmp_path, lambda text: "")[0].ok is False
    assert check_step(tmp_path, stated(read_sheet(folder))) == []


CHANGES: dict[str, tuple[Callable[[str], str], str]] = {
    "empty": (lambda text: "", "is missing"),
    "cut off": (lambda text: text[: len(text) // 2], ""),
    "noise": (lambda text: "\x07" * 1000, "is missing"),
    "a name": (lambda text: text.replace("'back/1'", "'front/1'"), "back/1 is missing"),
    "an unknown name": (lambda text: text.replace("'back/1'", "'front/1'"), "front/1 is no part of the sheet"),
    "a colour": (lambda text: text.replace("STYLED_ITEM(", "ITEM("), "has no colour"),
    "a size": (lambda text: re.sub(r"CYLINDRICAL_SURFACE\('',(#\d+),2\.", r"CYLINDRICAL_SURFACE('',\1,3.", text), ""),
}


@pytest.mark.parametrize("how", CHANGES)
def test_a_damaged_file_fails(how: str, folder: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    change, words = CHANGES[how]
    (row,) = looked_at(folder, tmp_path, change)
    assert not row.ok
    assert words in row.text


def test_volumes_and_places_are_those_of_the_print(folder: Path, tmp_path: Path) -> None:
    facts = stated(read_sheet(folder))
    other = replace(facts.parts[0], volume=facts.parts[0].volume * 1.02)
    (row,) = check_step(folder, replace(facts, parts=(other, *facts.parts[1:])))
    assert not row.ok and f"{other.name}: volume" in row.text
    same = next(p for p in facts.parts if not np.allclose(low(folder, p.stl), low(folder, other.stl), atol=0.2))
    (row,) = check_step(folder, replace(facts, parts=(replace(facts.parts[0], stl=same.stl), *facts.parts[1:])))
    assert not row.ok and f"{other.name} stands" in row.text


def looked_at(folder: Path, place: Path, change: Callable[[str], str]) -> list[Row]:
    """What the check says of a changed STEP file."""
    target = place / "changed"
    target.mkdir()
    shutil.copytree(folder / "stl", target / "stl")
    (target / "bench-down.step").write_text(change((folder / "bench-down.step").read_text("ascii")), "ascii")
    return check_step(target, stated(read_sheet(folder)))


def low(folder: Path, stl: str) -> np.ndarray:
    """(3,) the least coordinates of a part."""
    return read_stl(folder / stl)[0].min(axis=0)


def matrix(location: Any) -> np.ndarray:
    """(4, 4) rigid motion of a location."""
    return np.array(
        [[location.wrapped.Transformation().Value(i, j) for j in range(1, 5)] for i in range(1, 4)] + [[0, 0, 0, 1]]
    )
