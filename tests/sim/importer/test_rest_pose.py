import numpy as np

from kinesic.sim.importer.draft import robot_of


def test_arms_rest_hanging_with_bent_elbows(tee_mapped, tee_path):
    robot = robot_of(tee_mapped.file, tee_path)
    frames = robot.skeleton.frames(robot.skeleton.rest)
    for side, out in (("l", 1), ("r", -1)):
        shoulder, elbow, wrist = (
            frames.origins[robot.skeleton.segment(f"{side}_{part}")] for part in ("shoulder", "elbow", "wrist")
        )
        upper, fore = elbow - shoulder, wrist - elbow
        assert upper[2] < -0.9 * np.linalg.norm(upper)
        assert out * upper[1] > 0
        assert fore[0] > 0.3 * np.linalg.norm(fore)


def test_rest_is_the_same_on_both_sides(tee_mapped):
    rest = tee_mapped.file.rest
    for name, angle in rest.items():
        if name.startswith("l_"):
            assert abs(angle - rest.get(f"r_{name[2:]}", 0.0)) < 0.1
