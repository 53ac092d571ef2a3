"""What a print was made from and by: enough to make it again, and nothing that a clock or a machine would change."""

from __future__ import annotations

import hashlib
import json
from typing import Any

from foldfab.export.version import foldfab_version
from foldfab.fabrication.model import Assembly
from foldfab.recipe.write import to_json


def recipe_bytes(assembly: Assembly) -> bytes:
    """`recipe.json`: the recipe as it was understood."""
    data = to_json(assembly.solution.scaffold.recipe)
    return (json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def provenance(assembly: Assembly) -> dict[str, Any]:
    """The hash of `recipe.json`, which holds every option, the version, and what was decided about `auto` and `fit`."""
    data = to_json(assembly.solution.scaffold.recipe)
    return {
        "recipe_sha256": hashlib.sha256(recipe_bytes(assembly)).hexdigest(),
        "foldfab": foldfab_version(),
        "options": {"fold": data["fold"], "print": data["print"] | {"posture": assembly.posture}},
    }


def metadata(assembly: Assembly) -> dict[str, str]:
    """The same as names and texts for a 3MF."""
    facts = provenance(assembly)
    options = json.dumps(facts["options"], ensure_ascii=False, allow_nan=False)
    about = assembly.solution.scaffold.recipe.about
    return {
        **({"Description": about} if about else {}),
        "foldfab:recipe-sha256": facts["recipe_sha256"],
        "foldfab:version": facts["foldfab"],
        "foldfab:options": options,
    }
