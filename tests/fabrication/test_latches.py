"""A latch holds on the solids, lets go with its prongs pressed in, and is found where it does neither."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from foldfab.export.check import inspect_folder
from foldfab.export.write import write
from foldfab.fabrication import solids
from foldfab.fabrication.latches import FLEX, HOLDS_WITHIN, PRONG, SLIT, STIFFNESS, detent, tried
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.printed import printed
from foldfab.fabrication.stops import Stop, stops
from foldfab.fabrication.trial import Trial
from foldfab.fabrication.turning import turn


@pytest.mark.parametrize("posture", ["open", "folded"])
@pytest.mark.parametrize("name", ["table", "shelter"])
def test_base_hinges_are_held_open(name: str, posture: str, assembled: Callable[..., Assembly]) -> None:
    assembly = assembled(name, posture, latch=True)
    bases = [joint for joint in assembly.joints if not joint.is_inserted]
    assert bases
    for joint in bases:
        assert joint.latch is not None
        assert 0 < joint.latch.holds_at <= HOLDS_WITHIN
        assert joint.latch.moment > 10
    assert all(joint.latch is None for joint in assembly.joints if joint.is_inserted)
    assert "latch" not in {finding.code for finding in assembly.findings}


def test_nothing_is_latched_unasked(assembled: Callable[..., Assembly]) -> None:
    assert all(joint.latch is None for joint in assembled("table").joints)


def test_it_holds_and_lets_go_on_the_solids(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("table", latch=True)
    stop = tongue(assembled("table"))
    assert stop.detent is not None
    made = {body.name: solids.from_mesh(body.vertices, body.faces) for body in assembly.bodies}
    joint = next(joint for joint in assembly.joints if joint.name == stop.joint)
    range_ = turn(joint, *(assembly.poses[part] for part in joint.parts))
    is_first = joint.parts[0] == stop.other
    base, panel = made[stop.other], made[stop.body]
    assert tried(range_, base, panel, stop.detent, is_base_first=is_first) is not None
    without_ridges = solids.cut(base, [printed(stop.detent.ridges)])
    assert tried(range_, without_ridges, panel, stop.detent, is_base_first=is_first) is None
    middle = sum(solids.bounds(printed(stop.detent.slit))) / 2
    block = solids.box(middle - np.array([12.0, 6.0, 3.0]), middle + np.array([12.0, 6.0, 1.0]))
    assert tried(range_, solids.union([base, block]), panel, stop.detent, is_base_first=is_first) is None


def test_the_moment_is_that_of_two_cantilevers() -> None:
    made = detent(2.0, 0.2, 6.0, 0.3, 0.0, 8.0)
    assert made is not None
    lever, arm = 5.2 - 1.2, 5.2
    force = 3 * STIFFNESS * (2.2 * PRONG**3 / 12) * FLEX / lever**3
    assert made.moment == pytest.approx(2 * force * arm)
    assert detent(2.0, 0.2, 6.0, 0.3, 0.0, 2 * PRONG + SLIT - 0.01) is None


def test_a_latch_without_room_is_told(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("table")
    trial = Trial(assembly, {b.name: solids.from_mesh(b.vertices, b.faces) for b in assembly.bodies})
    stop = tongue(assembly)
    bare = Stop(stop.joint, stop.kind, False, stop.body, stop.added, stop.other, stop.cut)
    assert trial.latch(bare) is None
    assert np.allclose(trial.made[stop.other].volume(), solids.union([trial.made[stop.other]]).volume())


def tongue(assembly: Assembly) -> Stop:
    """The tongue of the first leg."""
    chain = assembly.solution.chains[0]
    return next(iter(stops(assembly.solution, chain, 0, in_open=True)))


def test_the_sheet_states_what_gives_and_the_check_lets_no_more_pass(
    assembled: Callable[..., Assembly], tmp_path: Path
) -> None:
    write(assembled("table", latch=True), tmp_path / "table")
    assert inspect_folder(tmp_path / "table").ok
    sheet = tmp_path / "table" / "sheet.json"
    facts = json.loads(sheet.read_text())
    for row in facts["joints"]:
        assert 0.05 < row["latch"].pop("gives_mm3") < 1.0
        row["latch"]["gives_mm3"] = 0.0
    sheet.write_text(json.dumps(facts))
    assert [row.code for row in inspect_folder(tmp_path / "table").rows if not row.ok] == ["collide"]
    facts["joints"][0]["latch"]["gives_mm3"] = 5.0
    sheet.write_text(json.dumps(facts))
    assert not inspect_folder(tmp_path / "table").ok
