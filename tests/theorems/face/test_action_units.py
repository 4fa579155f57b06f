"""Every face is a smooth, bounded function of its action units."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.body.action_units import FACE_CHANNELS
from kinesic.face.assets.action_units import LIP_SEALING_UNITS, compute_shape_weights, deform, read_intensities
from kinesic.face.assets.mesh import FACE_VARIANTS, Mesh, load_head

from ...examples import examples

HEAD_MESHES = [load_head(variant) for variant in FACE_VARIANTS]
FEMALE_MESH = load_head("female")
MAX_DISPLACEMENT = 0.1  # [m] vertex displacement at full intensity that small changes may not exceed in proportion
STEP_SIZES = (0.01, 0.001)  # steps of an action unit's intensity; small steps reveal small discontinuities
NARROWING_UNITS = ("18", "23", "L30", "R30")  # action units that move the lip corners sideways
units = st.dictionaries(st.sampled_from(FACE_CHANNELS), st.floats(0.0, 1.0), max_size=8)
pressed = st.builds(lambda told, seal: {**told, seal: 1.0}, units, st.sampled_from(LIP_SEALING_UNITS))


@examples(60)
@given(units)
def test_shape_weights_are_between_0_and_1_and_vertices_move_less_than_8_cm(told: dict[str, float]):
    shape_weights = compute_shape_weights(FEMALE_MESH, told)
    assert shape_weights.min() >= 0.0
    assert shape_weights.max() <= 1.0
    away = np.linalg.norm(deform(FEMALE_MESH, told) - FEMALE_MESH.positions, axis=1)
    assert np.all(np.isfinite(away))
    assert away.max() < 0.08


@examples(150)
@given(
    st.sampled_from(HEAD_MESHES),
    units,
    st.sampled_from(FACE_CHANNELS),
    st.floats(0.0, 0.99),
    st.sampled_from(STEP_SIZES),
)
def test_small_changes_of_action_units_give_small_vertex_displacements(
    mesh: Mesh, told: dict[str, float], channel: str, value: float, step: float
):
    assert farthest(mesh, told, channel, value, step) < step * MAX_DISPLACEMENT


@examples(150)
@given(
    st.sampled_from(HEAD_MESHES),
    pressed,
    st.sampled_from(NARROWING_UNITS),
    st.floats(0.0, 0.99),
    st.sampled_from(STEP_SIZES),
)
def test_small_changes_of_action_units_with_pressed_lips_give_small_displacements(
    mesh: Mesh, told: dict[str, float], channel: str, value: float, step: float
):
    assert farthest(mesh, told, channel, value, step) < step * MAX_DISPLACEMENT


def farthest(mesh: Mesh, told: dict[str, float], channel: str, value: float, step: float) -> float:
    """Return the largest displacement [m] for a change of an action unit."""
    before, after = (deform(mesh, {**told, channel: item}) for item in (value, value + step))
    return float(np.linalg.norm(after - before, axis=1).max())


@settings(max_examples=30, deadline=None)
@given(units)
def test_face_deformation_depends_neither_on_unit_order_nor_on_zero_intensities(told: dict[str, float]):
    assert np.array_equal(deform(FEMALE_MESH, told), deform(FEMALE_MESH, dict(reversed(told.items()))))
    assert np.array_equal(read_intensities(told), read_intensities({**dict.fromkeys(FACE_CHANNELS, 0.0), **told}))
