"""Arrays that cannot change behind one's back."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
"""Any float array; docstrings give its shape."""

Bools = NDArray[np.bool_]
"""Any boolean array; docstrings give its shape."""

Indices = NDArray[np.int64]
"""Any integer array; docstrings give its shape."""


def frozen(values: ArrayLike, *shape: int) -> Array:
    """A read-only float copy of `values`, checked to be finite and of `shape` (-1 matches any length).

    Raises:
        ValueError: the shape differs or a value is not finite.
    """
    array = np.array(values, dtype=np.float64)
    if array.ndim != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape, strict=True)):
        raise ValueError(f"expected shape {shape}, got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("array holds NaN or infinity")
    array.setflags(write=False)
    return array


def frozen_indices(values: ArrayLike, *shape: int) -> Indices:
    """A read-only integer copy of `values`, checked to be of `shape` (-1 matches any length)."""
    array = np.array(values, dtype=np.int64)
    if array.ndim != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape, strict=True)):
        raise ValueError(f"expected shape {shape}, got {array.shape}")
    array.setflags(write=False)
    return array
