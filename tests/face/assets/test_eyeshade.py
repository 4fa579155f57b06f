import numpy as np
import pytest

from kinesic.body.choices import Variant
from kinesic.face.assets.eyeshade import make_eyeshade
from kinesic.face.assets.mesh import FACE_VARIANTS, load_head


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_eyeshade_is_symmetric_in_front_of_the_forehead(variant: Variant):
    mesh = load_head(variant)
    brim = make_eyeshade(mesh)
    assert brim.triangles.max() == len(brim.positions) - 1
    np.testing.assert_allclose(np.linalg.norm(brim.normals, axis=1), 1.0)
    assert np.all(brim.normals[:, 2] > 0.0)
    mirrored = brim.positions * (1.0, -1.0, 1.0)
    nearest = np.array([np.linalg.norm(brim.positions - point, axis=1).min() for point in mirrored])
    assert nearest.max() < 2e-3
    skin = mesh.positions[mesh.vertices("skin")]
    foremost = brim.positions[:, 0].max()
    assert foremost > skin[:, 0].max() + 0.01  # in front of the nose
    assert brim.positions[:, 2].min() > 0.02  # above the eyes
    apart = np.array([np.linalg.norm(skin - point, axis=1).min() for point in brim.positions])
    assert apart.min() < 0.006
