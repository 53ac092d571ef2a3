"""The sheet states the measured facts."""

import dataclasses
import json
from typing import Any

import numpy as np
import pytest

from foldfab.export.sheet import component_count, facts, sheet_json
from foldfab.export.shell import sheet_shells
from foldfab.fabrication.model import Assembly

FIELDS = [
    "name",
    "about",
    "version",
    "provenance",
    "posture",
    "direction",
    "scale",
    "thickness_mm",
    "hinge",
    "clearance_mm",
    "clearance_from",
    "printer",
    "propped",
    "print_files",
    "size_open_mm",
    "size_folded_mm",
    "space_saving",
    "options",
    "cost",
    "lower_bound",
    "cost_terms",
    "modifications",
    "units",
    "components",
    "parts",
    "joints",
    "snaps",
    "findings",
]


def _facts(assembly: Assembly) -> dict[str, Any]:
    return facts(assembly, sheet_shells(assembly), {body.name: f"stl/{body.name}.stl" for body in assembly.bodies})


def test_fields_and_their_order(assembly: Assembly) -> None:
    found = _facts(assembly)
    assert list(found) == FIELDS
    text = sheet_json(assembly, sheet_shells(assembly), {body.name: "x" for body in assembly.bodies})
    assert list(json.loads(text)) == FIELDS


def test_sizes_are_those_of_the_printed_solids(assembly: Assembly) -> None:
    found = _facts(assembly)
    assert found["size_open_mm"] == pytest.approx([125, 50, 72.6], abs=1e-4)
    assert found["size_folded_mm"] == pytest.approx([125, 50, 16.9], abs=1e-3)
    assert found["space_saving"] == pytest.approx(1 - 16.9 / 72.6, abs=1e-4)


def test_everything_stands_in_the_sheet_frame(turned_assembly: Assembly) -> None:
    found = _facts(turned_assembly)
    assert found["direction"] == [1.0, 0.0, 0.0]
    assert found["size_open_mm"] == pytest.approx([72.6, 50, 125], abs=1e-4)
    floor = next(part for part in found["parts"] if part["name"] == "floor")
    assert np.abs(floor["normal"]).tolist() == [1.0, 0.0, 0.0]
    inner = next(joint for joint in found["joints"] if joint["inserted"])
    assert np.subtract(*inner["axis"]).tolist() == pytest.approx([0, -40, 0])


def test_costs_and_importances_add_up(assembly: Assembly) -> None:
    found = _facts(assembly)
    assert sum(term["importance"] for term in found["cost_terms"]) == pytest.approx(1.0, abs=1e-8)
    total = sum(term["importance"] * 0.5 * term["hinges"] / 3 for term in found["cost_terms"])
    assert total == pytest.approx(found["cost"], abs=1e-8)


def test_modifications_stand_under_the_recipe_s_parts(assembly: Assembly) -> None:
    solution = assembly.solution
    flap, leg = solution.modifications
    gone = dataclasses.replace(flap, mechanism="deleted", window=(0.0, 0.0), side=None)
    patches = tuple(
        dataclasses.replace(patch, parts=("leg", "flap") if patch.name == "leg" else ("flap",))
        for patch in solution.scaffold.patches
    )
    scaffold = dataclasses.replace(solution.scaffold, patches=patches)
    changed = dataclasses.replace(solution, scaffold=scaffold, modifications=(gone, leg))
    found = _facts(dataclasses.replace(assembly, solution=changed))["modifications"]
    assert found == {
        "leg": {"windows": [[0.0, 1.0]], "deleted": False},
        "flap": {"windows": [[0.0, 0.0], [0.0, 1.0]], "deleted": False},
    }


def test_components(assembly: Assembly) -> None:
    names = [body.name for body in assembly.bodies]
    assert component_count(names, assembly.joints) == 1
    assert component_count(names, assembly.joints[1:]) == 2
    assert component_count(names, ()) == 5
