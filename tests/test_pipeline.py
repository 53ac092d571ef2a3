"""The whole corridor: what is put in, what lies in the folder, and what is left behind when it goes wrong."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import foldfab
from foldfab import cli, pipeline
from foldfab.errors import AbstractionError, FabricationError, FoldingError
from foldfab.fabrication.inspect import printed_extent
from foldfab.fabrication.model import Assembly
from foldfab.folding import alternatives as ranking
from foldfab.folding import solve
from foldfab.folding.model import FoldSolution
from foldfab.scaffold.model import Scaffold

SMALL = ("bench-legs", "table-slanted")
"""Two shipped recipes that print quickly."""
TABLE: list[dict[str, Any]] = [
    {"name": "top", "box": {"center": [0, 0, 700], "size": [1400, 700, 30]}},
    {"name": "leg-left", "box": {"center": [-600, 0, 342], "size": [30, 600, 685]}},
    {"name": "leg-right", "box": {"center": [600, 0, 342], "size": [30, 600, 685]}},
]
LONG, TALL = {"name": "long", "build_volume": [150, 400, 400]}, {"name": "low", "build_volume": [400, 400, 120]}


@pytest.mark.parametrize("posture", ["open", "folded"])
@pytest.mark.parametrize("printer", ["prusa-mk4", "makerbot-replicator-2", LONG, TALL], ids=str)
def test_fit_uses_the_bed(tmp_path: Path, posture: str, printer: Any) -> None:
    made = fabricated(tmp_path, direction="-z", print={"posture": posture, "printer": printer, "scale": "fit"})
    bed = np.array(made.solution.scaffold.recipe.print.printer.build_volume)
    size = printed_extent(made)
    shares = [(way / bed).max() for way in (size, size[[1, 0, 2]]) if (way <= bed).all()]
    assert shares, f"{size} does not fit {bed}"
    assert max(shares) >= 0.9, f"{size} leaves most of {bed} empty"


def test_a_composite_is_saved_loaded_and_folded(tmp_path: Path) -> None:
    pipeline.save(pipeline.compose("building", "2x1"), tmp_path / "many.json")
    solution = foldfab.foldabilize(foldfab.load(str(tmp_path / "many.json")))
    assert solution.scaffold.recipe.name == "building-2x1"
    assert len(solution.chains) == 9 and len(solution.steps) == 3


def test_the_same_table_from_meshes_folds_the_same(tmp_path: Path) -> None:
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    quads = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = []
    for index, part in enumerate(TABLE):
        center, size = part["box"]["center"], part["box"]["size"]
        lines.append(f"g {part['name']}")
        lines += [
            "v " + " ".join(str((c + s * k / 2) / 10) for c, s, k in zip(center, size, corner, strict=True))
            for corner in corners
        ]
        lines += ["f " + " ".join(str(corner + 8 * index) for corner in quad) for quad in quads]
    (tmp_path / "table.obj").write_text("\n".join(lines), encoding="utf-8")
    (tmp_path / "boxes.json").write_text(json.dumps({"parts": TABLE}), encoding="utf-8")
    (tmp_path / "named.json").write_text(json.dumps({"model": "table.obj", "units": "cm"}), encoding="utf-8")
    meshes = foldfab.load(tmp_path / "table.obj")
    assert meshes.notes == ("the file states no unit; taken as cm, so that its longest side is 1400 mm (--units)",)
    solutions = [
        foldfab.foldabilize(r)
        for r in (meshes, foldfab.load(tmp_path / "named.json"), foldfab.load(tmp_path / "boxes.json"))
    ]
    for solution in solutions:
        assert solution.cost == solutions[-1].cost
        assert [m.patch for m in solution.modifications] == [m.patch for m in solutions[-1].modifications]


def test_what_reading_had_to_suppose_stands_in_the_sheet(tmp_path: Path) -> None:
    recipe = replace(loaded(tmp_path, direction="-z", print={"scale": 0.1}), notes=("no boxes: leg 3 mm",))
    made = foldfab.fabricate(foldfab.foldabilize(recipe))
    foldfab.write(made, tmp_path / "print")
    sheet = json.loads((tmp_path / "print" / "sheet.json").read_text(encoding="utf-8"))
    assert {"code": "as-read", "text": "no boxes: leg 3 mm"} in sheet["findings"]


def test_a_scale_of_ones_own_is_kept(tmp_path: Path) -> None:
    made = fabricated(tmp_path, direction="-z", print={"scale": 0.1})
    assert made.solution.scaffold.scale == 0.1
    assert made.posture == "open"
    assert foldfab.fabricate(made.solution, posture="folded").posture == "folded"


def test_a_scale_that_does_not_fit_says_which_would(tmp_path: Path) -> None:
    with pytest.raises(FabricationError, match=r"at scale 0\.\d+ or smaller"):
        fabricated(tmp_path, direction="-z", print={"scale": 0.5})


def test_a_print_longer_across_is_told_the_scale_at_which_it_fits_turned(tmp_path: Path) -> None:
    """The bed is longer along x, the furniture along y."""
    boxes = {"floor": ([0, 0, 0], [80, 300, 4]), "top": ([0, 0, 60], [80, 300, 4]), "wall": ([0, 0, 30], [4, 280, 56])}
    recipe = {
        "direction": "-z", "print": {"scale": 1.0},
        "parts": [{"name": n, "box": {"center": at, "size": size}} for n, (at, size) in boxes.items()],
    }  # fmt: skip
    (tmp_path / "long.json").write_text(json.dumps(recipe), encoding="utf-8")
    with pytest.raises(FabricationError, match=r"at scale 0\.8\d+ or smaller, with --scale fit") as told:
        pipeline.fabricate(foldfab.foldabilize(foldfab.load(tmp_path / "long.json")))
    found = re.search(r"at scale ([\d.]+)", str(told.value))
    assert found
    fitting = foldfab.load(tmp_path / "long.json", scale=found[1])
    assert pipeline.fabricate(foldfab.foldabilize(fitting)).solution.scaffold.scale == float(found[1])


def test_auto_takes_the_direction_with_the_best_score(tmp_path: Path) -> None:
    found = foldfab.foldabilize(loaded(tmp_path, direction="auto"))
    best, *others = pipeline.directions(loaded(tmp_path, direction="auto"))
    assert found.scaffold.direction.tolist() == best.best.direction.tolist()
    assert all(row.best.score <= best.best.score for row in others if row.best.solution)
    named = foldfab.foldabilize(loaded(tmp_path, direction="-z"))
    assert (found.cost, found.modifications) == (named.cost, named.modifications)
    assert np.abs(found.scaffold.direction).max() == 1.0


def test_alternatives_share_direction_and_scale(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[tuple[Scaffold, int]] = []

    def ranked(scaffold: Scaffold, count: int) -> tuple[FoldSolution, ...]:
        seen.append((scaffold, count))
        return (solve.solve(scaffold),)

    monkeypatch.setattr(ranking, "alternatives", ranked)
    recipe = loaded(tmp_path, direction="auto")
    best, (found,) = foldfab.foldabilize(recipe), pipeline.alternatives(recipe, 3)
    (scaffold, count) = seen[0]
    assert count == 3
    assert (scaffold.scale, scaffold.direction.tolist()) == (best.scaffold.scale, best.scaffold.direction.tolist())
    assert (found.cost, found.modifications) == (best.cost, best.modifications)


def test_auto_says_why_nothing_folds(tmp_path: Path) -> None:
    with pytest.raises(FoldingError, match="none of the six axis directions") as raised:
        foldfab.foldabilize(loaded(tmp_path, parts=TABLE[:1], direction="auto"))
    assert len(str(raised.value).splitlines()) >= 7


def test_auto_says_once_what_is_loose(tmp_path: Path) -> None:
    apart = [TABLE[0], {"name": "far", "box": {"center": [0, 0, 9000], "size": [100, 100, 30]}}]
    with pytest.raises(AbstractionError, match="far is 8270 mm from top") as raised:
        foldfab.foldabilize(loaded(tmp_path, parts=apart, direction="auto"))
    assert raised.value.parts == ("far",) and len(str(raised.value).splitlines()) == 1


def test_a_direction_without_a_scaffold_names_one_that_works(tmp_path: Path) -> None:
    with pytest.raises(AbstractionError, match="try --direction -z") as raised:
        foldfab.foldabilize(loaded(tmp_path, direction=[1, 1, 1]))
    assert raised.value.exit_status == 1


def test_furniture_in_two_pieces_names_the_loose_part(tmp_path: Path) -> None:
    apart = [*TABLE, {"name": "far", "box": {"center": [0, 0, 9000], "size": [100, 100, 30]}}]
    with pytest.raises(AbstractionError, match="far does not touch the rest") as raised:
        foldfab.foldabilize(loaded(tmp_path, parts=apart, direction="-z"))
    assert raised.value.parts == ("far",)


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"direction": [1, 1, 1]}, 1),
        ({"direction": "-z", "print": {"scale": 0.5}}, 1),
        ({"direction": "sideways"}, 2),
        ({"direction": "-z", "colour": "red"}, 2),
    ],
)
def test_an_error_leaves_no_files(
    tmp_path: Path, changes: dict[str, Any], status: int, capsys: pytest.CaptureFixture[str]
) -> None:
    path = recipe_file(tmp_path, **changes)
    assert cli.main(["print", str(path), "-o", str(tmp_path / "prints")]) == status
    assert capsys.readouterr().err.startswith("foldfab: ")
    assert list(tmp_path.iterdir()) == [path]


def test_an_error_leaves_the_old_print(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    prints = tmp_path / "prints"
    assert cli.main(["print", str(recipe_file(tmp_path, direction="-z")), "-q", "-o", str(prints)]) == 0
    before = contents(prints)
    for broken in ({"print": {"scale": 0.5}, "direction": "-z"}, {"direction": "sideways"}):
        assert cli.main(["print", str(recipe_file(tmp_path, **broken)), "-o", str(prints)]) > 0
        assert contents(prints) == before
    assert "foldfab: " in capsys.readouterr().err


@pytest.mark.parametrize("posture", ["open", "folded"])
@pytest.mark.parametrize("name", SMALL)
def test_a_shipped_recipe_prints_and_passes_its_own_check(tmp_path: Path, name: str, posture: str) -> None:
    folder = tmp_path / name
    assert cli.main(["print", name, "--posture", posture, "-q", "-o", str(tmp_path)]) == 0
    report = foldfab.check(folder)
    assert report.ok, [row for row in report.rows if not row.ok]
    assert json.loads((folder / "sheet.json").read_text())["posture"] == posture
    assert cli.main(["check", str(folder)]) == 0


def test_the_same_input_gives_the_same_bytes(tmp_path: Path) -> None:
    found = []
    for run in ("one", "two"):
        recipe = foldfab.load(SMALL[1])
        foldfab.write(foldfab.fabricate(foldfab.foldabilize(recipe)), tmp_path / run / SMALL[1])
        found.append(contents(tmp_path / run))
    assert sorted(found[0]) == sorted(found[1])
    assert [name for name in found[0] if found[0][name] != found[1][name]] == []


def test_a_print_can_be_made_from_the_recipe_in_its_folder(tmp_path: Path) -> None:
    folder = tmp_path / "first" / SMALL[0]
    foldfab.write(foldfab.fabricate(foldfab.foldabilize(foldfab.load(SMALL[0]))), folder)
    again = foldfab.load(str(folder / "recipe.json"), posture="folded")
    assert foldfab.foldabilize(again).cost == pytest.approx(json.loads((folder / "sheet.json").read_text())["cost"])


def recipe_file(folder: Path, **changes: Any) -> Path:
    """A recipe of a plain table, with changes."""
    path = folder / "table.json"
    path.write_text(json.dumps({"parts": TABLE, **changes}))
    return path


def loaded(folder: Path, **changes: Any) -> Any:
    """The recipe of a plain table, with changes."""
    return foldfab.load(str(recipe_file(folder, **changes)))


def fabricated(folder: Path, **changes: Any) -> Assembly:
    """The print of a plain table, with changes."""
    return foldfab.fabricate(foldfab.foldabilize(loaded(folder, **changes)))


def contents(folder: Path) -> dict[str, bytes]:
    """By path in the folder, the bytes of each file."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("ordering", ["greedy", "optimal"])
