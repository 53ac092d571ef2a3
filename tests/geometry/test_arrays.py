"""Frozen arrays are checked copies that nobody can change."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.geometry.arrays import frozen, frozen_indices, handed


def test_a_frozen_array_does_not_follow_what_it_was_made_from() -> None:
    source = np.zeros(3)
    copy = frozen(source, 3)
    source[0] = 1.0
    assert copy.tolist() == [0.0, 0.0, 0.0]


def test_a_frozen_array_cannot_be_written() -> None:
    for array in (frozen([1.0, 2.0], 2), frozen_indices([1, 2], 2)):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 3


@pytest.mark.parametrize("shape", [(2,), (3, 1), ()])
def test_a_wrong_shape_is_told(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"expected shape .* got \(3,\)"):
        frozen([1.0, 2.0, 3.0], *shape)
    with pytest.raises(ValueError, match=r"expected shape .* got \(3,\)"):
        frozen_indices([1, 2, 3], *shape)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_only_finite_values_are_taken(value: float) -> None:
    with pytest.raises(ValueError, match="NaN or infinity"):
        frozen([0.0, value], 2)


def test_minus_one_matches_any_length() -> None:
    assert frozen(np.zeros((7, 3)), -1, 3).shape == (7, 3)
    assert frozen_indices(np.zeros((0, 2)), -1, 2).shape == (0, 2)


def test_what_is_frozen_or_handed_over_is_not_copied_again() -> None:
    once = frozen([1.0, 2.0, 3.0, 4.0], 4)
    assert frozen(once, 4) is once
    fresh = np.arange(6)
    kept = frozen_indices(handed(fresh).reshape(2, 3), 2, 3)
    assert np.shares_memory(kept, fresh)
    with pytest.raises(ValueError, match="read-only"):
        fresh[0] = 3


def test_what_somebody_can_still_write_to_is_copied() -> None:
    source = np.zeros(4)
    view = source[:2]
    view.setflags(write=False)
    single = np.zeros(2, dtype=np.float32)
    single.setflags(write=False)
    for given in (view, single, np.frombuffer(bytes(16))):
        copy = frozen(given, 2)
        assert not np.shares_memory(copy, given)
        assert copy.dtype == np.float64


def test_a_frozen_array_of_another_shape_is_refused() -> None:
    with pytest.raises(ValueError, match="expected shape"):
        frozen(frozen([1.0, 2.0], 2), 3)


def test_a_read_only_view_is_copied() -> None:
    source = np.zeros(3)
    view = source[:]
    view.setflags(write=False)
    copy = frozen(view, 3)
    source[0] = 1.0
    assert copy.tolist() == [0.0, 0.0, 0.0]
