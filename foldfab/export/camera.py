"""Where pictures are taken from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.geometry.arrays import Array


@dataclass(frozen=True, slots=True)
class Camera:
    """An orthographic view on the sheet frame, Z up."""

    azimuth: float
    """Degrees about Z that the eye stands from the -y side, counter-clockwise seen from above."""
    elevation: float
    """Degrees above the horizon."""

    def rows(self) -> Array:
        """(3, 3) unit directions of right, down and towards the eye."""
        a, e = np.radians(self.azimuth), np.radians(self.elevation)
        eye = np.array([np.sin(a) * np.cos(e), -np.cos(a) * np.cos(e), np.sin(e)])
        right = np.array([np.cos(a), np.sin(a), 0.0])
        return np.array([right, -np.cross(eye, right), eye])


@dataclass(frozen=True, slots=True)
class Window:
    """Which part of the view a picture shows, and how large."""

    width: int
    """pixels"""
    height: int
    """pixels"""
    scale: float
    """pixels a mm"""
    middle: tuple[float, float]
    """Right and down of the middle of the picture, mm."""


def projection(camera: Camera, window: Window) -> tuple[Array, Array]:
    """(3, 3) matrix and (3,) offset with points · matrix + offset = pixel coordinates."""
    right, down = window.middle
    offset = np.array([window.width / 2 - right * window.scale, window.height / 2 - down * window.scale, 0.0])
    return camera.rows().T * window.scale, offset


def pixels(points: Array, camera: Camera, window: Window) -> Array:
    """(n, 3) pixel coordinates of (n, 3) points: x right, y down, z towards the eye, all in pixels."""
    matrix, offset = projection(camera, window)
    return np.asarray(points @ matrix + offset)


def fitted(points: Array, camera: Camera, *, width: int, height: int, margins: tuple[float, float]) -> Window:
    """The largest scale at which all (n, 3) points are seen; margins right and left, above and below, in pixels."""
    view = points @ camera.rows()[:2].T
    low, high = view.min(axis=0), view.max(axis=0)
    room = np.array([width, height]) - 2 * np.array(margins)
    scale = float(np.min(room / np.maximum(high - low, 1e-6)))
    middle = (low + high) / 2
    return Window(width, height, scale, (float(middle[0]), float(middle[1])))
