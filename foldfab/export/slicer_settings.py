"""What slicers read of a 3MF beside the mesh: names of objects and parts, and the settings that hinges need.

PrusaSlicer and SuperSlicer read `Metadata/Slic3r_PE_model.config`: a `volume` for each range of triangles, with a name
of its own and settings by key. Tried with 2.5: positions, names and settings survive its own export.

Bambu Studio and OrcaSlicer read `Metadata/model_settings.config`, as their source (bbs_3mf.cpp) has it: an `object` by
the id of the object in the model, and a `part` by the id of an object that holds a mesh. There is one part for each
mesh; ranges of triangles are not read. As our bodies share one mesh, or they would be taken apart, they come as one
part under the print's name, to be seen singly by "split to parts". Keys of an object other than its name are settings.
This is read from the source and not tried.
"""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

from foldfab.export.shell import Shell
from foldfab.slicing.profile import CLOSING_RADIUS_MM, ELEPHANT_FOOT_MM

PRUSA, BAMBU = "Metadata/Slic3r_PE_model.config", "Metadata/model_settings.config"
XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
SETTINGS = {"elefant_foot_compensation": f"{ELEPHANT_FOOT_MM:g}", "slice_closing_radius": f"{CLOSING_RADIUS_MM:g}"}
"""Of the object, for all of these programs: a wide closing radius welds hinges; first layers are drawn in already."""


Object = tuple[int, str, tuple[Shell, ...]]
"""Id, name and bodies."""


def prusa_config(objects: list[Object]) -> str:
    """The names of the bodies, which follow each other in the mesh of their object, and the objects' settings."""
    return f"{XML}<config>\n{''.join(map(_prusa_object, objects))}</config>\n"


def bambu_config(objects: list[Object]) -> str:
    """The objects of one part each, with their settings."""
    return f"{XML}<config>\n{''.join(map(_bambu_object, objects))}</config>\n"


def _prusa_object(one: Object) -> str:
    object_id, title, shells = one
    rows = [_typed("object", key, value) for key, value in {"name": title, **SETTINGS}.items()]
    start = 0
    for shell in shells:
        rows.append(
            f'  <volume firstid="{start}" lastid="{start + len(shell.faces) - 1}">\n'
            f" {_typed('volume', 'name', shell.name)} {_typed('volume', 'volume_type', 'ModelPart')}  </volume>\n"
        )
        start += len(shell.faces)
    return f' <object id="{object_id}" instances_count="1">\n{"".join(rows)} </object>\n'


def _bambu_object(one: Object) -> str:
    object_id, title, _ = one
    rows = "".join(f"  {_plain(key, value)}" for key, value in {"name": title, **SETTINGS}.items())
    part = f'  <part id="{object_id}" subtype="normal_part">\n   {_plain("name", title)}  </part>\n'
    return f' <object id="{object_id}">\n{rows}{part} </object>\n'


def xml_attribute(text: str) -> str:
    """`text` quoted for an XML attribute; characters that XML forbids become a replacement mark."""
    allowed = "".join(c if c in "\t\n\r" or (c >= " " and c not in "\ufffe\uffff") else "\ufffd" for c in text)
    return quoteattr(allowed, {"\t": "&#9;", "\n": "&#10;", "\r": "&#13;"})


def _typed(kind: str, key: str, value: str) -> str:
    return f'  <metadata type="{kind}" key="{key}" value={xml_attribute(value)}/>\n'


def _plain(key: str, value: str) -> str:
    return f'<metadata key="{key}" value={xml_attribute(value)}/>\n'
