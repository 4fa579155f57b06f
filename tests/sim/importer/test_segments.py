import numpy as np
import pytest

from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.hinges import name_hinges
from kinesic.sim.importer.segments import (
    ARM_TRUNK_GAP,
    convert_capsules,
    lay_out_segments,
    make_bone_capsule,
    make_trunk_capsules,
    round_triple,
)


def test_segment_origins_of_an_imported_robot_are_the_joint_centres(tee_figure):
    where = lay_out_segments(tee_figure, name_hinges(tee_figure))
    left = tee_figure.arms["l"].centres
    assert where.carrier == "vl5"
    assert where.parents["l_shoulder"] == "l_acromioclavicular"
    assert where.origins["l_elbow"] == pytest.approx(left.elbow)
    assert where.origins["skullbase"] == pytest.approx([0, 0, 1.55], abs=1e-3)
    assert where.inside("l_elbow", left.elbow) == pytest.approx(np.zeros(3))


def test_imported_upper_body_segments_keep_their_masses(tee_mapped):
    mass = {body.name: body.mass for body in tee_mapped.file.body}
    assert mass["humanoid_root"] == pytest.approx(4.0)
    assert mass["vl5"] == pytest.approx(8.0)
    assert mass["skullbase"] == pytest.approx(2.0)
    arm = [mass[f"l_{part}"] for part in ("acromioclavicular", "shoulder", "elbow", "wrist")]
    assert arm == pytest.approx([0.0, 1.2, 0.8, 0.3], abs=0.02)


def test_shapes_of_an_imported_file_are_used_and_missing_ones_are_generated(tee_mapped, hanging_mapped):
    own, made = ({body.name: body.capsules for body in item.file.body} for item in (tee_mapped, hanging_mapped))
    assert own["l_shoulder"][0].radius == 0.035
    assert made["l_shoulder"][0].radius == pytest.approx(0.15 * 0.28, rel=0.01)


def test_bone_capsule_begins_after_the_given_fraction_of_the_bone():
    capsule = make_bone_capsule(np.zeros(3), np.array([0.0, 0, -1]), 0.1, free_fraction=0.2)
    assert capsule.start == pytest.approx((0, 0, -0.2))
    assert capsule.end == (0, 0, -1)


def test_imported_shapes_are_converted_to_the_frame_of_their_segment():
    (capsule,) = convert_capsules([Capsule(np.array([1.0, 0, 0]), np.array([1.0, 0, 1]), 0.1)], np.array([1.0, 0, 0.5]))
    assert (capsule.start, capsule.end, capsule.radius) == ((0, 0, -0.5), (0, 0, 0.5), 0.1)


@pytest.mark.parametrize("tall", [0.1, 0.3, 0.6])
def test_trunk_capsules_leave_space_for_hanging_arms(tall):
    capsules = make_trunk_capsules(np.zeros(3), np.array([0.0, 0, tall]), 0.2, 0.04)
    widest = max(abs(capsule.end[1]) + capsule.radius for capsule in capsules)
    assert widest <= 0.2 - 0.04 - ARM_TRUNK_GAP + 1e-6
    assert all(capsule.end[2] < tall for capsule in capsules)


def test_rounded_coordinates_of_imported_segments_have_no_negative_zero():
    assert str(round_triple(np.array([-1e-9, -0.0, -0.25]))) == "(0.0, 0.0, -0.25)"
