from dataclasses import replace

import msgspec
import numpy as np

from kinesic.body.robot import Robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.importer.rest_pose import with_exclusions


def test_arms_hang_at_rest_with_bent_elbows(tee_mapped, tee_path):
    robot = Robot.of(robot_from_tables(tee_mapped.file, tee_path))
    frames = robot.skeleton.frames(robot.skeleton.rest)
    for side, out in (("l", 1), ("r", -1)):
        shoulder, elbow, wrist = (
            frames.origins[robot.skeleton.segment(f"{side}_{part}")] for part in ("shoulder", "elbow", "wrist")
        )
        upper, fore = elbow - shoulder, wrist - elbow
        assert upper[2] < -0.9 * np.linalg.norm(upper)
        assert out * upper[1] > 0
        assert fore[0] > 0.3 * np.linalg.norm(fore)


def test_rest_pose_of_an_imported_robot_is_symmetric(tee_mapped):
    rest = tee_mapped.file.rest
    for name, angle in rest.items():
        if name.startswith("l_"):
            assert abs(angle - rest.get(f"r_{name[2:]}", 0.0)) < 0.1


def test_checked_segment_pairs_of_an_imported_robot_have_clearance_at_rest(tee_mapped, tee_path):
    robot = Robot.of(robot_from_tables(tee_mapped.file, tee_path))
    rest = CapsuleDistances(robot).clearance(robot.skeleton.rest[None])
    assert rest.distances[0] >= robot.min_clearance


def test_segment_pairs_that_overlap_at_rest_are_excluded_from_collision_checks_with_a_reason(tee_mapped, tee_path):
    fat = [
        msgspec.structs.replace(body, capsules=[msgspec.structs.replace(body.capsules[0], radius=0.3)])
        if body.name == "skullbase"
        else body
        for body in tee_mapped.file.body
    ]
    file = with_exclusions(msgspec.structs.replace(tee_mapped.file, body=fat), tee_path)
    listed = {frozenset(entry.pair): entry.why for entry in file.collision.exclude}
    assert "apart at rest" in listed[frozenset(("skullbase", "l_shoulder"))]
    robot = Robot.of(robot_from_tables(file, tee_path))
    assert CapsuleDistances(replace(robot)).clearance(robot.skeleton.rest[None]).distances[0] >= robot.min_clearance
