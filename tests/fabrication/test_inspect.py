"""Each check of the inspection can fail: a doctored print makes it speak."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.errors import FoldfabError
from foldfab.fabrication import solids
from foldfab.fabrication.inspect import inspect, printed_extent
from foldfab.fabrication.model import Assembly, Finding
from foldfab.fabrication.solids import Solid
from foldfab.recipe.model import Printer

G = 0.3


def test_the_undoctored_print_is_fine(assembled: Callable[..., Assembly]) -> None:
    for name in ("shelter", "table"):
        for posture in ("open", "folded"):
            assert fatal(look(assembled(name, posture))) == []


def test_a_part_that_falls_apart(assembled: Callable[..., Assembly]) -> None:
    def doctor(made: dict[str, Solid]) -> None:
        made["ground"] = solids.union([made["ground"], solids.box((300, 0, 0), (310, 10, 10))])

    (finding,) = fatal(look(assembled("shelter"), doctor))
    assert finding.code == "body"
    assert "ground falls into 2 bodies" in finding.text


def test_an_empty_part(assembled: Callable[..., Assembly]) -> None:
    def doctor(made: dict[str, Solid]) -> None:
        made["ground"] = Solid()

    assert [f.code for f in fatal(look(assembled("shelter"), doctor))] == ["body"]


@pytest.mark.parametrize("posture", ["open", "folded"])
def test_parts_that_overlap_as_printed(posture: str, assembled: Callable[..., Assembly]) -> None:
    def doctor(made: dict[str, Solid]) -> None:
        made["wall/1"] = made["wall/1"].translate([0.0, 0.5, 0.0])

    found = [f for f in fatal(look(assembled("shelter", posture), doctor)) if f.code == "overlap"]
    assert "ground and wall/1 overlap" in found[0].text


def test_parts_that_are_too_close_as_printed(assembled: Callable[..., Assembly]) -> None:
    def doctor(made: dict[str, Solid]) -> None:
        face = 2.0
        step = solids.box((face + 0.6 * G, -20, 0), (face + 4, -18, 20))
        made["ground"] = solids.union([made["ground"], step])

    found = [f for f in fatal(look(assembled("shelter"), doctor)) if f.code == "gap"]
    assert len(found) == 1
    assert "ground and wall/1 are only 0.18" in found[0].text


def test_parts_that_meet_while_folding(assembled: Callable[..., Assembly]) -> None:
    def doctor(made: dict[str, Solid]) -> None:
        for x in (-40.0, 30.0):
            made["ground"] = solids.union([made["ground"], solids.box((x, -5, 0), (x + 10, 5, 12))])

    found = fatal(look(assembled("shelter"), doctor))
    assert {f.code for f in found} == {"clash"}
    assert any("ground and wall" in f.text and "allow wall more shrink steps" in f.text for f in found)


def test_a_clash_of_plates_gives_other_advice(assembled: Callable[..., Assembly]) -> None:
    def doctor(made: dict[str, Solid]) -> None:
        made["ground"] = solids.union([made["ground"], solids.box((-70, -35, 0), (-60, -25, 60))])

    found = [f for f in fatal(look(assembled("shelter"), doctor)) if f.text.startswith("ground and roof")]
    assert "print larger" in found[0].text


@pytest.mark.parametrize("posture", ["open", "folded"])
def test_a_bed_that_is_too_small(posture: str, assembled: Callable[..., Assembly]) -> None:
    made = assembled("shelter", posture)
    for side in range(3):
        bed = printed_extent(made) + 1.0
        bed[side] = min(printed_extent(made)) - 0.1
        found = fatal(look(on_printer(made, bed)))
        assert [f.code for f in found] == ["bed"]
        assert "does not fit the tiny; print at scale 0." in found[0].text


def test_the_bed_may_be_used_either_way_round(assembled: Callable[..., Assembly]) -> None:
    made = assembled("shelter")
    assert fatal(look(on_printer(made, printed_extent(made)[[1, 0, 2]] + 0.1))) == []


@pytest.mark.parametrize(("share", "code", "is_fatal"), [(0.6, "axis", True), (0.4, "play", False), (0.1, None, False)])
def test_a_hinge_off_its_axis(
    share: float, code: str | None, is_fatal: bool, assembled: Callable[..., Assembly]
) -> None:
    made = assembled("table")
    leg = next(body.name for body in made.bodies if body.kind == "panel")
    pose = np.array(made.poses[leg])
    pose[len(pose) // 2, 2, 3] += share * G
    found = [f for f in look(replace(made, poses={**made.poses, leg: pose})) if f.code in ("axis", "play")]
    assert [(f.code, f.is_fatal) for f in found] == ([(code, is_fatal)] if code else [])
    assert all(leg in f.text for f in found)


@pytest.mark.parametrize(("thickness", "clearance"), [(2.0, 0.4), (2.5, 0.4), (3.0, 0.5)])
def test_a_hinge_that_the_audit_calls_loose_is_refused(
    thickness: float, clearance: float, assembled: Callable[..., Assembly]
) -> None:
    with pytest.raises(FoldfabError):
        assembled("table", thickness=thickness, clearance=clearance)


def look(assembly: Assembly, doctor: Callable[[dict[str, Solid]], None] = lambda made: None) -> list[Finding]:
    """What the inspection says about the bodies of an assembly after `doctor` has changed them."""
    made = {body.name: solids.from_mesh(body.vertices, body.faces) for body in assembly.bodies}
    doctor(made)
    return inspect(assembly, made, lambda share: None)


def fatal(findings: list[Finding]) -> list[Finding]:
    """Those that mean that the print would not work."""
    return [finding for finding in findings if finding.is_fatal]


def on_printer(assembly: Assembly, volume: np.ndarray) -> Assembly:
    """The same assembly for another printer."""
    scaffold = assembly.solution.scaffold
    options = replace(scaffold.recipe.print, printer=Printer("tiny", tuple(volume.tolist())))
    recipe = replace(scaffold.recipe, print=options)
    return replace(assembly, solution=replace(assembly.solution, scaffold=replace(scaffold, recipe=recipe)))
