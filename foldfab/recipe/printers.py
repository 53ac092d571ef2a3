"""Printers by the volume they can build."""

from __future__ import annotations

import re
from types import MappingProxyType

from foldfab.recipe.model import Printer

PRINTERS = MappingProxyType(
    {
        "makerbot-replicator-2": Printer("makerbot-replicator-2", (285.0, 153.0, 155.0)),
        "prusa-mk4": Printer("prusa-mk4", (250.0, 210.0, 220.0)),
        "prusa-mini": Printer("prusa-mini", (180.0, 180.0, 180.0)),
        "bambu-a1": Printer("bambu-a1", (256.0, 256.0, 256.0)),
        "ender-3": Printer("ender-3", (220.0, 220.0, 250.0)),
    }
)
"""Known printers by id."""

DEFAULT_PRINTER = PRINTERS["prusa-mk4"]
"""What a recipe is printed on that does not say."""

SMALLEST, LARGEST = 20.0, 5000.0
"""Limits of a side of a build volume, mm."""


def printer(text: str) -> Printer:
    """The known printer of that id, or one of the user's own such as `200x200x180` (mm).

    Raises:
        ValueError: neither; the message lists the choices.
    """
    if text in PRINTERS:
        return PRINTERS[text]
    sides = re.fullmatch(r"(\d+(?:\.\d+)?)\s*[x×]\s*(\d+(?:\.\d+)?)\s*[x×]\s*(\d+(?:\.\d+)?)", text.strip())
    if sides is None:
        raise ValueError(f"should be {choices()}, not {text!r}")
    x, y, z = (float(side) for side in sides.groups())
    if not all(SMALLEST <= side <= LARGEST for side in (x, y, z)):
        raise ValueError(f"should have sides from {SMALLEST:g} to {LARGEST:g} mm, not {text!r}")
    return Printer(f"{x:g}x{y:g}x{z:g}", (x, y, z))


def choices() -> str:
    """What may stand for a printer on the command line, for messages."""
    return f"one of {', '.join(PRINTERS)}, or a build volume of your own such as 200x200x180"
