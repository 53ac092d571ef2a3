"""What is written is what was read."""

from __future__ import annotations

import json
import math
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from foldfab.recipe.read import parse
from foldfab.recipe.write import to_json

coordinates = st.floats(-1e4, 1e4)
lengths = st.floats(0.1, 1e4)
directions = st.sampled_from(["x", "+x", "-z", "auto"]) | st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(
    lambda vector: math.hypot(*vector) > 1e-6
)


@st.composite
def axes(draw: st.DrawFn) -> list[list[float]]:
    """Three orthonormal rows with rounding errors."""
    a, b = draw(st.floats(0, 7)), draw(st.floats(0, 7))
    ca, sa, cb, sb = math.cos(a), math.sin(a), math.cos(b), math.sin(b)
    rows = [[ca, sa, 0.0], [-sa * cb, ca * cb, sb], [sa * sb, -ca * sb, cb]]
    return [[round(entry, draw(st.sampled_from([4, 8, 17]))) for entry in row] for row in rows]


@st.composite
def patterns(draw: st.DrawFn, steps: int, most: int) -> dict[str, Any]:
    """A pattern of something that is kept, with rounding errors in its window."""
    low = draw(st.integers(0, steps - 1))
    window = [low / steps, draw(st.integers(low + 1, steps)) / steps]
    asked = {
        "hinges": draw(st.integers(0, most)),
        "side": draw(st.sampled_from(["l", "r"])),
        "window": [round(edge, draw(st.sampled_from([3, 17]))) for edge in window],
    }
    kept = draw(st.sets(st.sampled_from(sorted(asked)), min_size=1))
    return {key: value for key, value in asked.items() if key in kept}


@st.composite
def modifications(draw: st.DrawFn, steps: int, most: int) -> dict[str, Any]:
    """What may be done to a part."""
    forbid = draw(st.lists(patterns(steps, most), max_size=2))
    free = {"hingeable": draw(st.booleans()), "forbid": [{"mechanism": "deleted"}, *forbid]}
    pinned = {"hingeable": True, "pin": draw(patterns(steps, most))}
    return draw(st.sampled_from([{"hingeable": False}, free, pinned]))


@st.composite
def recipes(draw: st.DrawFn) -> dict[str, Any]:
    """JSON data of a valid recipe."""
    steps, most = draw(st.integers(1, 20)), draw(st.integers(1, 9))
    parts = [
        {
            "name": f"part-{i}",
            "box": {
                "center": draw(st.lists(coordinates, min_size=3, max_size=3)),
                "size": draw(st.lists(lengths, min_size=3, max_size=3)),
                "axes": draw(axes()),
            },
            **draw(modifications(steps, most)),
            **draw(st.sampled_from([{}, {"shape": "own"}, {"shape": "plain"}])),
        }
        for i in range(draw(st.integers(1, 3)))
    ]
    fold = {
        "alpha": draw(st.floats(0, 1)),
        "max_hinges": most,
        "shrink_steps": steps,
        "slanting": draw(st.booleans()),
        "ordering": draw(st.sampled_from(["greedy", "optimal"])),
        "collisions": draw(st.sampled_from(["swept", "regions"])),
        "symmetry": draw(st.booleans()),
        "time_limit": draw(st.floats(0.001, 3600)),
    }
    options = {
        "scale": draw(st.just("fit") | st.floats(0.01, 10)),
        "printer": draw(st.sampled_from(["ender-3", {"name": "mine", "build_volume": [100, 200, 300]}])),
        "posture": draw(st.sampled_from(["open", "folded"])),
    }
    units = draw(st.sampled_from(["mm", "in"]))
    return {"units": units, "direction": draw(directions), "parts": parts, "fold": fold, "print": options}


@given(recipes())
def test_round_trip(data: dict[str, Any]) -> None:
    written = to_json(parse(data, "any.json", "any"))
    assert data["fold"].items() <= written["fold"].items()
    again = json.loads(json.dumps(written, allow_nan=False))
    assert to_json(parse(again, "again.json", "unused")) == written
