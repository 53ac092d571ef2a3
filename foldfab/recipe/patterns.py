"""What a pinned or forbidden modification may say: on cutting points, within the hinges allowed, and possible at all.

Each question is answered with the end of a sentence that says what is wrong, or None where nothing is.
"""

from __future__ import annotations

from collections.abc import Sequence

from foldfab.recipe.model import Pattern

SNAP = 1e-3
"""How far an edge of a window may be from a cutting point; with up to 20 pieces different ones are 1/380 apart."""


def window_problem(window: Sequence[float], steps: int | None) -> str | None:
    """Why `window` is not one of a part that is cut into `steps` pieces; None where it is not known how many."""
    low, high = window
    if low >= high:
        return f"should begin before it ends, such as [0, 0.4], not {_told(window)}"
    if steps is None:
        return None
    nearest = snapped(window, steps)
    if max(abs(low - nearest[0]), abs(high - nearest[1])) <= SNAP:
        return None
    return (
        f"{_told(window)} does not lie on the cuts of fold.shrink_steps {steps}, which are multiples of 1/{steps}; "
        f"the nearest window is {_told(nearest)}"
    )


def snapped(window: Sequence[float], steps: int) -> tuple[float, float]:
    """The window of one piece or more that is nearest to `window`."""
    low, high = (round(edge * steps) for edge in window)
    if low == high:
        # One piece: that which the middle of the window lies in.
        low = min(int(sum(window) / 2 * steps), steps - 1)
        high = low + 1
    return (low / steps, high / steps)


def hinges_problem(hinges: int, most: int | None) -> str | None:
    """Why a part cannot get that many hinges where `most` are allowed; None where it is not known how many."""
    return None if most is None or hinges <= most else f"{hinges} is more than fold.max_hinges {most} allows"


def pattern_problem(pattern: Pattern) -> str | None:
    """Why no modification is like `pattern`."""
    said = [name for name in ("hinges", "side", "window") if getattr(pattern, name) is not None]
    if pattern.mechanism == "deleted" and said:
        return f'asks for "deleted" and for {", ".join(said)}; what is taken away has none'
    if pattern.mechanism == "slanted" and pattern.hinges:
        return f'asks for "slanted" and {pattern.hinges} hinges; what is slanted gets none'
    if pattern.mechanism == "in-place" and pattern.hinges == 0:
        return 'asks for "in-place" without hinges; without them a part is "slanted"'
    return None


def rigid_problem(pin: Pattern) -> str | None:
    """Why a part that is not hingeable cannot be modified like `pin`."""
    if pin.hinges or pin.mechanism == "in-place":
        asked = f"hinges {pin.hinges}" if pin.hinges else '"in-place"'
        return f'asks for {asked}, which the part cannot have because it is "hingeable": false'
    return None


def is_covered(pin: Pattern, forbid: Pattern) -> bool:
    """Whether everything that `pin` lets through is forbidden."""
    pairs = ((getattr(pin, name), getattr(forbid, name)) for name in Pattern.__slots__)
    return all(said is None or said == asked for asked, said in pairs)


def _told(window: Sequence[float]) -> str:
    """A window as it may be written in a recipe."""
    return "[" + ", ".join(f"{edge:.4g}" for edge in window) + "]"
