from dataclasses import astuple

import numpy as np
import pytest

from kinesic.bench.naturalness.whole_body.posture import (
    COMPARED_FEATURES,
    SKELETON_FEATURES,
    measure_posture,
    posture_vector,
    starts_at_rest,
)

from .bodies import ARM, make_body, turn


def test_wrists_of_hanging_arms_are_measured_relative_to_the_shoulders():
    posture = measure_posture(make_body(bend=(30.0, 30.0)))
    assert posture.forward == pytest.approx(0.25 * np.sin(np.radians(30)) / ARM)
    assert posture.down == pytest.approx(0.25 * (1 + np.cos(np.radians(30))) / ARM)
    assert posture.out == pytest.approx(0.0, abs=1e-9)
    assert posture.breadth == pytest.approx(0.2 / ARM)
    assert posture.elbow_flexion == pytest.approx(30.0)
    assert posture.forward_difference == posture.flexion_difference == pytest.approx(0.0, abs=1e-6)


def test_posture_of_a_mirror_image_has_the_same_measures():
    left, right = (measure_posture(make_body(bend=bend)) for bend in ((10.0, 40.0), (40.0, 10.0)))
    assert left.flexion_difference == pytest.approx(30.0, abs=1e-3)
    assert astuple(left) == pytest.approx(astuple(right))


def test_head_angles_of_a_posture_are_measured_relative_to_the_shoulders():
    body = make_body()
    turned = turn("z", 15.0)[0] @ turn("y", 8.0)[0]
    object.__setattr__(body, "head_rotations", np.array([turned] * len(body.times)))
    posture = measure_posture(body)
    assert (posture.head_pitch, posture.head_turn) == pytest.approx((8.0, 15.0))


def test_heading_and_size_of_the_body_do_not_change_the_posture():
    body, turned = make_body(bend=(10.0, 40.0)), make_body(bend=(10.0, 40.0), scale=1.3)
    rotation = turn("z", 70.0)[0]
    for name in ("shoulders", "elbows", "wrists"):
        object.__setattr__(turned, name, getattr(turned, name) @ rotation.T)
    object.__setattr__(turned, "head_rotations", rotation @ turned.head_rotations)
    assert astuple(measure_posture(turned)) == pytest.approx(astuple(measure_posture(body)), abs=1e-9)


def test_posture_vector_excludes_features_that_depend_on_the_skeleton():
    assert len(posture_vector(measure_posture(make_body()))) == len(COMPARED_FEATURES)
    assert not SKELETON_FEATURES & set(COMPARED_FEATURES)


def test_clip_that_begins_in_motion_counts_as_not_starting_at_rest():
    assert starts_at_rest(make_body(swing=(0.0, 0.2)))
    body = make_body(swing=(0.0, 0.8))
    assert not starts_at_rest(body.clip(0.6, 2.0))
