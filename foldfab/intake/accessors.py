"""What glTF keeps in buffers: arrays behind accessors, views and references to files beside it."""

from __future__ import annotations

import base64
import binascii
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import unquote

import numpy as np

from foldfab.geometry.arrays import Array, Indices, handed
from foldfab.intake.inside import inside
from foldfab.intake.limits import check_vertices, content, fail

JsonObject = dict[str, Any]
Kind = TypeVar("Kind")

_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_UNSIGNED = (5121, 5123, 5125)
_FLOAT = 5126


@dataclass(frozen=True, slots=True, eq=False)
class Buffers:
    """The bytes behind a glTF document; each buffer is read once."""

    path: Path
    document: JsonObject
    binary: bytes
    """The binary chunk of a GLB."""
    read: dict[int, bytes] = field(default_factory=dict)


def entry(path: Path, holder: JsonObject, key: str, kind: type[Kind]) -> Kind:
    """What an object holds under a key, an empty one where it has none.

    Raises:
        RecipeError: it is of another kind.
    """
    found = holder.get(key)
    if found is None:
        return kind()
    if not isinstance(found, kind):
        fail(path, f"should be {'an object' if kind is dict else 'a list'}; the file is damaged", key)
    return found


def floats(buffers: Buffers, index: Any) -> Array:
    """(n, 3) coordinates of an accessor, quantised ones as what they stand for."""
    accessor, kind = _accessor(buffers, index, "VEC3")
    with np.errstate(invalid="ignore"):
        values: Array = _values(buffers, accessor, kind, 3).astype(np.float64)
    if accessor.get("normalized") and kind != _FLOAT:
        values = np.maximum(values / np.iinfo(_TYPES[kind]).max, -1.0)
    return handed(values)


def indices(buffers: Buffers, index: Any) -> Indices:
    """(n,) the numbers of vertices in an accessor."""
    accessor, kind = _accessor(buffers, index, "SCALAR")
    if kind not in _UNSIGNED:
        fail(buffers.path, "should be unsigned numbers; the file is damaged", f"accessors[{index}].componentType")
    found: Indices = _values(buffers, accessor, kind, 1).reshape(-1).astype(np.int64)
    return found


def _accessor(buffers: Buffers, index: Any, shape: str) -> tuple[JsonObject, int]:
    accessor = _listed(buffers, "accessors", index)
    kind = accessor.get("componentType")
    if accessor.get("type") != shape or kind not in _TYPES:
        fail(buffers.path, f"should be {shape} of a known component type", f"accessors[{index}]")
    if "sparse" in accessor:
        fail(buffers.path, "is sparse, which is not read; export it without", f"accessors[{index}]")
    return accessor, int(kind)


def _values(buffers: Buffers, accessor: JsonObject, kind: int, width: int) -> Any:
    """(n, width) as they are stored."""
    path = buffers.path
    count = _size(path, accessor, "count")
    check_vertices(path, count // 3 if width == 1 else count)
    if "bufferView" not in accessor:
        return np.zeros((count, width), _TYPES[kind])
    view = _listed(buffers, "bufferViews", accessor["bufferView"])
    item = np.dtype(_TYPES[kind]).itemsize
    stride = _size(path, view, "byteStride") or item * width
    start = _size(path, view, "byteOffset") + _size(path, accessor, "byteOffset")
    data = _bytes(buffers, view.get("buffer"))
    end = start + stride * (count - 1) + item * width if count else start
    if end > min(len(data), _size(path, view, "byteOffset") + _size(path, view, "byteLength")) or stride < item * width:
        fail(path, "an accessor reaches beyond its buffer; the file is truncated or damaged", "accessors")
    return np.ndarray((count, width), _TYPES[kind], data, start, (stride, item))


def _listed(buffers: Buffers, key: str, index: Any) -> JsonObject:
    values = entry(buffers.path, buffers.document, key, list)
    is_there = isinstance(index, int) and 0 <= index < len(values)
    if not is_there or not isinstance(values[index], dict):
        fail(buffers.path, f"there is no {key}[{str(index)[:20]}]; the file is damaged", key)
    found: JsonObject = values[index]
    return found


def _size(path: Path, holder: JsonObject, key: str) -> int:
    value = holder.get(key, 0)
    if not isinstance(value, int) or not 0 <= value < 1 << 40:
        fail(path, "should be a whole number that is not negative; the file is damaged", key)
    return value


def _bytes(buffers: Buffers, index: Any) -> bytes:
    buffer = _listed(buffers, "buffers", index)
    if index not in buffers.read:
        buffers.read[index] = _fetched(buffers, buffer.get("uri"))
    return buffers.read[index]


def _fetched(buffers: Buffers, uri: Any) -> bytes:
    if uri is None:
        return buffers.binary
    if not isinstance(uri, str):
        fail(buffers.path, "should be text", "buffers[].uri")
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=True)
        except (binascii.Error, ValueError):
            fail(buffers.path, "is not base64; the file is damaged", "buffers[].uri")
    return content(inside(buffers.path, unquote(uri), "buffers[].uri"))
