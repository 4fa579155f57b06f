import numpy as np
import pytest

from kinesic.bench.naturalness.whole_body.lexicon import PERFORMANCE_COUNT, list_seeded_gestures, perform_gestures
from kinesic.bench.naturalness.whole_body.measures import measure_whole_body
from kinesic.bench.naturalness.whole_body.posture import measure_posture


@pytest.fixture(scope="module")
def motion():
    """Return the body motion of one gesture on the default robot."""
    (motion,) = perform_gestures("upper22", [("large", 3)])
    return motion


def test_trunk_and_hand_of_the_robot_move_during_a_gesture(motion):
    measures = measure_whole_body(motion)
    assert measures.largest_speed > 0.5
    assert measures.trunk > 0.5
    assert measures.stroke_speed is not None
    assert 0.0 < measures.flow <= 1.0


def test_arm_length_of_the_robot_is_the_same_in_every_frame(motion):
    upper = np.linalg.norm(motion.elbows - motion.shoulders, axis=-1)
    fore = np.linalg.norm(motion.wrists - motion.elbows, axis=-1)
    assert upper + fore == pytest.approx(np.full(upper.shape, motion.arm), rel=1e-3)


def test_robot_at_rest_has_its_head_within_30_degrees_of_level_and_arms_hanging(motion):
    posture = measure_posture(motion)
    assert abs(posture.head_pitch) < 30.0
    assert 0.7 < posture.down < 1.0


def test_measured_gestures_are_distributed_over_all_random_seeds():
    tasks = list_seeded_gestures()
    assert len({gesture for gesture, _ in tasks}) == len(tasks)
    for every in (1, 3):
        assert {seed for _, seed in list_seeded_gestures(every)} == set(range(PERFORMANCE_COUNT))
