"""What is written about the house is true, and the house keeps to its own rules."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "foldfab"
MODULES = sorted(PACKAGE.rglob("*.py"))
NAMES = [path.relative_to(ROOT).as_posix() for path in MODULES]
TOP_FOLDERS = ("foldfab", "recipes", "tests", "benchmarks", ".ci")
HEAVY = ("build123d", "trimesh", "manifold3d", "PIL", "lib3mf", "scipy")
LONGEST_FILE, LONGEST_FUNCTION, LONGEST_DESIGN = 400, 40, 200


def test_design_is_short() -> None:
    assert len(design().splitlines()) < LONGEST_DESIGN


def test_design_names_only_what_exists() -> None:
    named = named_paths(design())
    assert named, "DESIGN.md names no module"
    assert missing(named) == []


@pytest.mark.parametrize(
    "text",
    ["see `foldfab/folding/guess.py`", "see `folding.guess`", "    foldfab/\n      guess.py    wrong", "`tests/guess`"],
)
def test_a_wrong_name_in_design_is_noticed(text: str) -> None:
    assert missing(named_paths(text))


def test_a_right_name_in_design_is_not_complained_about() -> None:
    tree = "    foldfab/\n      cli.py    argv\n      folding/  the fold: model, solve\n"
    assert missing(named_paths(f"`foldfab/folding/model.py`, `folding.kinematics` and `foldfab.load`\n{tree}")) == []


def test_the_readme_and_the_ci_run_the_same_tests() -> None:
    command = readme_test_command((ROOT / "README.md").read_text(encoding="utf-8"))
    lines = [line.strip() for line in (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()]
    assert lines.count(command) == 1


@pytest.mark.parametrize("path", MODULES, ids=NAMES)
def test_a_module_keeps_the_house_rules(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    assert ast.get_docstring(tree), "no docstring"
    assert len(text.splitlines()) <= LONGEST_FILE
    assert [name for name, length in functions(tree) if length > LONGEST_FUNCTION] == []
    if path != PACKAGE / "cli.py":
        assert list(outspoken(tree)) == [], "only cli.py prints or exits"


@pytest.mark.parametrize("line", ["print(1)", "sys.exit(1)", "exit()", "input()", "os._exit(1)", "raise SystemExit(2)"])
def test_an_outspoken_module_is_noticed(line: str) -> None:
    assert list(outspoken(ast.parse(f"def f():\n    {line}\n")))


def test_importing_foldfab_is_light() -> None:
    code = f"import sys, foldfab, foldfab.cli; print([name for name in {HEAVY!r} if name in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, encoding="utf-8", check=True)
    assert run.stdout.strip() == "[]"


def test_the_public_names() -> None:
    package = import_module("foldfab")
    assert package.__all__ == sorted(package.__all__)
    assert [name for name in package.__all__ if not hasattr(package, name)] == []


def design() -> str:
    """The text of DESIGN.md."""
    return (ROOT / "DESIGN.md").read_text(encoding="utf-8")


def readme_test_command(readme: str) -> str:
    """The one command of the README that ends in the tests."""
    found = [line.strip() for line in readme.splitlines() if line.startswith("    ") and "-m pytest" in line]
    assert len(found) == 1
    return found[0]


def named_paths(text: str) -> list[str]:
    """Paths and dotted modules of ours in backticks, and the paths of trees that are drawn by indentation."""
    quoted = [word for words in re.findall(r"`([^`\n]+)`", text) for word in words.split()]
    rooms = {path.name for path in PACKAGE.iterdir() if path.is_dir() and not path.name.startswith("_")}
    paths = [word.rstrip(".,:;") for word in quoted if word.split("/")[0] in TOP_FOLDERS and "/" in word]
    dotted = [word for word in quoted if re.fullmatch(r"[a-z_0-9]+(\.[a-z_0-9]+)+", word)]
    modules = [f"foldfab.{word}" for word in dotted if word.split(".")[0] in rooms and not word.endswith(".py")]
    return [*paths, *modules, *drawn_paths(text)]


def drawn_paths(text: str) -> Iterator[str]:
    """The paths of a tree: a line `foldfab/` and below it, further in, names that end in `/` or `.py`."""
    folders: list[tuple[int, str]] = []
    for line in text.splitlines():
        drawn = re.match(r"^( *)([\w.]+/|[\w.]+\.py)(?: |$)", line)
        if not drawn:
            if line.strip() and folders and len(line) - len(line.lstrip()) <= folders[0][0]:
                folders = []
            continue
        indent, name = len(drawn[1]), drawn[2]
        folders = [folder for folder in folders if folder[0] < indent]
        if folders or name.rstrip("/") in TOP_FOLDERS:
            yield "".join(folder for _, folder in folders) + name
            folders += [(indent, name)] if name.endswith("/") else []


def missing(names: list[str]) -> list[str]:
    """Those that are neither a path of the repository nor a module or one of its names."""
    return [name for name in names if not (any(ROOT.glob(name)) if "/" in name else is_module(name))]


def is_module(name: str) -> bool:
    """Whether a dotted name is a module of ours, or a name in one."""
    place = ROOT / name.replace(".", "/")
    if place.is_dir() or place.with_suffix(".py").is_file():
        return True
    return place.parent.with_suffix(".py").is_file() and hasattr(import_module(name.rpartition(".")[0]), place.name)


def functions(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Each function's name and number of lines."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, (node.end_lineno or node.lineno) - node.lineno + 1


def outspoken(tree: ast.AST) -> Iterator[str]:
    """What prints, asks or exits."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            called = ast.unparse(node.func)
            if called in ("print", "input", "exit", "quit", "sys.exit", "os._exit", "SystemExit", "breakpoint"):
                yield f"{called} in line {node.lineno}"
        elif isinstance(node, ast.Attribute) and ast.unparse(node) in ("sys.stdout", "sys.stderr"):
            yield f"{ast.unparse(node)} in line {node.lineno}"
