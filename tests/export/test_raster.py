"""What is seen at each pixel."""

import numpy as np

from foldfab.export.raster import NOTHING, covered, visible

# y runs down, so these turn clockwise on paper's axes and face the eye.
SQUARE = np.array([[[2.0, 2, 0], [2, 8, 0], [8, 2, 0]], [[8, 2, 0], [2, 8, 0], [8, 8, 0]]])


def test_a_square_covers_its_pixels_once() -> None:
    seen, depth = visible(SQUARE, 12, 12)
    rows, columns = np.nonzero(seen != NOTHING)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (2, 8, 2, 8)
    assert len(rows) == 49 and np.all(depth[seen != NOTHING] == 0)


def test_the_back_is_not_seen() -> None:
    assert not covered(SQUARE[:, ::-1], 12, 12).any()


def test_the_nearer_one_hides_the_other() -> None:
    nearer = SQUARE + np.array([1.0, 0.0, 5.0])
    seen, depth = visible(np.concatenate([nearer, SQUARE]), 12, 12)
    assert set(np.unique(seen[2:9, 3:10])) == {0, 1} and set(np.unique(seen[2:9, 2])) <= {2, 3}
    assert depth[5, 5] == 5.0


def test_depth_follows_the_plane_and_outside_is_clipped() -> None:
    leaning = np.array([[[-50.0, -50, -100], [-50, 150, 100], [150, -50, -100]]])
    _, depth = visible(leaning, 20, 20)
    rows = np.arange(20)[:, None] * np.ones(20)
    assert np.allclose(depth, rows - 50)


def test_nothing_to_draw() -> None:
    assert not covered(np.zeros((0, 3, 3)), 4, 4).any()
    assert not covered(np.zeros((2, 3, 3)), 4, 4).any()
