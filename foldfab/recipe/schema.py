"""The form of a recipe as JSON Schema (Draft 2020-12), for editors.

`python -m foldfab.recipe.schema` rewrites the shipped file.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from foldfab.recipe.form import RecipeForm

SCHEMA_FILE = Path(__file__).with_name("recipe.schema.json")
"""Where the shipped schema lies."""


def schema() -> dict[str, Any]:
    """The JSON Schema of a recipe file."""
    body = RecipeForm.model_json_schema(by_alias=True)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **body, "title": "foldfab recipe"}


def text() -> str:
    """The schema as it is shipped."""
    return json.dumps(schema(), indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    SCHEMA_FILE.write_text(text(), encoding="utf-8")
