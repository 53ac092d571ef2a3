"""What pydantic finds wrong with a recipe, said in our own words and with places such as `parts[2].box.size`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from types import MappingProxyType

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from foldfab.errors import Problem
from foldfab.recipe.fields import MOST_PARTS, MOST_PATTERNS, OWN_WORDS, TAGS
from foldfab.recipe.form import BoxForm, FoldForm, Form, PartForm, PatternForm, PrinterForm, PrintForm, RecipeForm
from foldfab.recipe.printers import LARGEST, PRINTERS, SMALLEST

Location = tuple[int | str, ...]

TOP = "recipe"
"""The place of the whole file."""

EXPECTED = MappingProxyType(
    {
        "": "an object with a list of parts",
        "$schema": "text",
        "name": "text that can be a name",
        "about": "one line of text, at most 500 characters",
        "units": 'one of "mm", "cm", "m", "in"',
        "direction": 'one of "x", "-x", "y", "-y", "z", "-z", "auto", or three numbers such as [0, 0, -1]',
        "direction[]": "a finite number",
        "parts": f"a list of 1 to {MOST_PARTS} parts",
        "model": 'the name of a file of shapes such as "chair.step"',
        "mesh": 'the name of a file of shapes such as "back.obj"',
        "ignore": "true or false",
        "merge": "the name of the part that these bodies become",
        "by_contact": "true or false",
        "parts[]": 'an object such as {"name": "seat", "box": {"center": [0, 0, 450], "size": [400, 400, 20]}}',
        "box": 'an object such as {"center": [0, 0, 450], "size": [400, 400, 20]}',
        "center": "three numbers",
        "center[]": "a finite number",
        "size": "three lengths above 0",
        "size[]": "a finite length above 0",
        "axes": "three rows of three numbers",
        "axes[]": "a row of three numbers",
        "axes[][]": "a finite number",
        "hingeable": "true or false",
        "touching": 'a list of pairs of names such as [["top", "leg*"]]',
        "touching[]": 'two names such as ["top", "leg*"]',
        "touching[][]": "a part's name",
        "apart": 'a list of pairs of names such as [["seat", "shelf"]]',
        "apart[]": 'two names such as ["seat", "shelf"]',
        "apart[][]": "a part's name",
        "pin": 'an object such as {"mechanism": "in-place", "hinges": 1}',
        "forbid": f'a list of at most {MOST_PATTERNS} patterns such as {{"mechanism": "slanted"}}',
        "forbid[]": 'an object such as {"mechanism": "slanted"}',
        "mechanism": 'one of "in-place", "slanted", "deleted"',
        "hinges": "a whole number from 0 to 9",
        "side": '"l" or "r"',
        "window": "two shares of the width such as [0, 0.4]",
        "window[]": "a share of the width from 0 to 1",
        "fold": 'an object such as {"alpha": 0.5}',
        "alpha": "a number from 0 to 1",
        "max_hinges": "a whole number from 1 to 9",
        "shrink_steps": "a whole number from 1 to 20",
        "slanting": "true or false",
        "stay_in_box": "true or false",
        "ordering": '"greedy" or "optimal"',
        "collisions": '"swept" or "regions"',
        "symmetry": "true or false",
        "time_limit": "a number of seconds above 0, at most 3600",
        "print": 'an object such as {"thickness": 4}',
        "printer": f'one of {", ".join(PRINTERS)}, or {{"name": "mine", "build_volume": [200, 200, 180]}}',
        "build_volume": "three lengths in mm",
        "build_volume[]": f"a length from {SMALLEST:g} to {LARGEST:g} mm",
        "thickness": "a number of millimetres from 2 to 20",
        "base_thickness": "a number of millimetres from 2 to 20",
        "own_thickness": "true or false",
        "clearance": '"auto" or a number of millimetres from 0.15 to 1',
        "nozzle": "a number of millimetres from 0.1 to 1.5",
        "layer": "a number of millimetres from 0.03 to 1",
        "material": '"pla", "petg", "abs" or "nylon"',
        "posture": 'one of "open", "folded", "edge", "plate", "auto"',
        "hinge": '"cone", "filament", "screw-m2", "screw-m3" or "clip"',
        "shape": '"plain" or "own"',
        "latch": "true or false",
        "scale": '"fit" or a number from 0.00001 to 1000, such as 0.2',
    }
)
"""By field, with a [] for each level of its lists: what would be right."""

FORMS: Mapping[str, type[Form]] = MappingProxyType(
    {
        "": RecipeForm,
        "parts[]": PartForm,
        "box": BoxForm,
        "pin": PatternForm,
        "forbid[]": PatternForm,
        "fold": FoldForm,
        "print": PrintForm,
        "printer": PrinterForm,
    }
)
"""By field: the form of the object that it holds."""

SLIP = 0.9
"""Keys this alike are the same but for a slip, even where the key belongs elsewhere as well."""


def problems_of(error: ValidationError) -> list[Problem]:
    """Every error of a validation as a problem, in the order of the form."""
    found = error.errors(include_url=False)
    return [Problem(place(_clean(detail)), sentence(detail)) for detail in found]


def sentence(detail: ErrorDetails) -> str:
    """What is wrong there and what would be right."""
    location = _clean(detail)
    if detail["type"] == OWN_WORDS:
        return detail["msg"]
    if detail["type"] == "extra_forbidden":
        return _unknown_key(str(location[-1]), _field(location[:-1]))
    expected = EXPECTED.get(_field(location), "left out")
    if detail["type"] == "missing":
        return f"is missing; give {expected}"
    return f"should be {expected}, not {shown(detail['input'])}"


def place(location: Location) -> str:
    """A location as people write it: `parts[2].box.size`."""
    text = ""
    for step in location:
        if isinstance(step, int):
            text += f"[{step}]"
        elif step.replace("-", "_").lstrip("$").isidentifier():
            text += f".{step}" if text else step
        else:
            text += f"[{shown(step)}]"
    return text or TOP


def shown(value: object) -> str:
    """A value of a JSON file, short enough for a message."""
    match value:
        case bool() | None:
            return {True: "true", False: "false", None: "null"}[value]
        case float() if not math.isfinite(value):
            return "NaN" if math.isnan(value) else "infinity"
        case str():
            return ascii(value) if len(value) <= 40 else ascii(value[:37]) + "…"
        case Mapping():
            return "an object"
        case Sequence():
            return f"a list of {len(value)}"
        case int() if abs(value) >= 10**20:
            return "a number of more than 20 digits"
    return repr(value)[:40]


def _clean(detail: ErrorDetails) -> Location:
    """Where it is, without the tags of unions; an unknown key is kept even where it looks like a tag."""
    *inner, last = detail["loc"] or ("",)
    keeps_last = detail["type"] == "extra_forbidden" or last not in TAGS
    location = tuple(step for step in inner if step not in TAGS)
    return (*location, last) if keeps_last else location


def _field(location: Location) -> str:
    """The last named step, with a [] for each index after it."""
    names = [index for index, step in enumerate(location) if isinstance(step, str)]
    return f"{location[names[-1]]}{'[]' * (len(location) - 1 - names[-1])}" if names else ""


def _unknown_key(key: str, parent: str) -> str:
    known = keys(FORMS[parent])
    homes = [other or "the top level" for other, form in FORMS.items() if key in keys(form)]
    close = get_close_matches(key.lower(), known, n=1, cutoff=SLIP if homes else 0.6)
    if homes and not close:
        # What a part may override is told of the place where it holds for all.
        return f"is not known here; it belongs in {homes[-1] if homes[0] == 'parts[]' else homes[0]}"
    if close:
        return f'is not known here; did you mean "{close[0]}"?'
    return f"is not known here; known are {', '.join(known)}"


def keys(form: type[Form]) -> tuple[str, ...]:
    """The keys that an object of that form may have."""
    return tuple(field.alias or name for name, field in form.model_fields.items())
