"""Work is counted and not timed, so that the same furniture always gets the same answer.

The charges are about what each thing takes on an ordinary machine, in seconds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SWEEPING = 2.5e-3
"""A lane that is swept and held against the others of its unit."""
LOOKING = 1e-4
"""A lane that is held against what stands around its unit."""
SEARCHING = 4e-4
"""A patch for which the cheapest option is looked for."""
PLAYING = 3e-3
"""A patch that is played through, with what is looked at for that."""
ENGINE = 1.6
"""A unit of CP-SAT's deterministic time on conflict graphs."""
STARTING = 0.04
"""A conflict graph that is handed to CP-SAT."""


@dataclass(slots=True, eq=False)
class Work:
    """How much may be done, and how much has been done, s."""

    limit: float = np.inf
    spent: float = 0.0

    @property
    def left(self) -> float:
        """What may still be done; negative where too much has been done already."""
        return self.limit - self.spent

    def charge(self, seconds: float) -> None:
        """Counts something that has been done."""
        self.spent += seconds
