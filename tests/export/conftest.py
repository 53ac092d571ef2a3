"""A small Assembly made by hand: a top over a base, a leg that folds in the middle (N = 1), and a flap (a T-scaffold).

Its hinges are not captive: the knuckles interleave, but nothing holds them on their axis.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from manifold3d import Manifold, OpType

from foldfab.export.write import write
from foldfab.fabrication.model import Assembly, Body, Finding, Joint
from foldfab.folding.model import Chain, FoldSolution, Modification, Step, Thickness
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import FoldOptions, Part, Posture, Printer, PrintOptions, Recipe
from foldfab.scaffold.model import BasePatch, Outline, Patch, Scaffold

K, G = 4.0, 0.3
LEG, FLAP, WIDTH = 30.0, 25.0, 40.0
"""Axis spacing of a leg's panels, axis to tip of the flap, widths along y, mm."""
RISE = K / 2 + G
"""Height of a base hinge's axis over its base."""
KEYS = 61
SPANS = ((0.0, 8.0), (8.3, 16.0), (16.3, 24.0), (24.3, 32.0), (32.3, 40.0))
"""Knuckles along y, alternately of the one and of the other part."""


@pytest.fixture(scope="session")
def make() -> Callable[..., Assembly]:
    """Makes variants: `name`, `rotation`, `posture`, `rename`."""
    return make_assembly


@pytest.fixture(scope="session")
def assembly() -> Assembly:
    return make_assembly()


@pytest.fixture(scope="session")
def turned_assembly() -> Assembly:
    """The same furniture, folding along +x of the recipe, at another scale."""
    return make_assembly(rotation=np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]), posture="folded")


