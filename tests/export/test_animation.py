"""The GLB is valid glTF and moves as the assembly does."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from foldfab.export.animation import glb_bytes
from foldfab.export.frames import moved, sheet_poses
from foldfab.export.read_glb import pose, read_glb
from foldfab.export.shell import sheet_shells
from foldfab.fabrication.model import Assembly


@pytest.fixture(params=["assembly", "turned_assembly"])
def case(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Assembly, Path]:
    assembly = request.getfixturevalue(request.param)
    path = tmp_path / "stool.glb"
    path.write_bytes(glb_bytes(assembly, sheet_shells(assembly)))
    return assembly, path


def test_trimesh_reads_it_in_metres_with_y_up(case: tuple[Assembly, Path]) -> None:
    assembly, path = case
    scene = trimesh.load(path)
    assert isinstance(scene, trimesh.Scene) and len(scene.geometry) >= len(assembly.bodies)
    points = np.vstack([shell.vertices for shell in sheet_shells(assembly)])
    x, y, z = np.ptp(points, axis=0) / 1000
    assert np.allclose(np.ptp(scene.bounds, axis=0), [x, z, y], atol=1e-6)


def test_the_buffer_is_laid_out_by_the_rules(case: tuple[Assembly, Path]) -> None:
    document, data = _chunks(case[1])
    assert document["buffers"][0]["byteLength"] == len(data)
    for view in document["bufferViews"]:
        assert view["byteOffset"] % 4 == 0 and view["byteOffset"] + view["byteLength"] <= len(data)
    for accessor in document["accessors"]:
        view = document["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        kind = np.float32 if accessor["componentType"] == 5126 else np.uint32
        values = np.frombuffer(data, kind, accessor["count"] * width, view["byteOffset"]).reshape(-1, width)
        assert view["byteLength"] == values.nbytes
        assert values.min(axis=0).tolist() == accessor["min"] and values.max(axis=0).tolist() == accessor["max"]


def test_every_body_moves_as_in_the_assembly(case: tuple[Assembly, Path]) -> None:
    assembly, path = case
    fold = read_glb(path)
    assert fold.seconds == pytest.approx(8.0)
    for shell in sheet_shells(assembly):
        vertices, _ = fold.meshes[shell.name]
        for key in (0, 7, 30, 44, 60):
            found = moved(vertices, pose(fold, shell.name, float(assembly.times[key])))
            wanted = moved(shell.vertices, sheet_poses(assembly, shell.name)[key])
            assert np.allclose(found.min(axis=0), wanted.min(axis=0), atol=1e-3)
            assert np.allclose(found.max(axis=0), wanted.max(axis=0), atol=1e-3)


def test_what_rests_has_no_keys(case: tuple[Assembly, Path]) -> None:
    document, _ = _chunks(case[1])
    names = [node["name"] for node in document["nodes"]]
    channels = {
        (names[channel["target"]["node"]], channel["target"]["path"]): channel["sampler"]
        for channel in document["animations"][0]["channels"]
    }
    assert not any(name == "floor" for name, _ in channels)
    assert ("top", "rotation") not in channels and ("flap", "translation") not in channels
    sampler = document["animations"][0]["samplers"][channels["flap", "rotation"]]
    assert document["accessors"][sampler["input"]]["count"] == 32


def test_furniture_that_does_not_move_has_no_animation(assembly: Assembly) -> None:
    import dataclasses

    still = {name: np.tile(np.eye(4), (len(assembly.times), 1, 1)) for name in assembly.poses}
    data = glb_bytes(dataclasses.replace(assembly, poses=still), sheet_shells(assembly))
    assert b'"animations"' not in data


def _chunks(path: Path) -> tuple[dict[str, Any], bytes]:
    blob = path.read_bytes()
    assert struct.unpack_from("<4sII", blob) == (b"glTF", 2, len(blob))
    size = struct.unpack_from("<I", blob, 12)[0]
    assert size % 4 == 0
    return json.loads(blob[20 : 20 + size]), blob[28 + size :]
