"""Arrays that cannot change behind one's back."""

from __future__ import annotations

import math
from typing import Any, TypeGuard, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
"""Any float array; docstrings give its shape."""

Bools = NDArray[np.bool_]
"""Any boolean array; docstrings give its shape."""

Indices = NDArray[np.int64]
"""Any integer array; docstrings give its shape."""

Floats = TypeVar("Floats", Array, Indices)

FEW = 16
"""Up to this many numbers are looked at one by one."""


def frozen(values: ArrayLike, *shape: int) -> Array:
    """A read-only float copy of `values`, checked to be finite and of `shape` (-1 matches any length).

    What is frozen already is not copied again.

    Raises:
        ValueError: the shape differs or a value is not finite.
    """
    array: Array = values if _is_frozen(values, np.float64) else np.array(values, dtype=np.float64)
    _require_shape(array, shape)
    # A few numbers, as most arrays here hold, are judged faster one by one.
    is_finite = all(map(math.isfinite, array.ravel().tolist())) if array.size <= FEW else np.isfinite(array).all()
    if not is_finite:
        raise ValueError("array holds NaN or infinity")
    array.setflags(write=False)
    return array


def frozen_indices(values: ArrayLike, *shape: int) -> Indices:
    """A read-only integer copy of `values`, checked to be of `shape` (-1 matches any length)."""
    array: Indices = values if _is_frozen(values, np.int64) else np.array(values, dtype=np.int64)
    _require_shape(array, shape)
    array.setflags(write=False)
    return array


def handed(array: Floats) -> Floats:
    """A fresh array that nobody else holds, read-only from now on: freezing it takes no copy."""
    array.setflags(write=False)
    return array


def _is_frozen(values: object, kind: type) -> TypeGuard[Any]:
    """Whether it is an array of that kind, or all or part of one, that nobody writes to."""
    whole = values.base if isinstance(values, np.ndarray) and values.base is not None else values
    if not isinstance(values, np.ndarray) or not isinstance(whole, np.ndarray) or whole.base is not None:
        return False
    return values.dtype == kind and not values.flags.writeable and not whole.flags.writeable


def _require_shape(array: Array | Indices, shape: tuple[int, ...]) -> None:
    if array.shape == shape:
        return
    if array.ndim != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape, strict=True)):
        raise ValueError(f"expected shape {shape}, got {array.shape}")
