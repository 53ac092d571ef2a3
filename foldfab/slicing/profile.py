"""The settings that prints are sliced with: a 0.4 mm nozzle, layers of 0.2 mm, PLA, on the printer's own bed."""

from __future__ import annotations

from foldfab.fabrication.walls import LINE
from foldfab.recipe.model import Printer

NOZZLE_MM, LAYER_MM, LINE_MM = 0.4, 0.2, LINE
"""Nozzle, layer height, and width of an extruded line."""
CLOSING_RADIUS_MM = 0.049
"""PrusaSlicer closes gaps up to twice this when it slices; its default, stated because we measure against it."""
ELEPHANT_FOOT_MM = 0.0
"""By how much the slicer draws in the first layer: not at all, as bodies are bevelled there already (`soles.py`)."""
SUPPORT_DEG = 40
"""Surfaces flatter than this get support. Hinge cones slope by 45°, less what their facets and layers take."""
DENSITY = 1.24
"""Of PLA, g/cm³."""

_FIXED = {
    "nozzle_diameter": NOZZLE_MM,
    "layer_height": LAYER_MM,
    "first_layer_height": LAYER_MM,
    "extrusion_width": LINE_MM,
    "external_perimeter_extrusion_width": LINE_MM,
    "perimeter_extrusion_width": LINE_MM,
    "infill_extrusion_width": LINE_MM,
    "solid_infill_extrusion_width": LINE_MM,
    "first_layer_extrusion_width": LINE_MM,
    "slice_closing_radius": CLOSING_RADIUS_MM,
    "elefant_foot_compensation": ELEPHANT_FOOT_MM,
    "perimeters": 2,
    "top_solid_layers": 5,
    "bottom_solid_layers": 4,
    "fill_density": "15%",
    "fill_pattern": "gyroid",
    # A skirt or brim would stand around the outlines that are compared with the bodies.
    "skirts": 0,
    "brim_type": "no_brim",
    "filament_diameter": 1.75,
    "filament_density": DENSITY,
    "filament_type": "PLA",
    "temperature": 210,
    "first_layer_temperature": 215,
    "bed_temperature": 60,
    "first_layer_bed_temperature": 60,
    "perimeter_speed": 45,
    "external_perimeter_speed": 25,
    "small_perimeter_speed": 25,
    "infill_speed": 80,
    "solid_infill_speed": 80,
    "top_solid_infill_speed": 40,
    "support_material_speed": 50,
    "bridge_speed": 30,
    "gap_fill_speed": 40,
    "travel_speed": 150,
    "first_layer_speed": 20,
    "gcode_flavor": "marlin",
    "use_relative_e_distances": 1,
    "layer_gcode": "G92 E0",
    "gcode_comments": 0,
    "thumbnails": "",
    "support_material_auto": 1,
    "support_material_threshold": SUPPORT_DEG,
    "support_material_style": "grid",
    "support_material_buildplate_only": 0,
}


def profile(printer: Printer, *, support: bool) -> str:
    """The text of an ini file for `--load`; with `support`, wherever the slicer thinks that some is needed."""
    x, y, z = printer.build_volume
    bed = ",".join(f"{a:g}x{b:g}" for a, b in ((0, 0), (x, 0), (x, y), (0, y)))
    settings = {**_FIXED, "bed_shape": bed, "max_print_height": f"{z:g}", "support_material": int(support)}
    return "".join(f"{key} = {value}\n" for key, value in settings.items())
