"""What holds for every face: it is a smooth, bounded function of its action units."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.body.action_units import CHANNELS
from kinesic.face.assets.action_units import deform, intensities, shape_weights
from kinesic.face.assets.lids import lids
from kinesic.face.assets.lips import lips
from kinesic.face.assets.mesh import load_head

from ...examples import examples

MESH = load_head("female")
LIPS, LIDS = lips(MESH), (lids(MESH, "Left", 0), lids(MESH, "Right", 1))
FREE = np.full(len(MESH.positions), True)  # (v,) what gives way to nothing
for touching in (LIPS.upper.skin, LIPS.lower.skin, *(lid.skin for lid in LIDS), *(lid.lashes for lid in LIDS)):
    FREE[touching] = False
units = st.dictionaries(st.sampled_from(CHANNELS), st.floats(0.0, 1.0), max_size=8)


@examples(60)
@given(units)
def test_weights_are_shares_and_the_face_stays_a_face(told: dict[str, float]):
    found = shape_weights(MESH, told)
    assert found.min() >= 0.0
    assert found.max() <= 1.0
    away = np.linalg.norm(deform(MESH, told) - MESH.positions, axis=1)
    assert np.all(np.isfinite(away))
    assert away.max() < 0.08


@examples(60)
@given(units, st.sampled_from(CHANNELS), st.floats(0.0, 0.99))
def test_a_little_more_moves_a_little_and_some_more_where_lips_and_lids_touch(
    told: dict[str, float], channel: str, value: float
):
    before, after = (deform(MESH, {**told, channel: each}) for each in (value, value + 0.01))
    moved = np.linalg.norm(after - before, axis=1)
    assert moved[FREE].max() < 0.01 * 0.08
    assert moved.max() < 0.007, "lips jump where a corner comes into another column"


@settings(max_examples=30, deadline=None)
@given(units)
def test_telling_twice_shows_the_same(told: dict[str, float]):
    assert np.array_equal(deform(MESH, told), deform(MESH, dict(reversed(told.items()))))
    assert np.array_equal(intensities(told), intensities({**dict.fromkeys(CHANNELS, 0.0), **told}))
