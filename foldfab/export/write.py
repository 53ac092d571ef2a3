"""The verb of this room: an Assembly becomes a print folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from foldfab.errors import FabricationError, MissingLibraryError
from foldfab.export.animation import glb_bytes
from foldfab.export.bed import print_files
from foldfab.export.mesh_files import file_stems, stl_bytes
from foldfab.export.preview import preview_png
from foldfab.export.printability import Printability, as_json, as_text, printability, side_by_side
from foldfab.export.provenance import metadata, recipe_bytes
from foldfab.export.sheet import sheet_json
from foldfab.export.shell import Shell, sheet_shells
from foldfab.export.step import step_bytes
from foldfab.export.swap import replace_folder
from foldfab.export.threemf import threemf_bytes
from foldfab.export.thumbnail import thumbnail_png
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.posture import needs_pins


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
    """By path in the folder, the bytes of each file; with `step`, of a STEP file too.

    Raises:
        FabricationError: slicers would stumble over the print file's meshes.
    """
    recipe = assembly.solution.scaffold.recipe
    shells, printed = sheet_shells(assembly), print_files(assembly)
    found = _printable(assembly, printed)
    stems = file_stems(shell.name for shell in shells)
    stl_paths = {name: f"stl/{stem}.stl" for name, stem in stems.items()}
    return {
        **{stl_paths[shell.name]: stl_bytes(shell) for shell in shells},
        **{name: _print_file(assembly, name, plate) for name, plate in printed.items()},
        f"{recipe.name}.glb": glb_bytes(assembly, shells),
        "sheet.json": sheet_json(assembly, shells, stl_paths).encode(),
        **({f"{recipe.name}.step": step_bytes(assembly)} if step else {}),
        "printability.json": as_json(found, {"name": recipe.name, "posture": assembly.posture}).encode(),
        "printability.txt": f"{as_text(found)}\n".encode(),
        "recipe.json": recipe_bytes(assembly),
        "preview.png": _drawn(lambda: preview_png(assembly, shells)),
    }


def _printable(assembly: Assembly, printed: Mapping[str, tuple[Shell, ...]]) -> Printability:
    plates = [[(shell.name, shell.vertices, shell.faces) for shell in plate] for plate in printed.values()]
    found = printability(
        side_by_side(plates), assembly.solution.thickness.gap, [body.name for body in assembly.propped]
    )
    if found.errors:
        raise FabricationError("this would not print:\n  " + "\n  ".join(found.errors))
    return found


def _print_file(assembly: Assembly, name: str, plate: tuple[Shell, ...]) -> bytes:
    picture = _drawn(lambda: thumbnail_png(plate))
    is_loose = needs_pins(assembly.posture)
    return threemf_bytes(Path(name).stem, plate, is_loose=is_loose, metadata=metadata(assembly), thumbnail=picture)


def _drawn(draw: Callable[[], bytes]) -> bytes:
    try:
        return draw()
    except ImportError as error:
        raise MissingLibraryError("drawing pictures needs the library Pillow; pip install pillow") from error


def _save(files: dict[str, bytes], folder: Path) -> None:
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
