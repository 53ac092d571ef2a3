"""The print file: a 3MF of one build item, one object, one mesh, its bodies as disjoint shells; loose parts apart.

Slicers take several objects apart and drop each to the bed, so the bodies' names and ranges stand beside the mesh,
in the records that PrusaSlicer and its kin keep for the volumes of an object.
"""

from __future__ import annotations

import io
import zipfile
from xml.sax.saxutils import quoteattr

import numpy as np

from foldfab.export.colours import COLOURS, NAMES, materials
from foldfab.export.shell import Shell
from foldfab.export.version import foldfab_version

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
OBJECT_ID, MATERIALS_ID = 1, 2
FIXED_TIME = (1980, 1, 1, 0, 0, 0)
"""The zip format's earliest date: the same input gives the same bytes."""
XML = '<?xml version="1.0" encoding="UTF-8"?>\n'


Object = tuple[str, tuple[Shell, ...]]
"""Name and bodies."""


def threemf_bytes(title: str, shells: tuple[Shell, ...], *, is_loose: bool = False) -> bytes:
    """A 3MF of the shells as they lie on the bed, millimetres: one object, or an object each where they are loose."""
    objects: list[Object] = [(s.name, (s,)) for s in shells] if is_loose else [(title, shells)]
    files = {
        "[Content_Types].xml": _content_types(),
        "_rels/.rels": _relationships(),
        "3D/3dmodel.model": _model(title, objects),
        "Metadata/Slic3r_PE_model.config": _config(objects),
    }
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, text in files.items():
            entry = zipfile.ZipInfo(name, FIXED_TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            # Left alone it names the system that wrote the archive.
            entry.create_system = 3
            archive.writestr(entry, text.encode("utf-8"), compresslevel=6)
    return buffer.getvalue()


def xml_attribute(text: str) -> str:
    """`text` quoted for an XML attribute; characters that XML forbids become a replacement mark."""
    allowed = "".join(c if c in "\t\n\r" or (c >= " " and c not in "\ufffe\uffff") else "\ufffd" for c in text)
    return quoteattr(allowed, {"\t": "&#9;", "\n": "&#10;", "\r": "&#13;"})


def _content_types() -> str:
    types = {
        "rels": "application/vnd.openxmlformats-package.relationships+xml",
        "model": "application/vnd.ms-package.3dmanufacturing-3dmodel+xml",
        "config": "text/xml",
    }
    rows = "".join(f' <Default Extension="{key}" ContentType="{value}"/>\n' for key, value in types.items())
    return f'{XML}<Types xmlns="{PACKAGE}/content-types">\n{rows}</Types>\n'


def _relationships() -> str:
    kind = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    row = f' <Relationship Target="/3D/3dmodel.model" Id="rel-1" Type="{kind}"/>\n'
    return f'{XML}<Relationships xmlns="{PACKAGE}/relationships">\n{row}</Relationships>\n'


def _model(title: str, objects: list[Object]) -> str:
    colours = "".join(
        f'   <base name="{name}" displaycolor="#{r:02X}{g:02X}{b:02X}"/>\n'
        for name, (r, g, b) in zip(NAMES, COLOURS, strict=True)
    )
    items = "".join(f'  <item objectid="{number}"/>\n' for number in _numbers(objects))
    return (
        f'{XML}<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}"'
        ' xmlns:slic3rpe="http://schemas.slic3r.org/3mf/2017/06">\n'
        ' <metadata name="slic3rpe:Version3mf">1</metadata>\n'
        f' <metadata name="Title">{_xml_text(title)}</metadata>\n'
        f' <metadata name="Application">foldfab {foldfab_version()}</metadata>\n'
        f' <resources>\n  <basematerials id="{MATERIALS_ID}">\n{colours}  </basematerials>\n'
        f"{''.join(map(_object, _numbers(objects), objects))} </resources>\n"
        f" <build>\n{items} </build>\n</model>\n"
    )


def _numbers(objects: list[Object]) -> list[int]:
    """The ids of objects, which share their numbers with the materials."""
    return [OBJECT_ID, *range(MATERIALS_ID + 1, MATERIALS_ID + len(objects))]


def _object(number: int, one: Object) -> str:
    name, shells = one
    return (
        f'  <object id="{number}" type="model" name={xml_attribute(name)} pid="{MATERIALS_ID}" pindex="0">\n'
        f"   <mesh>\n{_vertices(shells)}{_triangles(shells)}   </mesh>\n  </object>\n"
    )


def _xml_text(text: str) -> str:
    return xml_attribute(text)[1:-1].replace("<", "&lt;")


def _vertices(shells: tuple[Shell, ...]) -> str:
    points = np.vstack([shell.vertices for shell in shells]) + 0.0
    rows = (f'     <vertex x="{_number(x)}" y="{_number(y)}" z="{_number(z)}"/>\n' for x, y, z in points.tolist())
    return f"    <vertices>\n{''.join(rows)}    </vertices>\n"


def _number(value: float) -> str:
    # Grid points below 16 mm are exact in six digits, and above it six digits tell all 32-bit floats apart.
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _triangles(shells: tuple[Shell, ...]) -> str:
    rows: list[str] = []
    start = 0
    for shell in shells:
        for (a, b, c), material in zip((shell.faces + start).tolist(), materials(shell).tolist(), strict=True):
            colour = f' pid="{MATERIALS_ID}" p1="{material}"'
            rows.append(f'     <triangle v1="{a}" v2="{b}" v3="{c}"{colour}/>\n')
        start += len(shell.vertices)
    return f"    <triangles>\n{''.join(rows)}    </triangles>\n"


def _config(objects: list[Object]) -> str:
    rows = "".join(map(_names, _numbers(objects), objects))
    return f"{XML}<config>\n{rows}</config>\n"


def _names(number: int, one: Object) -> str:
    title, shells = one
    rows: list[str] = []
    start = 0
    for shell in shells:
        rows.append(
            f'  <volume firstid="{start}" lastid="{start + len(shell.faces) - 1}">\n'
            f'   <metadata type="volume" key="name" value={xml_attribute(shell.name)}/>\n'
            '   <metadata type="volume" key="volume_type" value="ModelPart"/>\n  </volume>\n'
        )
        start += len(shell.faces)
    name = f'  <metadata type="object" key="name" value={xml_attribute(title)}/>\n'
    return f' <object id="{number}" instances_count="1">\n{name}{"".join(rows)} </object>\n'
