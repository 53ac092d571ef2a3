"""Exit statuses, and what goes where."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

import pytest

import foldfab
from foldfab import advice, cli, report
from foldfab.errors import FoldingError, Problem, RecipeError
from foldfab.fabrication.model import Finding
from foldfab.validity.model import Verdict, Violation

WRONG = RecipeError("bench.json", (Problem("parts", "is missing"),))


class Pipeline(types.ModuleType):
    """A pipeline that remembers its calls; what it should raise or return is set by name."""

    def __init__(self) -> None:
        super().__init__("foldfab.pipeline")
        self.calls: list[tuple[Any, ...]] = []
        self.fails: dict[str, BaseException] = {}
        self.findings: tuple[Finding, ...] = ()
        self.rows: tuple[Any, ...] = ()
        self.violations: tuple[Violation, ...] = ()
        self.helps: tuple[str, ...] = ()
        for name in (
            "load",
            "foldabilize",
            "alternatives",
            "fabricate",
            "examine",
            "write",
            "printable",
            "check",
            "shipped",
            "compose",
            "save",
        ):
            setattr(self, name, self._verb(name))
        self.prepare = lambda: None

    def _verb(self, name: str) -> Any:
        def verb(*arguments: Any, **options: Any) -> Any:
            self.calls.append((name, arguments, options))
            if name in self.fails:
                raise self.fails[name]
            return self._result(name)

        return verb

    def _result(self, name: str) -> Any:
        return {
            "load": types.SimpleNamespace(
                name="bench", about="A bench.", notes=(), print=types.SimpleNamespace(posture="open")
            ),
            "alternatives": ("one", "two"),
            "fabricate": types.SimpleNamespace(findings=self.findings),
            "check": types.SimpleNamespace(rows=self.rows, ok=all(row.ok for row in self.rows)),
            "shipped": (Path("bench.json"),),
            "compose": types.SimpleNamespace(name="bench-4x4", parts=("seat", "back")),
            "examine": Verdict(120, 3, self.violations),
        }.get(name)

    def names(self) -> list[str]:
        """The verbs that were called, in order."""
        return [call[0] for call in self.calls]


@pytest.fixture
def pipeline(monkeypatch: pytest.MonkeyPatch) -> Pipeline:
    """The pipeline that the command line finds, and reports of one line."""
    fake = Pipeline()
    monkeypatch.setattr(advice, "what_would_help", lambda recipe: fake.helps)
    monkeypatch.setitem(sys.modules, "foldfab.pipeline", fake)
    monkeypatch.setattr(foldfab, "pipeline", fake, raising=False)
    monkeypatch.setattr(report, "summary", lambda assembly, folder, printable: f"summary of {folder}")
    monkeypatch.setattr(report, "fold_table", lambda solution, milliseconds: "table")
    monkeypatch.setattr(report, "fold_facts", lambda solution, milliseconds: {"status": "folded"})
    monkeypatch.setattr(report, "alternatives_table", lambda solutions, milliseconds: f"table of {len(solutions)}")
    monkeypatch.setattr(report, "alternatives_facts", lambda solutions, milliseconds: {"alternatives": list(solutions)})
    return fake


def row(code: str, ok: bool) -> Any:
    """A checked thing."""
    return types.SimpleNamespace(code=code, ok=ok, text=f"{code} was looked at", facts={"figure": 3})


def test_print_walks_the_corridor(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["print", "bench", "-o", "out"]) == 0
    assert pipeline.names() == ["load", "foldabilize", "fabricate", "write", "printable"]
    assert pipeline.calls[-2][1][1] == Path("out/bench")
    assert capsys.readouterr() == (f"summary of {Path('out/bench')}\n", "")


def test_quiet(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["print", "bench", "-q"]) == 0
    assert capsys.readouterr() == ("", "")


def test_only_given_options_override(pipeline: Pipeline) -> None:
    cli.main(["fold", "bench"])
    assert pipeline.calls[0] == ("load", ("bench",), {})


def test_all_options(pipeline: Pipeline) -> None:
    line = "fold bench --direction -z --posture folded --printer ender-3 --scale 1:5 --clearance 0.2 --thickness 3"
    more = "--alpha 0.1 --max-hinges 5 --shrink-steps 4 --no-slanting --stay-in-box"
    last = "--ordering optimal --collisions regions --symmetry --time-limit 30 --rigid seat --rigid -back"
    assert cli.main([*line.split(), *more.split(), *last.split()]) == 0
    assert pipeline.calls[0][2] == {
        "direction": "-z",
        "posture": "folded",
        "printer": "ender-3",
        "scale": "1:5",
        "clearance": "0.2",
        "thickness": "3",
        "alpha": "0.1",
        "max_hinges": "5",
        "shrink_steps": "4",
        "slanting": False,
        "stay_in_box": True,
        "ordering": "optimal",
        "collisions": "regions",
        "symmetry": True,
        "time_limit": "30",
        "rigid": ["seat", "-back"],
    }


def test_fold(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fold", "bench"]) == 0
    assert cli.main(["fold", "bench", "--json"]) == 0
    assert capsys.readouterr().out == 'table\n{\n "status": "folded"\n}\n'


def test_compose(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["compose", "bench", "4x4"]) == 0
    assert cli.main(["compose", "bench", "4x4", "-o", "many.json"]) == 0
    assert [call[1] for call in pipeline.calls if call[0] == "compose"] == [("bench", "4x4")] * 2
    assert [call[1][1] for call in pipeline.calls if call[0] == "save"] == [Path("bench-4x4.json"), Path("many.json")]
    assert capsys.readouterr() == ("bench-4x4.json: 2 parts\nmany.json: 2 parts\n", "")


def test_what_cannot_be_composed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["compose", "chair", "0x3"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "kind: should be one of bench, building, hexagon, shelf" in err
    assert "grid: should have 1 to 32 columns" in err


def test_fold_verified(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fold", "bench", "--verify"]) == 0
    told = "valid: 120 moments, 3 hinges beyond the spanning tree, with and without thickness"
    assert capsys.readouterr().out == f"table\n\n{told}\n"
    assert cli.main(["fold", "bench", "--verify", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"status": "folded", "valid": True, "violations": []}


def test_fold_found_invalid(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    text = "with thickness, at t = 0.500: seat and back share up to 1.00 mm"
    pipeline.violations = (Violation("collision", "with thickness", 0.5, ("seat", "back"), 1.0, text),)
    assert cli.main(["fold", "bench", "--verify"]) == 1
    assert capsys.readouterr().out == f"table\n\nnot valid\n  {text}\n"
    assert cli.main(["fold", "bench", "--verify", "--json"]) == 1
    facts = json.loads(capsys.readouterr().out)
    assert facts["valid"] is False
    assert facts["violations"][0] == {
        "kind": "collision",
        "model": "with thickness",
        "time": 0.5,
        "parts": ["seat", "back"],
        "amount": 1.0,
        "text": text,
    }


def test_refused(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    pipeline.fails["foldabilize"] = FoldingError("seat cannot fold")
    assert cli.main(["fold", "bench"]) == 1
    assert capsys.readouterr() == ("", "foldfab: seat cannot fold\n")
    assert cli.main(["fold", "bench", "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == {"status": "refused", "reason": "seat cannot fold", "advice": []}


def test_a_refusal_says_what_would_help(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    pipeline.fails["foldabilize"] = FoldingError("seat cannot fold")
    pipeline.helps = ("along -x", "with slanting allowed")
    for command in ("fold", "print"):
        assert cli.main([command, "bench"]) == 1
        told = "foldfab: seat cannot fold\n  it would fold along -x, or with slanting allowed\n"
        assert capsys.readouterr() == ("", told)
    assert cli.main(["fold", "bench", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["advice"] == ["along -x", "with slanting allowed"]


def test_what_is_wrong_with_a_recipe_gets_no_advice(
    pipeline: Pipeline, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Advice takes a solve for each change; it is for furniture that does not fold."""
    monkeypatch.setattr(advice, "what_would_help", lambda recipe: pytest.fail("asked"))
    pipeline.fails["foldabilize"] = WRONG
    assert cli.main(["fold", "bench"]) == 2
    assert "parts: is missing" in capsys.readouterr().err


