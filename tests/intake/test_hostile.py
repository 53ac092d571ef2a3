"""Hostile files do no harm: each has its message, in bounded memory, and nothing outside their folder is touched."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import pytest

from .furniture import glb, gltf, meshes, mjcf, model_xml, obj, stl, threemf, urdf
from .hostile import BAIT, lay_out

LEAST = 50
MOST_MEMORY = 1 << 30
"""Bytes."""

WATCHED = """
import json, os, resource, sys
from pathlib import Path
from foldfab.errors import RecipeError
from foldfab.pipeline import load

folder, good = (Path(path).resolve() for path in sys.argv[1:3])
for file in sorted(good.iterdir()):
    load(str(file))

LIBRARIES = tuple(os.path.realpath(path) for path in (sys.prefix, sys.base_prefix, *filter(None, sys.path)))
CHANGES = ("os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.symlink", "os.link", "os.chmod", "os.truncate",
           "tempfile.mkstemp", "tempfile.mkdtemp", "subprocess.Popen", "os.system", "os.exec", "os.posix_spawn",
           "os.fork", "socket.connect", "socket.getaddrinfo", "ctypes.dlopen", "urllib.Request")
touched = []

def watch(event, values):
    if event in CHANGES:
        touched.append([event, repr(values)[:200]])
    elif event in ("open", "os.listdir", "os.scandir") and isinstance(values[0], (str, bytes, os.PathLike)):
        path = os.path.realpath(os.fsdecode(values[0]))
        writes = event == "open" and (values[2] or 0) & (os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC)
        if writes or not path.startswith((str(folder) + os.sep, *LIBRARIES)):
            touched.append([event, path])

sys.addaudithook(watch)
said = {}
for name in json.loads(sys.argv[3]):
    try:
        load(str(folder / name))
        said[name] = "was read"
    except RecipeError as error:
        said[name] = str(error)
    except Exception as error:
        said[name] = "crashed: " + repr(error)
last = list(touched)
for outside in sys.argv[4:]:
    open(outside).close()
peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps({"said": said, "touched": last, "noticed": len(touched) - len(last), "peak": peak}))
"""


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What a process says that reads all of them under watch, and what each should say."""
    top = tmp_path_factory.mktemp("hostile")
    folder, good = top / "in" / "folder", top / "good"
    folder.mkdir(parents=True)
    good.mkdir()
    (good / "a.obj").write_text(obj(meshes()), encoding="utf-8")
    (good / "a.glb").write_bytes(glb(*gltf(meshes(), embed=False)))
    (good / "a.stl").write_bytes(stl(meshes()["Top"]))
    (good / "a.urdf").write_text(urdf(), encoding="utf-8")
    (good / "a.mjcf").write_text(mjcf(), encoding="utf-8")
    threemf(good / "a.3mf", model_xml(meshes()))
    expected = lay_out(folder)
    before = {str(path): path.lstat().st_mtime_ns for path in top.rglob("*")}
    bait = [str(folder.parent / name) for name in BAIT]
    command = [sys.executable, "-c", WATCHED, str(folder), str(good), json.dumps(list(expected)), *bait]
    run = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False, timeout=300)
    assert run.returncode == 0, run.stderr
    after = {str(path): path.lstat().st_mtime_ns for path in top.rglob("*")}
    return json.loads(run.stdout) | {"expected": expected, "is_same": before == after}


def test_there_are_enough_of_them(outcome: dict[str, Any]) -> None:
    assert len(outcome["expected"]) >= LEAST


def test_each_has_its_message(outcome: dict[str, Any]) -> None:
    said, expected = outcome["said"], outcome["expected"]
    wrong = {name: said[name] for name, says in expected.items() if says not in said[name]}
    assert wrong == {}


def test_nothing_outside_the_folder_is_touched(outcome: dict[str, Any]) -> None:
    assert outcome["touched"] == []
    assert outcome["is_same"]


def test_the_watch_notices(outcome: dict[str, Any]) -> None:
    assert outcome["noticed"] == len(BAIT)


def test_memory_is_bounded(outcome: dict[str, Any]) -> None:
    assert outcome["peak"] < MOST_MEMORY
