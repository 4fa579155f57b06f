"""What holds for every face: it is a smooth, bounded function of its action units."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.body.action_units import CHANNELS
from kinesic.face.assets.action_units import SEALS, deform, intensities, shape_weights
from kinesic.face.assets.mesh import VARIANTS, Mesh, load_head

from ...examples import examples

HEADS = [load_head(variant) for variant in VARIANTS]
MESH = load_head("female")
FASTEST = 0.1  # [m] that a vertex moves for a whole action unit: pressing shuts a mouth that is wide open
STEPS = (0.01, 0.001)  # the smaller, the smaller a jump that shows
NARROWING = ("18", "23", "L30", "R30")  # action units that move the corners of the mouth aside
units = st.dictionaries(st.sampled_from(CHANNELS), st.floats(0.0, 1.0), max_size=8)
pressed = st.builds(lambda told, seal: {**told, seal: 1.0}, units, st.sampled_from(SEALS))


@examples(60)
@given(units)
def test_weights_are_shares_and_the_face_stays_a_face(told: dict[str, float]):
    found = shape_weights(MESH, told)
    assert found.min() >= 0.0
    assert found.max() <= 1.0
    away = np.linalg.norm(deform(MESH, told) - MESH.positions, axis=1)
    assert np.all(np.isfinite(away))
    assert away.max() < 0.08


@examples(150)
@given(st.sampled_from(HEADS), units, st.sampled_from(CHANNELS), st.floats(0.0, 0.99), st.sampled_from(STEPS))
def test_a_little_more_moves_a_little(mesh: Mesh, told: dict[str, float], channel: str, value: float, step: float):
    assert farthest(mesh, told, channel, value, step) < step * FASTEST


@examples(150)
@given(st.sampled_from(HEADS), pressed, st.sampled_from(NARROWING), st.floats(0.0, 0.99), st.sampled_from(STEPS))
def test_a_little_more_moves_the_corners_of_pressed_lips_a_little(
    mesh: Mesh, told: dict[str, float], channel: str, value: float, step: float
):
    assert farthest(mesh, told, channel, value, step) < step * FASTEST


def farthest(mesh: Mesh, told: dict[str, float], channel: str, value: float, step: float) -> float:
    """Metres that some vertex moves when an action unit is told to be so much stronger."""
    before, after = (deform(mesh, {**told, channel: each}) for each in (value, value + step))
    return float(np.linalg.norm(after - before, axis=1).max())


@settings(max_examples=30, deadline=None)
@given(units)
def test_telling_twice_shows_the_same(told: dict[str, float]):
    assert np.array_equal(deform(MESH, told), deform(MESH, dict(reversed(told.items()))))
    assert np.array_equal(intensities(told), intensities({**dict.fromkeys(CHANNELS, 0.0), **told}))
