"""A solution becomes an assembly, or an error that says what is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from foldfab import cli
from foldfab.errors import FabricationError
from foldfab.fabrication import build as room
from foldfab.fabrication.model import Assembly, Body, Finding
from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part, Printer

BOARDS = [
    {"name": "top", "box": {"center": [0, 0, 70], "size": [200, 70, 4]}},
    {"name": "leg", "box": {"center": [-90, 0, 34], "size": [4, 60, 68]}},
]
TINY = {"name": "tiny", "build_volume": [60, 60, 60]}


def test_shelves_at_either_side_of_a_wall_come_to_lie_on_each_other_and_not_through_the_feet_of_that_wall(
    solution: Callable[..., FoldSolution], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    boards = (board_at("ground", 0, 208, 40), board_at("ceiling", 104, 208, 40))
    shelves = (board_at("large", 48, 120, 36, x=-36), board_at("small", 36, 70, 36, x=62))
    walls = (wall_at("left", -98, 0, 104, 36), wall_at("right", 98, 0, 104, 36), wall_at("middle", 25, 0, 104, 36))
    made = room.build(solution((*boards, *shelves, *walls)), "open")
    thick = made.solution.thickness
    level = {base.name: base.top + made.poses[base.name][-1][2, 3] for base in made.solution.scaffold.bases}
    assert level["large"] - level["small"] >= thick.panel + thick.gap


@pytest.mark.parametrize("name", ["shelter", "table"])
def test_bodies_joints_and_poses_belong_together(
    name: str, assembled: Callable[..., Assembly], assert_printable: Callable[[Body], None]
) -> None:
    made = assembled(name)
    names = [body.name for body in made.bodies]
    assert names == sorted(names)
    assert set(made.poses) == set(names)
    assert [joint.name for joint in made.joints] == sorted(joint.name for joint in made.joints)
    assert all(set(joint.parts) <= set(names) for joint in made.joints)
    assert made.times[0] == 0.0
    assert made.times[-1] == 1.0
    for body in made.bodies:
        assert_printable(body)
        assert np.allclose(made.poses[body.name][0], np.eye(4))
        assert abs((made.poses[body.name][-1][:3, :3] @ body.normal)[2]) == pytest.approx(1.0)


def test_the_joints_of_a_wall_that_folds_in_the_middle(assembled: Callable[..., Assembly]) -> None:
    joints = {joint.name: joint for joint in assembled("shelter").joints}
    assert [joint.is_inserted for joint in joints.values()].count(True) == 1
    inserted = next(joint for joint in joints.values() if joint.is_inserted)
    assert inserted.range_deg == (0.0, 180.0)
    assert {joint.range_deg for joint in joints.values() if not joint.is_inserted} == {(0.0, 90.0)}


def test_hinge_faces_lie_at_the_inserted_hinge_only(assembled: Callable[..., Assembly]) -> None:
    by_name = {body.name: body for body in assembled("shelter").bodies}
    assert len(by_name["wall/1"].hinge_faces) > 0
    assert len(by_name["ground"].hinge_faces) == 0
    assert all(len(body.hinge_faces) == 0 for body in assembled("table").bodies)


def test_progress_is_told(assembled: Callable[..., Assembly]) -> None:
    told: list[tuple[str, float]] = []
    room.build(assembled("table").solution, "open", lambda what, share: told.append((what, share)))
    assert {what for what, _ in told} == {"solids", "stops", "inspection"}
    assert all(0.0 <= share <= 1.0 for _, share in told)


def test_a_print_that_would_not_work_is_an_error(assembled: Callable[..., Assembly]) -> None:
    solution = assembled("shelter").solution
    tiny = replace(solution.scaffold.recipe.print, printer=Printer("tiny", (60.0, 60.0, 60.0)))
    scaffold = replace(solution.scaffold, recipe=replace(solution.scaffold.recipe, print=tiny))
    with pytest.raises(FabricationError, match="does not fit the tiny; print at scale") as raised:
        room.build(replace(solution, scaffold=scaffold), "open")
    assert raised.value.exit_status == 1


def test_the_error_lists_the_findings(assembled: Callable[..., Assembly], monkeypatch: pytest.MonkeyPatch) -> None:
    findings = [Finding("clash", f"part {i} meets its neighbour", is_fatal=i > 0) for i in range(15)]
    monkeypatch.setattr(room, "inspect", lambda assembly, made, tell: findings)
    with pytest.raises(FabricationError) as raised:
        room.build(assembled("table").solution, "open")
    lines = str(raised.value).splitlines()
    assert "part 0 meets" not in str(raised.value)
    assert lines[1] == "  clash: part 1 meets its neighbour"
    assert lines[-1] == "  and 2 more"
    assert len(lines) == 14


def test_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recipe = tmp_path / "desk.json"
    recipe.write_text(json.dumps({"direction": "-z", "parts": BOARDS, "print": {"printer": TINY, "scale": 1}}))
    assert cli.main(["print", str(recipe), "-o", str(tmp_path / "prints")]) == 1
    assert "does not fit the tiny" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [recipe]