def test_alternatives(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fold", "bench", "--alternatives", "20"]) == 0
    assert pipeline.names() == ["load", "alternatives"]
    assert pipeline.calls[1][1][1] == 20
    assert capsys.readouterr().out == "table of 2\n"
    assert cli.main(["fold", "bench", "--alternatives", "1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"alternatives": ["one", "two"]}
    pipeline.fails["alternatives"] = FoldingError("seat cannot fold")
    assert cli.main(["fold", "bench", "--alternatives", "2", "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == {"status": "refused", "reason": "seat cannot fold", "advice": []}


@pytest.mark.parametrize("count", ["0", "21", "-1", "2.5", "many", "", "²"])
def test_how_many_alternatives(count: str, pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fold", "bench", f"--alternatives={count}"]) == 2
    assert f"should be a whole number from 1 to 20, not {count!r}" in capsys.readouterr().err
    assert pipeline.names() == []


@pytest.mark.parametrize("command", [["print", "bench"], ["fold", "bench"], ["fold", "bench", "--json"]])
def test_bad_input(command: list[str], pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    pipeline.fails["load"] = WRONG
    assert cli.main(command) == 2
    assert capsys.readouterr() == ("", "foldfab: bench.json: 1 problem\n  parts: is missing\n")
    assert pipeline.names() == ["load"]


def test_a_fatal_finding_stops_the_print(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    pipeline.findings = (Finding("clash", "seat meets back", is_fatal=True),)
    assert cli.main(["print", "bench"]) == 1
    assert "seat meets back" in capsys.readouterr().err
    assert "write" not in pipeline.names()


@pytest.mark.parametrize(("rows", "status"), [((("stl", True),), 0), ((("stl", True), ("gap", False)), 1)])
def test_check(
    rows: tuple[tuple[str, bool], ...], status: int, pipeline: Pipeline, capsys: pytest.CaptureFixture[str]
) -> None:
    pipeline.rows = tuple(row(code, ok) for code, ok in rows)
    assert cli.main(["check", "prints/bench"]) == status
    assert ("FAIL" in capsys.readouterr().out) == bool(status)
    assert cli.main(["check", "prints/bench", "--json"]) == status
    facts = json.loads(capsys.readouterr().out)
    assert [check["ok"] for check in facts["checks"]] == [ok for _, ok in rows]
    assert {check["figure"] for check in facts["checks"]} == {3}


@pytest.mark.parametrize(
    ("options", "slicer"),
    [([], None), (["--slicer"], ""), (["--slicer=/opt/prusa"], "/opt/prusa"), (["--slicer="], "")],
)
@pytest.mark.parametrize("is_first", [True, False])
def test_check_with_a_slicer(options: list[str], slicer: str | None, is_first: bool, pipeline: Pipeline) -> None:
    folder = ["prints/bench"]
    assert cli.main(["check", *(options + folder if is_first else folder + options)]) == 0
    assert pipeline.calls == [("check", (Path("prints/bench"),), {"slicer": slicer})]


def test_recipes(pipeline: Pipeline, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["recipes"]) == 0
    assert capsys.readouterr().out == "bench  A bench.\n"


@pytest.mark.parametrize(
    ("error", "status", "words"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (ZeroDivisionError("oh\nno"), 70, "a bug in foldfab (ZeroDivisionError: oh no)"),
        (OSError(28, "No space left on device", "prints/bench"), 2, "prints/bench: No space left on device"),
        (PermissionError(13, "Permission denied", "prints"), 2, "may you write there"),
    ],
)
def test_one_line_for_what_goes_wrong(
    error: BaseException, status: int, words: str, pipeline: Pipeline, capsys: pytest.CaptureFixture[str]
) -> None:
    pipeline.fails["write"] = error
    assert cli.main(["print", "bench"]) == status
    out, err = capsys.readouterr()
    assert out == ""
    assert words in err
    assert err.count("\n") == 1


def test_traceback_on_request(
    pipeline: Pipeline, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FOLDFAB_DEBUG", "1")
    pipeline.fails["load"] = ZeroDivisionError()
    assert cli.main(["fold", "bench"]) == 70
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize("argv", [[], ["fold"], ["saw", "bench"], ["fold", "bench", "--alph", "1"], ["check"]])
def test_usage_errors(argv: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(argv) == 2
    assert "usage" in capsys.readouterr().err


def test_version_and_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--version"]) == 0
    assert cli.main(["--help"]) == 0
    assert capsys.readouterr().out.startswith("foldfab ")


def test_progress_only_on_a_terminal(
    pipeline: Pipeline, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    cli.main(["print", "bench"])
    assert "building the solids" in capsys.readouterr().err
    cli.main(["print", "bench", "-q"])
    assert capsys.readouterr().err == ""


def test_help_is_fast_and_a_closed_pipe_is_quiet() -> None:
    # Processor time, not wall time: other tests run beside this one.
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run(
        [sys.executable, "-m", "foldfab.cli", "--help"], capture_output=True, text=True, encoding="utf-8", check=True
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 0.5
    assert "print" in run.stdout
    closed = f"{sys.executable} -m foldfab.cli print --help | true"
    piped = subprocess.run(closed, shell=True, capture_output=True, text=True, encoding="utf-8", check=True)
    assert piped.stderr == ""


def test_auto_is_settled_before_it_is_folded(monkeypatch: pytest.MonkeyPatch) -> None:

    from foldfab import postures

    recipe = types.SimpleNamespace(print=types.SimpleNamespace(posture="auto"))
    monkeypatch.setattr(postures, "settled", lambda recipe, tell: "settled")
    assert cli._settled(recipe, cli._Progress(is_quiet=True)) == "settled"  # type: ignore[arg-type, comparison-overlap]


def test_a_recipe_is_written_as_it_was_understood(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "leg.obj"
    file.write_text(
        "g leg\nv 0 0 0\nv 40 0 0\nv 0 30 0\nv 0 0 700\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n", encoding="utf-8"
    )
    assert cli.main(["recipe", str(file), "--units", "cm"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["parts"][0]["box"]["size"] == [400, 300, 7000]
    assert err.startswith("note: no boxes, taken as their boxes, which are off by: leg ")
    assert cli.main(["recipe", str(file), "-q"]) == 0
    assert capsys.readouterr().err == ""


def test_a_recipe_of_boxes_is_read_without_heavy_libraries() -> None:
    heavy = ("build123d", "OCP", "trimesh", "manifold3d", "scipy", "lib3mf")
    code = f"""
import sys
from foldfab.cli import main
main(["recipe", "bench"])
print([name for name in {heavy} if name in sys.modules])
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, encoding="utf-8", check=True)
    assert run.stdout.splitlines()[-1] == "[]"


def test_a_file_that_is_not_what_it_says_is_bad_input(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "chair.step").write_bytes(b"glTF")
    assert cli.main(["print", str(tmp_path / "chair.step"), "-o", str(tmp_path / "out")]) == 2
    assert "rename it to .glb" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
