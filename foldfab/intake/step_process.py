"""The process that reads a STEP file: its path comes as the argument, its bodies leave as arrays on standard output.

`python -m foldfab.intake.step_process FILE`.
"""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

from foldfab.errors import MissingLibraryError, RecipeError
from foldfab.intake.limits import LARGEST_DATA, LARGEST_MEMORY, LONGEST_SECONDS

REFUSED, MISSING = "refused", "missing"
"""What a message is packed as: the file holds nothing of use; build123d is not there."""


def main(file: str) -> None:
    """Reads, and writes what it found or why it found nothing."""
    # The reader talks on the standard output.
    out = os.dup(1)
    os.dup2(2, 1)
    _limit()
    arrays = _read(Path(file))
    memory = io.BytesIO()
    np.savez(memory, **arrays)
    with os.fdopen(out, "wb") as stream:
        stream.write(memory.getbuffer())


def _read(path: Path) -> dict[str, Any]:
    """By name: the names of bodies, their vertices v0, v1, … and faces f0, f1, …; or one message."""
    from foldfab.intake.solids import read_step

    try:
        found = read_step(path)
    except MissingLibraryError as error:
        return {MISSING: np.array(str(error))}
    except RecipeError as error:
        return {REFUSED: np.array("; ".join(problem.text for problem in error.problems))}
    except MemoryError:
        return {REFUSED: np.array("needs more memory than a piece of furniture should; export a coarser one")}
    vertices = {f"v{i}": body.mesh.vertices for i, body in enumerate(found)}
    faces = {f"f{i}": body.mesh.faces for i, body in enumerate(found)}
    return {"names": np.array([body.name for body in found]), **vertices, **faces}


def _limit() -> None:
    """No more memory and time than a reader needs, and no core dump, where the system can see to it."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (LARGEST_MEMORY, LARGEST_MEMORY))
    resource.setrlimit(resource.RLIMIT_DATA, (LARGEST_DATA, LARGEST_DATA))
    resource.setrlimit(resource.RLIMIT_CPU, (int(LONGEST_SECONDS), int(LONGEST_SECONDS) + 5))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    main(sys.argv[1])
