"""Arrays that cannot change behind one's back."""

from __future__ import annotations

import math
from typing import TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
"""Any float array; docstrings give its shape."""

Bools = NDArray[np.bool_]
"""Any boolean array; docstrings give its shape."""

Indices = NDArray[np.int64]
"""Any integer array; docstrings give its shape."""

FEW = 16
"""Up to this many numbers are looked at one by one."""


def frozen(values: ArrayLike, *shape: int) -> Array:
    """A read-only float copy of `values`, checked to be finite and of `shape` (-1 matches any length).

    What is read-only already and nobody's view is taken as it is.

    Raises:
        ValueError: the shape differs or a value is not finite.
    """
    array = values if _is_read_only(values) else np.array(values, dtype=np.float64)
    _require_shape(array, shape)
    # A few numbers, as most arrays here hold, are judged faster one by one.
    is_finite = all(map(math.isfinite, array.ravel().tolist())) if array.size <= FEW else np.isfinite(array).all()
    if not is_finite:
        raise ValueError("array holds NaN or infinity")
    array.setflags(write=False)
    return array


def frozen_indices(values: ArrayLike, *shape: int) -> Indices:
    """A read-only integer copy of `values`, checked to be of `shape` (-1 matches any length)."""
    array = np.array(values, dtype=np.int64)
    _require_shape(array, shape)
    array.setflags(write=False)
    return array


def _is_read_only(values: ArrayLike) -> TypeGuard[Array]:
    """Whether nothing can write to what is a float array already, not even through an array that it is a view of."""
    if not isinstance(values, np.ndarray) or values.dtype != np.float64:
        return False
    return not values.flags.writeable and values.flags.owndata


def _require_shape(array: Array | Indices, shape: tuple[int, ...]) -> None:
    if array.shape == shape:
        return
    if array.ndim != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape, strict=True)):
        raise ValueError(f"expected shape {shape}, got {array.shape}")
