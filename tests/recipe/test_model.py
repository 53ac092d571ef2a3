"""The noun of the room stands alone."""

from __future__ import annotations

import subprocess
import sys


def test_the_model_does_not_import_pydantic() -> None:
    code = "import sys, foldfab.recipe.model; sys.exit('pydantic' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
