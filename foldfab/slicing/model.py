"""The noun of this room: a SliceReport, what a slicer says about a print file as it lies."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MeshInfo:
    """A print file's mesh in the slicer's eyes, before it mends anything."""

    low: tuple[float, float, float]
    """Least corner, mm."""
    high: tuple[float, float, float]
    """Greatest corner, mm."""
    is_manifold: bool
    bodies: int
    """Shells that are not connected."""
    repairs: tuple[tuple[str, int], ...]
    """What it would mend silently and how often, in its own words, such as `("open_edges", 4)`; empty where sound."""


@dataclass(frozen=True, slots=True)
class SliceReport:
    """What a print takes, and what the slicer thinks of it."""

    slicer: str
    """Program and version."""
    seconds: int
    """Printing time by the slicer's estimate."""
    filament_mm: float
    filament_cm3: float
    filament_g: float
    """All that is extruded, support included."""
    support_g: float
    """The support's share; 0 where none was asked for, or none is needed."""
    height_mm: float
    """Top of the last layer."""
    layers: int
    is_manifold: bool
    bodies: int
    repairs: tuple[tuple[str, int], ...]
    """As in MeshInfo."""
    warnings: tuple[str, ...]
    """What it said beyond its progress; its exit status alone tells nothing."""
