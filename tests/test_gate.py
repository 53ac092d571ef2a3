"""The gate: formatting, lint, types and layers hold. One command, `pytest`, runs them all."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LAYERS = "import sys; from importlinter.cli import lint_imports_command; sys.exit(lint_imports_command())"


@pytest.mark.parametrize(
    ("module", "command"),
    [
        ("ruff", ["-m", "ruff", "check", "."]),
        ("ruff", ["-m", "ruff", "format", "--check", "."]),
        ("mypy", ["-m", "mypy"]),
        ("importlinter", ["-c", LAYERS]),
    ],
    ids=["ruff check", "ruff format", "mypy", "import-linter"],
)
def test_the_gate(module: str, command: list[str]) -> None:
    if find_spec(module) is None:
        pytest.skip(f"{module} is not installed; pip install -e '.[test]'")
    run = subprocess.run(
        [sys.executable, *command], cwd=ROOT, capture_output=True, text=True, encoding="utf-8", check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr
