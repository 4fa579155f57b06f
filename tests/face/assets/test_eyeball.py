import numpy as np

from kinesic.face.assets.eyeball import CORNEA_ANGLE, CORNEA_HEIGHT, compute_cornea_bulge


def test_cornea_joins_the_eyeball_smoothly():
    near = compute_cornea_bulge(np.array([0.0, CORNEA_ANGLE - 1e-4, CORNEA_ANGLE, 1.0]))
    np.testing.assert_allclose(near[0], CORNEA_HEIGHT)
    assert 0.0 < near[1] < 1e-7
    assert not near[2:].any()
