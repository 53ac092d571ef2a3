"""What a print was made from stands in its sheet and its 3MF."""

import hashlib
import json
import zipfile
from collections.abc import Callable
from io import BytesIO

from lib3mf import get_wrapper

from foldfab.export.provenance import metadata, provenance, recipe_bytes
from foldfab.export.write import contents
from foldfab.fabrication.model import Assembly


def test_the_hash_is_that_of_the_recipe_in_the_folder(assembly: Assembly) -> None:
    files = contents(assembly)
    told = json.loads(files["sheet.json"])["provenance"]
    assert told == provenance(assembly)
    assert told["recipe_sha256"] == hashlib.sha256(files["recipe.json"]).hexdigest()
    assert files["recipe.json"] == recipe_bytes(assembly)
    assert told["options"]["print"]["clearance"] == 0.3 and told["options"]["fold"]["alpha"] == 0.5


def test_other_recipes_have_other_hashes(make: Callable[..., Assembly]) -> None:
    one, other = make(), make(name="table")
    assert provenance(one)["recipe_sha256"] == provenance(make())["recipe_sha256"]
    assert provenance(one)["recipe_sha256"] != provenance(other)["recipe_sha256"]
    assert provenance(make(posture="folded"))["options"]["print"]["posture"] == "folded"


def test_the_3mf_holds_it_where_readers_of_the_format_find_it(assembly: Assembly) -> None:
    model = get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromBuffer(contents(assembly)["stool.3mf"])
    assert reader.GetWarningCount() == 0
    group = model.GetMetaDataGroup()
    found = {}
    for index in range(group.GetMetaDataCount()):
        entry = group.GetMetaData(index)
        found[entry.GetName()] = entry.GetValue()
    ours = {name.removeprefix("foldfab:"): text for name, text in metadata(assembly).items()}
    assert ours.items() <= found.items()
    assert json.loads(found["options"]) == provenance(assembly)["options"]


def test_the_3mf_has_a_thumbnail(assembly: Assembly) -> None:
    with zipfile.ZipFile(BytesIO(contents(assembly)["stool.3mf"])) as archive:
        assert archive.read("Metadata/thumbnail.png").startswith(b"\x89PNG")
        assert "Metadata/thumbnail.png" in archive.read("_rels/.rels").decode()
        assert 'Extension="png" ContentType="image/png"' in archive.read("[Content_Types].xml").decode()
