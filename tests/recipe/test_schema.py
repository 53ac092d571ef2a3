"""The shipped schema is that of the form, and the shipped recipes obey it."""

from __future__ import annotations

import json

import jsonschema  # type: ignore[import-untyped]
import pytest

from foldfab.recipe.find import shipped
from foldfab.recipe.read import parse
from foldfab.recipe.schema import SCHEMA_FILE, schema, text

PART = {"name": "a", "box": {"center": [0, 0, 0], "size": [1, 1, 1]}}


def test_no_drift() -> None:
    assert SCHEMA_FILE.read_text(encoding="utf-8") == text(), "run python -m foldfab.recipe.schema"


def test_shipped_recipes_are_valid() -> None:
    jsonschema.Draft202012Validator.check_schema(schema())
    validator = jsonschema.Draft202012Validator(schema())
    for path in shipped():
        validator.validate(json.loads(path.read_text(encoding="utf-8")))


def test_the_schema_knows_patterns() -> None:
    forbid = [{"mechanism": "slanted"}, {"side": "l"}]
    jsonschema.validate({"parts": [{**PART, "pin": {"hinges": 1, "window": [0, 1]}, "forbid": forbid}]}, schema())


def test_a_recipe_may_name_its_schema() -> None:
    data = {"$schema": "recipe.schema.json", "parts": [PART]}
    jsonschema.validate(data, schema())
    assert parse(data, "a.json", "a").name == "a"


@pytest.mark.parametrize(
    "extra",
    [
        *({"parts": [{**PART, "pin": pin}]} for pin in ({"hinges": 10}, {"side": "up"}, {"window": [0, 2]})),
        {"x": 1},
        {"fold": {"alpha": 2}},
        {"fold": {"time_limit": 0}},
        {"direction": "up"},
        {"print": {"printer": "mk9"}},
    ],
)
def test_the_schema_refuses(extra: dict[str, object]) -> None:
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"parts": [PART], **extra}, schema())
