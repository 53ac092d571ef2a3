"""A Recipe becomes JSON data again: the recipe as it was understood."""

from __future__ import annotations

import json
from typing import Any

from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Pair, Part, Pattern, PrintOptions, Recipe


def to_json(recipe: Recipe) -> dict[str, Any]:
    """JSON data with every part a named box and all defaults filled in; parsing it gives the same recipe."""
    return {
        "name": recipe.name,
        "about": recipe.about,
        "units": "mm",
        "direction": "auto" if recipe.direction is None else _floats(recipe.direction),
        "parts": [_part(part) for part in recipe.parts],
        **{key: [list(pair) for pair in pairs] for key, pairs in _contacts(recipe).items() if pairs},
        "fold": {
            "alpha": recipe.fold.alpha,
            "max_hinges": recipe.fold.max_hinges,
            "shrink_steps": recipe.fold.shrink_steps,
            "slanting": recipe.fold.slanting,
            "stay_in_box": recipe.fold.stay_in_box,
            "ordering": recipe.fold.ordering,
            "collisions": recipe.fold.collisions,
            "symmetry": recipe.fold.symmetry,
            "time_limit": recipe.fold.time_limit,
        },
        "print": _print(recipe.print),
    }


def as_text(recipe: Recipe) -> str:
    """A recipe file as one would write it by hand, one part a line; reading it gives the same recipe."""
    data = to_json(recipe)
    parts = ",\n".join(f"    {_line(_brief(part))}" for part in data["parts"])
    rest = {key: f"[\n{parts}\n  ]" if key == "parts" else _line(value) for key, value in data.items()}
    return "{\n" + ",\n".join(f"  {_line(key)}: {text}" for key, text in rest.items()) + "\n}\n"


def _contacts(recipe: Recipe) -> dict[str, tuple[Pair, ...]]:
    return {"touching": recipe.touching, "apart": recipe.apart}


def _brief(part: dict[str, Any]) -> dict[str, Any]:
    """The part without what is so by default."""
    is_level = part["box"]["axes"] == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    box = {key: value for key, value in part["box"].items() if key != "axes" or not is_level}
    told = ("name", "box", *(["hingeable"] if part["hingeable"] else []))
    rest = {key: value for key, value in part.items() if key not in told}
    return {"name": part["name"], "box": box, **rest}


def _line(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def _part(part: Part) -> dict[str, Any]:
    box = {"center": _floats(part.center), "size": _floats(part.size), "axes": [_floats(row) for row in part.axes]}
    written = {"name": part.name, "box": box, "hingeable": part.hingeable}
    if part.pin is not None:
        written["pin"] = _pattern(part.pin)
    if part.forbid:
        written["forbid"] = [_pattern(pattern) for pattern in part.forbid]
    if part.thickness is not None:
        written["thickness"] = part.thickness
    if part.look is not None:
        written["shape"] = part.look
    return written


def _pattern(pattern: Pattern) -> dict[str, Any]:
    """Only what it asks for."""
    window = None if pattern.window is None else list(pattern.window)
    asked = {"mechanism": pattern.mechanism, "hinges": pattern.hinges, "side": pattern.side, "window": window}
    return {key: value for key, value in asked.items() if value is not None}


def _print(options: PrintOptions) -> dict[str, Any]:
    return {
        "printer": {"name": options.printer.name, "build_volume": list(options.printer.build_volume)},
        "thickness": "auto" if options.may_thin else options.thickness,
        "base_thickness": options.base_thickness,
        "own_thickness": options.own_thickness,
        "clearance": options.clearance,
        "nozzle": options.nozzle,
        "layer": options.layer,
        "material": options.material,
        "posture": options.posture,
        "hinge": options.hinge,
        "shape": options.shape,
        "latch": options.latch,
        "scale": "fit" if options.scale is None else options.scale,
    }


def _floats(vector: Array) -> list[float]:
    """Without negative zeros, which read badly."""
    return [float(entry) + 0.0 for entry in vector]
