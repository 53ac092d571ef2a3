"""Where points fall on the picture."""

import numpy as np
import pytest

from foldfab.export.camera import Camera, Window, fitted, pixels

FRONT = Camera(azimuth=0.0, elevation=0.0)


def test_from_the_front_x_runs_right_and_z_up() -> None:
    window = Window(width=100, height=80, scale=2.0, middle=(0.0, 0.0))
    found = pixels(np.array([[10.0, -5.0, 20.0]]), FRONT, window)
    assert np.allclose(found, [[70.0, 0.0, 10.0]])


@pytest.mark.parametrize("azimuth", [-34.0, 0.0, 146.0])
@pytest.mark.parametrize("elevation", [0.0, 21.0, 62.0])
def test_views_are_right_handed(azimuth: float, elevation: float) -> None:
    right, down, eye = Camera(azimuth, elevation).rows()
    assert np.allclose(np.cross(right, -down), eye) and down[2] < 0
    assert np.allclose([right @ right, down @ down, eye @ eye], 1.0)


def test_fitted_points_fill_the_window_and_stay_in_it() -> None:
    points = np.random.default_rng(1).uniform(-50, 90, (40, 3))
    camera = Camera(-34.0, 21.0)
    found = pixels(points, camera, fitted(points, camera, width=300, height=200, margins=(10, 20)))[:, :2]
    low, high = found.min(axis=0), found.max(axis=0)
    assert np.all(low >= [10 - 1e-9, 20 - 1e-9]) and np.all(high <= [290 + 1e-9, 180 + 1e-9])
    assert np.isclose(high[0] - low[0], 280) or np.isclose(high[1] - low[1], 160)