@pytest.fixture(scope="session")
def original(assembly: Assembly, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A print folder of the assembly, not to be touched."""
    folder = tmp_path_factory.mktemp("prints") / "stool"
    write(assembly, folder)
    return folder


@pytest.fixture
def written(original: Path, tmp_path: Path) -> Path:
    """A print folder of the assembly, to do anything with."""
    return Path(shutil.copytree(original, tmp_path / "stool"))


def make_assembly(
    *,
    name: str = "stool",
    rotation: Array | None = None,
    posture: Posture = "open",
    rename: Callable[[str], str] = lambda name: name,
) -> Assembly:
    """Two units: the flap folds first (t to 0.5), then the leg."""
    turn = np.eye(3) if rotation is None else rotation
    bodies, axes = _bodies()
    times = np.linspace(0.0, 1.0, KEYS)
    poses = _poses(times, axes)
    normals = {"floor": [0, 0, 1], "top": [0, 0, 1]}
    return Assembly(
        solution=_solution(name, turn, posture),
        bodies=tuple(
            _body(rename(key), solid, normals.get(key, [1, 0, 0]), axes["inner"] if "leg" in key else None)
            for key, solid in sorted(bodies.items())
        ),
        joints=tuple(
            Joint(key, (rename(a), rename(b)), axes[key], K / 2, (-1.0, hi), key == "inner")
            for key, a, b, hi in (
                ("flap:base", "floor", "flap", 90.0),
                ("inner", "leg/1", "leg/2", 180.0),
                ("leg:base", "floor", "leg/1", 90.0),
                ("leg:top", "top", "leg/2", 90.0),
            )
        ),
        times=times,
        poses={rename(key): value for key, value in poses.items()},
        posture=posture,
        findings=(Finding("snap", "The leg first rises by 0.1 mm."),),
    )


def _bodies() -> tuple[dict[str, Manifold], dict[str, Array]]:
    x0, x1 = 0.0, 45.0
    z1 = RISE + LEG
    z2 = z1 + LEG
    offset = (K + G) / 2
    axes = {
        "leg:base": _axis(x0, RISE),
        "inner": _axis(x0 + offset, z1),
        "leg:top": _axis(x0, z2),
        "flap:base": _axis(x1, RISE),
    }
    floor = _box((-50, -5, -K), (75, WIDTH + 5, 0))
    floor += _knuckles(x0, RISE, 0, foot=0.0) + _knuckles(x1, RISE, 0, foot=0.0)
    top = _box((-40, -5, z2 + RISE), (30, WIDTH + 5, z2 + RISE + K)) + _knuckles(x0, z2, 0, foot=z2 + RISE)
    lower = _box((-K / 2, 0, RISE), (K / 2, WIDTH, z1 - G / 2))
    upper = _box((-K / 2, 0, z1 + G / 2), (K / 2, WIDTH, z2))
    lower = lower - _clearing(x0, RISE, 0) - _clearing(x0 + offset, z1, 1)
    upper = upper - _clearing(x0, z2, 0) - _clearing(x0 + offset, z1, 0)
    lower += _knuckles(x0, RISE, 1) + _knuckles(x0 + offset, z1, 0, web=-2.8)
    upper += _knuckles(x0, z2, 1) + _knuckles(x0 + offset, z1, 1, web=2.8)
    flap = _box((x1 - K / 2, 0, RISE), (x1 + K / 2, WIDTH, RISE + FLAP)) - _clearing(x1, RISE, 0)
    flap += _knuckles(x1, RISE, 1)
    return {"floor": floor, "top": top, "leg/1": lower, "leg/2": upper, "flap": flap}, axes


def _poses(times: Array, axes: dict[str, Array]) -> dict[str, Array]:
    half = np.pi / 2
    poses = {name: np.tile(np.eye(4), (len(times), 1, 1)) for name in ("floor", "top", "leg/1", "leg/2", "flap")}
    offset = (K + G) / 2
    for i, t in enumerate(times):
        fold, leg = half * min(1.0, 2 * t), half * max(0.0, 2 * t - 1)
        poses["flap"][i] = _about(axes["flap:base"][0], fold)
        poses["leg/1"][i] = _about(axes["leg:base"][0], -leg)
        drop = 2 * LEG * (np.cos(leg) - 1) + 2 * offset * np.sin(leg)
        poses["top"][i, 2, 3] = drop
        upper = _about(axes["leg:top"][0], leg)
        upper[2, 3] += drop
        poses["leg/2"][i] = upper
    return poses


def _about(point: Array, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    pose = np.eye(4)
    pose[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    pose[:3, 3] = point - pose[:3, :3] @ point
    return pose


def _axis(x: float, z: float) -> Array:
    return np.array([[x, 0.0, z], [x, WIDTH, z]])


def _box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Manifold:
    low_, high_ = np.array(low), np.array(high)
    return Manifold.cube((high_ - low_).tolist()).translate(low_.tolist())


def _rod(x: float, z: float, span: tuple[float, float], radius: float, sides: int = 32) -> Manifold:
    length = span[1] - span[0]
    rod = Manifold.cylinder(length, radius, radius, sides)
    return rod.rotate((-90.0, 0.0, 0.0)).translate((x, span[0], z))


def _knuckles(x: float, z: float, side: int, *, foot: float | None = None, web: float | None = None) -> Manifold:
    """Every second knuckle, with a foot to a base's face at height `foot`, or a web into its panel."""
    parts = []
    for span in SPANS[side::2]:
        parts.append(_rod(x, z, span, K / 2))
        if foot is not None:
            z_lo, z_hi = sorted((z, foot + (0.5 if foot > z else -0.5)))
            parts.append(_box((x - K / 2, span[0], z_lo), (x + K / 2, span[1], z_hi)))
        if web is not None:
            z_lo, z_hi = sorted((z + np.sign(web) * G / 2, z + web))
            parts.append(_box((x - (K + G) / 2, span[0], z_lo), (x + K / 4, span[1], z_hi)))
    return Manifold.batch_boolean(parts, OpType.Add)


def _clearing(x: float, z: float, side: int) -> Manifold:
    """Room around the other part's knuckles."""
    radius = float(np.hypot(K / 2, K / 2 + G)) + G
    return Manifold.batch_boolean([_rod(x, z, (a - G, b + G), radius) for a, b in SPANS[side::2]], OpType.Add)


def _body(name: str, solid: Manifold, normal: list[int], axis: Array | None) -> Body:
    assert solid.status().name == "NoError" and len(solid.decompose()) == 1, name
    mesh = solid.to_mesh64()
    vertices, faces = np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts).astype(np.int64)
    hinge = np.zeros(0, dtype=np.int64)
    if axis is not None:
        middles = vertices[faces].mean(axis=1)
        hinge = np.flatnonzero(np.hypot(middles[:, 0] - axis[0, 0], middles[:, 2] - axis[0, 2]) < K / 2 + 0.01)
    kind: Literal["base", "panel"] = "base" if name in ("floor", "top") else "panel"
    return Body(name, kind, vertices, faces, np.array(normal, dtype=float), solid.volume(), hinge)


