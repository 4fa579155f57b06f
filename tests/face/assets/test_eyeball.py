import numpy as np

from kinesic.face.assets.eyeball import BULGE, CORNEA, cornea_bulge


def test_the_cornea_ends_without_an_edge():
    near = cornea_bulge(np.array([0.0, CORNEA - 1e-4, CORNEA, 1.0]))
    np.testing.assert_allclose(near[0], BULGE)
    assert 0.0 < near[1] < 1e-7
    assert not near[2:].any()
