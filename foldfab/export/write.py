"""The verb of this room: an Assembly becomes a print folder."""

from __future__ import annotations

import json
from pathlib import Path

from foldfab.errors import MissingLibraryError
from foldfab.export.animation import glb_bytes
from foldfab.export.bed import print_files
from foldfab.export.mesh_files import file_stems, stl_bytes
from foldfab.export.preview import preview_png
from foldfab.export.sheet import sheet_json
from foldfab.export.shell import Shell, sheet_shells
from foldfab.export.swap import replace_folder
from foldfab.export.threemf import threemf_bytes
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.posture import needs_pins


def write(assembly: Assembly, folder: Path) -> list[Path]:
    """The complete print folder of an assembly, in place of an older one; returns its files, sorted.

    Raises:
        PrintFolderError: `folder` holds something else, or cannot be written; what stood there still stands.
    """
    files = contents(assembly)
    place = replace_folder(Path(folder), lambda fresh: _save(files, fresh))
    return sorted(place / name for name in files)


def contents(assembly: Assembly) -> dict[str, bytes]:
    """By path in the folder, the bytes of each file."""
    recipe = assembly.solution.scaffold.recipe
    shells = sheet_shells(assembly)
    stems = file_stems(shell.name for shell in shells)
    stl_paths = {name: f"stl/{stem}.stl" for name, stem in stems.items()}
    return {
        **{stl_paths[shell.name]: stl_bytes(shell) for shell in shells},
        **_prints(assembly),
        f"{recipe.name}.glb": glb_bytes(assembly, shells),
        "sheet.json": sheet_json(assembly, shells, stl_paths).encode(),
        "recipe.json": _recipe_json(assembly),
        "preview.png": _preview(assembly, shells),
    }


def _prints(assembly: Assembly) -> dict[str, bytes]:
    is_loose = needs_pins(assembly.posture)
    files = print_files(assembly)
    return {name: threemf_bytes(name[:-4], shells, is_loose=is_loose) for name, shells in files.items()}


def _preview(assembly: Assembly, shells: tuple[Shell, ...]) -> bytes:
    try:
        return preview_png(assembly, shells)
    except ImportError as error:
        raise MissingLibraryError("drawing the preview needs the library Pillow; pip install pillow") from error


def _recipe_json(assembly: Assembly) -> bytes:
    from foldfab.recipe.write import to_json

    data = to_json(assembly.solution.scaffold.recipe)
    return (json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def _save(files: dict[str, bytes], folder: Path) -> None:
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
