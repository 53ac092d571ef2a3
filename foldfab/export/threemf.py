"""The print file: a 3MF of one build item, one object, one mesh, its bodies as disjoint shells; loose parts apart.

Slicers take several objects apart and drop each to the bed, so the bodies' names and ranges stand beside the mesh, in
the records that slicers keep of their own. A thumbnail, and what the print was made from, lie in the file too.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping

import numpy as np

from foldfab.export.colours import COLOURS, NAMES, materials
from foldfab.export.shell import Shell
from foldfab.export.slicer_settings import BAMBU, PRUSA, XML, Object, bambu_config, prusa_config, xml_attribute
from foldfab.export.version import foldfab_version

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
OURS = "urn:foldfab:provenance"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
OBJECT_ID, MATERIALS_ID = 1, 2
THUMBNAIL = "Metadata/thumbnail.png"
FIXED_TIME = (1980, 1, 1, 0, 0, 0)
"""The zip format's earliest date: the same input gives the same bytes."""


def threemf_bytes(
    title: str, shells: tuple[Shell, ...], *, is_loose: bool = False, metadata: Mapping[str, str] | None = None,
    thumbnail: bytes = b"",
) -> bytes:  # fmt: skip
    """A 3MF of the shells as they lie on the bed, millimetres: one object, or an object each where they are loose.

    `metadata` stands in the model by name, those of our own as `foldfab:…`; `thumbnail` is a PNG.
    """
    named = [(s.name, (s,)) for s in shells] if is_loose else [(title, shells)]
    objects = [(number, *one) for number, one in zip(_numbers(len(named)), named, strict=True)]
    texts = {
        "[Content_Types].xml": _content_types(),
        "_rels/.rels": _relationships(bool(thumbnail)),
        "3D/3dmodel.model": _model(title, objects, metadata or {}),
        PRUSA: prusa_config(objects),
        BAMBU: bambu_config(objects),
    }
    files = {name: text.encode("utf-8") for name, text in texts.items()} | ({THUMBNAIL: thumbnail} if thumbnail else {})
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, FIXED_TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            # Left alone it names the system that wrote the archive.
            entry.create_system = 3
            archive.writestr(entry, data, compresslevel=6)
    return buffer.getvalue()


def _content_types() -> str:
    types = {
        "rels": "application/vnd.openxmlformats-package.relationships+xml",
        "model": "application/vnd.ms-package.3dmanufacturing-3dmodel+xml",
        "config": "text/xml",
        "png": "image/png",
    }
    rows = "".join(f' <Default Extension="{key}" ContentType="{value}"/>\n' for key, value in types.items())
    return f'{XML}<Types xmlns="{PACKAGE}/content-types">\n{rows}</Types>\n'


def _relationships(has_thumbnail: bool) -> str:
    targets = {"3D/3dmodel.model": "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"}
    if has_thumbnail:
        targets[THUMBNAIL] = f"{PACKAGE}/relationships/metadata/thumbnail"
    rows = "".join(
        f' <Relationship Target="/{target}" Id="rel-{number}" Type="{kind}"/>\n'
        for number, (target, kind) in enumerate(targets.items(), 1)
    )
    return f'{XML}<Relationships xmlns="{PACKAGE}/relationships">\n{rows}</Relationships>\n'


def _model(title: str, objects: list[Object], metadata: Mapping[str, str]) -> str:
    notes = {"Title": title, "Application": f"foldfab {foldfab_version()}", **metadata}
    told = "".join(f' <metadata name="{name}">{_xml_text(text)}</metadata>\n' for name, text in notes.items())
    colours = "".join(
        f'   <base name="{name}" displaycolor="#{r:02X}{g:02X}{b:02X}"/>\n'
        for name, (r, g, b) in zip(NAMES, COLOURS, strict=True)
    )
    items = "".join(f'  <item objectid="{number}"/>\n' for number, _, _ in objects)
    return (
        f'{XML}<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}"'
        f' xmlns:slic3rpe="http://schemas.slic3r.org/3mf/2017/06" xmlns:foldfab="{OURS}">\n'
        ' <metadata name="slic3rpe:Version3mf">1</metadata>\n'
        f"{told}"
        f' <resources>\n  <basematerials id="{MATERIALS_ID}">\n{colours}  </basematerials>\n'
        f"{''.join(map(_object, objects))} </resources>\n"
        f" <build>\n{items} </build>\n</model>\n"
    )


def _numbers(count: int) -> list[int]:
    """The ids of objects, which share their numbers with the materials."""
    return [OBJECT_ID, *range(MATERIALS_ID + 1, MATERIALS_ID + count)]


def _object(one: Object) -> str:
    number, name, shells = one
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
