"""Tests of the mirrored side of a robot file."""

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.config import read_toml
from kinesic.body.robot import Robot
from kinesic.body.robot_mirror import with_both_sides
from kinesic.body.robot_schema import (
    CollisionTable,
    CouplingTable,
    ExclusionTable,
    HingeTable,
    LimitsTable,
    MirrorTable,
    RobotFile,
    SiteTable,
)

MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])


@pytest.fixture(scope="module")
def file() -> RobotFile:
    return read_toml(Robot.load().path, RobotFile)


@pytest.mark.parametrize("name", ["upper22", "upper36"])
@given(seed=st.integers(0, 1000))
def test_equal_left_and_right_angles_give_mirrored_postures(name, seed):
    skeleton = Robot.load(name).skeleton
    angles, chance = skeleton.rest.copy(), np.random.default_rng(seed)
    for joint, joint_name in enumerate(skeleton.names):
        if joint_name.startswith("l_"):
            angles[joint] = angles[skeleton.joint(f"r_{joint_name[2:]}")] = chance.uniform(-1.0, 1.0)
    frames = skeleton.frames(angles)
    for k, segment in enumerate(skeleton.segments):
        if segment.name.startswith("l_"):
            other = skeleton.segment(f"r_{segment.name[2:]}")
            np.testing.assert_allclose(frames.origins[k], MIRROR_SIGNS * frames.origins[other], atol=1e-12)
            np.testing.assert_allclose(
                frames.rotations[k], frames.rotations[other] * np.outer(MIRROR_SIGNS, MIRROR_SIGNS), atol=1e-12
            )
            for capsule, image in zip(segment.capsules, skeleton.segments[other].capsules, strict=True):
                np.testing.assert_allclose(capsule.start, MIRROR_SIGNS * image.start)
                np.testing.assert_allclose(capsule.end, MIRROR_SIGNS * image.end)
                assert capsule.radius == image.radius


def test_robot_file_without_a_mirror_setting_is_unchanged(file):
    plain = msgspec.structs.replace(file, robot=msgspec.structs.replace(file.robot, mirror=None))
    assert with_both_sides(plain) is plain


def test_right_entries_in_a_robot_file_override_mirrored_left_ones(file):
    changed = msgspec.structs.replace(
        file,
        rest=file.rest | {"r_elbow_flexion": 70.0},
        sites=file.sites | {"r_palm": SiteTable("r_wrist", (0.0, 0.0, -0.5), (1.0, 0.0, 0.0))},
    )
    both = with_both_sides(changed)
    assert (both.rest["r_elbow_flexion"], both.rest["l_elbow_flexion"]) == (70.0, file.rest["l_elbow_flexion"])
    assert both.sites["r_palm"].at == (0.0, 0.0, -0.5)
    assert with_both_sides(file).sites["r_palm"].body == "r_wrist"


def test_mirrored_hinges_mounts_chains_and_bodies_get_the_other_prefix(file):
    both = with_both_sides(file)
    hinges = {hinge.name: hinge for hinge in both.hinge}
    elbow, image = hinges["l_elbow_flexion"], hinges["r_elbow_flexion"]
    assert (image.body, image.mount.body) == (
        elbow.body.replace("l_", "r_", 1),
        elbow.mount.body.replace("l_", "r_", 1),
    )
    assert image.range_deg == elbow.range_deg
    assert both.chains["r_arm"] == [
        name.replace("l_", "r_", 1) if name.startswith("l_") else name for name in both.chains["l_arm"]
    ]
    bodies = {body.name: body for body in both.body}
    assert bodies["r_elbow"].parent == bodies["l_elbow"].parent.replace("l_", "r_", 1)
    assert bodies["r_elbow"].mass == bodies["l_elbow"].mass
    assert len(both.hinge) == len(hinges)


def test_excluded_collision_pairs_of_a_robot_file_are_mirrored_once(file):
    pairs = [("l_wrist", "l_elbow"), ("l_wrist", "r_wrist"), ("l_wrist", "r_elbow"), ("vl5", "skullbase")]
    entries = [ExclusionTable(pair, "why") for pair in pairs]
    changed = msgspec.structs.replace(file, collision=CollisionTable(0.01, entries))
    results = [frozenset(entry.pair) for entry in with_both_sides(changed).collision.exclude]
    assert results == [
        frozenset(pair)
        for pair in (
            ("l_wrist", "l_elbow"),
            ("r_wrist", "r_elbow"),
            ("l_wrist", "r_wrist"),
            ("l_wrist", "r_elbow"),
            ("r_wrist", "l_elbow"),
            ("vl5", "skullbase"),
        )
    ]


def test_couplings_and_hinges_without_servo_are_mirrored(file):
    coupling = CouplingTable("l_thumb", "l_wrist", (0.1, 0.2, 0.3), (0.0, 90.0), "l_elbow_flexion", 0.5, 3.0)
    hinge = HingeTable(
        "l_own", "l_wrist", (0.1, 0.2, 0.3), (0.0, 9.0), limits=LimitsTable(1.0, 2.0, 3.0), at=(1.0, 2.0, 3.0)
    )
    both = with_both_sides(msgspec.structs.replace(file, coupling=[coupling], hinge=[hinge]))
    assert both.coupling[1] == CouplingTable(
        "r_thumb", "r_wrist", (-0.1, 0.2, -0.3), (0.0, 90.0), "r_elbow_flexion", 0.5, 3.0
    )
    assert both.hinge[1] == HingeTable(
        "r_own", "r_wrist", (-0.1, 0.2, -0.3), (0.0, 9.0), limits=hinge.limits, at=(1.0, -2.0, 3.0)
    )


def test_left_and_right_name_prefixes_come_from_the_robot_file(file):
    own = msgspec.structs.replace(file.robot, mirror=MirrorTable("r_", "l_"))
    changed = msgspec.structs.replace(file, robot=own, rest={"r_elbow_flexion": 2.0, "vl5_tilt": 3.0})
    assert with_both_sides(changed).rest == {"l_elbow_flexion": 2.0, "r_elbow_flexion": 2.0, "vl5_tilt": 3.0}