def test_what_is_pinned_forbidden_or_rigid_holds_from_the_file_to_the_facts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], ordering: str
) -> None:
    """Three walls under a board: one pinned, one with what it would do forbidden, one rigid by the command line."""
    parts: list[dict[str, Any]] = [
        {"name": "ground", "box": {"center": [0, 0, 10], "size": [900, 300, 20]}},
        {"name": "top", "box": {"center": [0, 0, 410], "size": [900, 300, 20]}},
    ]
    for name, x in (("left", -400), ("middle", 0), ("right", 400)):
        parts.append({"name": name, "box": {"center": [x, 0, 210], "size": [20, 250, 380]}})
    parts[2]["pin"] = {"side": "r"}
    parts[3]["forbid"] = [{"mechanism": "in-place"}, {"mechanism": "deleted"}]
    file = tmp_path / "walls.json"
    file.write_text(json.dumps({"name": "walls", "direction": "-z", "parts": parts}), encoding="utf-8")
    command = ["fold", str(file), "--ordering", ordering, "--json"]
    assert cli.main([*command, "--rigid", "right", "--verify"]) == 0
    facts = json.loads(capsys.readouterr().out)
    changed = {m["patch"]: m for m in facts["modifications"]}
    assert facts["ordering"] == ordering and changed["left"]["side"] == "r"
    assert changed["middle"]["mechanism"] == changed["right"]["mechanism"] == "slanted"
    # In place only, the rigid one has to be let go at its top, and the middle one has nothing left.
    assert cli.main([*command, "--rigid", "right", "--no-slanting"]) == 1
    refused = json.loads(capsys.readouterr().out)
    assert "pinned or forbidden for middle leaves middle nothing" in refused["reason"]
    assert {"with slanting allowed", "if middle is left free"} <= set(refused["advice"])
