"""The verb of this room: an Assembly becomes a print folder."""

from __future__ import annotations

import json
from pathlib import Path

from foldfab.errors import MissingLibraryError
from foldfab.export.animation import glb_bytes
from foldfab.export.bed import on_bed
from foldfab.export.mesh_files import file_stems, stl_bytes
from foldfab.export.preview import preview_png
from foldfab.export.sheet import sheet_json
from foldfab.export.shell import Shell, sheet_shells
from foldfab.export.step import step_bytes
from foldfab.export.swap import replace_folder
from foldfab.export.threemf import threemf_bytes
from foldfab.fabrication.model import Assembly


def write(assembly: Assembly, folder: Path, *, step: bool = False) -> list[Path]:
    """The complete print folder of an assembly, in place of an older one; returns its files, sorted.

    Raises:
        FabricationError, MissingLibraryError: the STEP file, which is written on request, cannot be made.
        PrintFolderError: `folder` holds something else, or cannot be written; what stood there still stands.
    """
    files = contents(assembly, step=step)
    place = replace_folder(Path(folder), lambda fresh: _save(files, fresh))
    return sorted(place / name for name in files)


def contents(assembly: Assembly, *, step: bool = False) -> dict[str, bytes]:
    """By path in the folder, the bytes of each file; with `step`, of a STEP file too."""
    recipe = assembly.solution.scaffold.recipe
    shells = sheet_shells(assembly)
    stems = file_stems(shell.name for shell in shells)
    stl_paths = {name: f"stl/{stem}.stl" for name, stem in stems.items()}
    return {
        **{stl_paths[shell.name]: stl_bytes(shell) for shell in shells},
        f"{recipe.name}.3mf": threemf_bytes(recipe.name, on_bed(assembly)),
        f"{recipe.name}.glb": glb_bytes(assembly, shells),
        "sheet.json": sheet_json(assembly, shells, stl_paths).encode(),
        "recipe.json": _recipe_json(assembly),
        "preview.png": _preview(assembly, shells),
        **({f"{recipe.name}.step": step_bytes(assembly)} if step else {}),
    }


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