def _solution(name: str, turn: Array, posture: Posture) -> FoldSolution:
    thickness = Thickness(K, G)
    scaffold = _scaffold(name, turn, posture)
    share = WIDTH * FLAP / (WIDTH * FLAP + WIDTH * 2 * LEG)
    modifications = (
        Modification("flap", "slanted", 0, "r", (0.0, 1.0), share, 0.0),
        Modification("leg", "in-place", 1, "l", (0.0, 1.0), 1 - share, (1 - share) * 0.5 / 3, "to fold in place"),
    )
    ramp = np.array([0.0, 1.0])
    still = {"floor": np.zeros((2, 3)), "top": np.zeros((2, 3))}
    steps = tuple(
        Step(unit, (patch,), a, b, ramp, still, {patch: ramp}, {patch: 0 * ramp})
        for unit, patch, a, b in (("unit 1", "flap", 0.0, 0.5), ("unit 2", "leg", 0.5, 1.0))
    )
    cost = modifications[1].cost
    chains: tuple[Chain, ...] = ()
    return FoldSolution(scaffold, thickness, chains, modifications, steps, cost, cost)


def _scaffold(name: str, turn: Array, posture: Posture) -> Scaffold:
    def part(key: str, center: tuple[float, ...], size: tuple[float, ...]) -> Part:
        return Part(key, np.array(center) * 10 @ turn, np.array(size) * 10, turn)

    recipe = Recipe(
        name=name,
        direction=np.array([0.0, 0, -1]) @ turn,
        parts=(
            part("floor", (12.5, 20, -2), (125, 50, 4)),
            part("top", (-5, 20, 66.6), (70, 50, 4)),
            part("leg", (0, 20, 32.3), (4, 40, 60)),
            part("flap", (45, 20, 14.8), (4, 40, 25)),
        ),
        fold=FoldOptions(),
        print=PrintOptions(printer=Printer("Prusa MK4", (250.0, 210.0, 220.0)), posture=posture, scale=0.1),
        about="A stool for tests.",
    )
    outline = Outline("floor", np.array([12.5, 20.0]), np.array([1.0, 0.0]), np.array([62.5, 25.0]))
    up, along = np.array([0.0, 0, 1]), np.array([0.0, 1, 0])
    return Scaffold(
        recipe=recipe,
        direction=np.array([0.0, 0, -1]) @ turn,
        rotation=turn,
        scale=0.1,
        bases=(
            BasePatch("floor", ("floor",), -2.0, -2.0, (outline,)),
            BasePatch("top", ("top",), 66.6, 66.6, (outline,)),
        ),
        patches=(
            Patch("flap", ("flap",), np.array([45.0, 20, 14.8]), along, up, WIDTH, FLAP, "floor", None),
            Patch("leg", ("leg",), np.array([0.0, 20, 32.3]), along, up, WIDTH, 2 * LEG, "floor", "top"),
        ),
    )
