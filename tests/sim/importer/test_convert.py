from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.body.robot_schema import robot_text
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.importer.convert import _rate_confidence, import_humanoid
from kinesic.sim.importer.hinges import name_hinges
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.zero_pose import analyse_geometry

ROUNDING_TOLERANCE = 5e-6  # [m] error of rounding to micrometres


@pytest.fixture(scope="module")
def robot(tee_mapped, tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / "tee.toml"
    path.write_text(robot_text(tee_mapped.file, heading=["tee"], remarks=tee_mapped.remarks), encoding="utf-8")
    return Robot.load(path)


def test_hand_positions_of_an_imported_robot_equal_those_of_the_original_model(robot, tee):
    geometry = analyse_geometry(tee)
    hinges, skeleton = name_hinges(geometry), robot.skeleton
    zero = skeleton.frames(np.zeros(len(skeleton.names)))
    for angles in np.random.default_rng(0).uniform(skeleton.lower, skeleton.upper, (10, len(skeleton.names))):
        turned = geometry.tree.turned({h.joint: h.sign * angles[skeleton.joint(h.name)] for h in hinges})
        frames = skeleton.frames(angles)
        for side in "lr":
            k, tip = skeleton.segment(f"{side}_wrist"), geometry.arms[side].joints[-1]
            inside = geometry.tree.parts[tip].centre - zero.origins[k]
            assert frames.origins[k] + frames.rotations[k] @ inside == pytest.approx(
                turned.parts[tip].centre, abs=ROUNDING_TOLERANCE
            )


@pytest.mark.filterwarnings("ignore:Inertia matrix")  # masses are not used
def test_joint_angles_of_a_written_motion_move_the_original_model_alike(robot, tee_path):
    """Compare with MuJoCo's forward kinematics of the model.

    Each hand's body differs from the robot's segment by a constant pose, and the model's world by another one.
    """
    spec = mujoco.MjSpec.from_string(tee_path.read_text())
    for geom in [geom for geom in spec.geoms if geom.type == mujoco.mjtGeom.mjGEOM_MESH]:
        spec.delete(geom)
    for mesh in list(spec.meshes):
        spec.delete(mesh)
    model = spec.compile()
    data, joints, skeleton = mujoco.MjData(model), robot.source_joints, robot.skeleton
    angles = np.random.default_rng(0).uniform(skeleton.lower, skeleton.upper, (40, len(skeleton.names)))
    frames, places = skeleton.frames(angles), {"l": [], "r": []}
    for row in joints.joint_angles(angles):
        for name, angle in zip(joints.names, row, strict=True):
            data.qpos[model.jnt_qposadr[model.joint(name).id]] = angle
        mujoco.mj_kinematics(model, data)
        for side, hands in places.items():
            hands.append(data.body(f"{side}_hand").xpos.copy())
    for side, hands in places.items():
        k = skeleton.segment(f"{side}_wrist")
        columns = [
            np.concatenate([np.kron(np.eye(3), hand), np.eye(3), -rotation], axis=1)
            for hand, rotation in zip(hands, frames.rotations[:, k], strict=True)
        ]
        matrix, target = np.concatenate(columns), frames.origins[:, k].ravel()
        fit = np.linalg.lstsq(matrix, target, rcond=None)[0]
        assert np.abs(matrix @ fit - target).max() < 2 * ROUNDING_TOLERANCE


def test_hinge_limit_converts_back_to_the_joint_limit_of_the_robot_file(tee_mapped, robot):
    hinges = {hinge.name: hinge for hinge in tee_mapped.hinges}
    abduct = hinges["l_shoulder_abduct"]
    lowest = abduct.sign * robot.skeleton.lower[robot.skeleton.joint("l_shoulder_abduct")] + abduct.zero
    assert lowest == pytest.approx(-1.7, abs=1e-4)


def test_imported_robot_without_ambiguity_needs_no_review(tee_mapped):
    assert tee_mapped.confidence > 0.9
    assert not tee_mapped.doubtful


def test_imported_hinges_hold_their_worst_posture_with_at_most_41_percent_of_stall_torque(robot):
    assert MujocoDynamics(robot).worst_static.values.max() <= 0.41


@pytest.mark.soak
def test_robot_import_is_deterministic(tee_path, tee_mapped):
    again = import_humanoid(tee_path)
    assert robot_text(again.file, heading=[], remarks=again.remarks) == robot_text(
        tee_mapped.file, heading=[], remarks=tee_mapped.remarks
    )


def test_robot_with_an_unusual_arm_is_imported_as_doubtful(written, puppets):
    odd = puppets.puppet().replace('axis="0 0 1" range="-2.4 0.1"', 'axis="0 1 0" range="-2.4 0.1"')
    odd = odd.replace('axis="0 0 1" range="-0.1 2.4"', 'axis="0 1 0" range="-0.1 2.4"')
    imported = import_humanoid(written("odd.xml", odd.replace('pos="0.01 0.28 0"', 'pos="0.2 0.1 0"')))
    assert imported.doubtful


def test_urdf_import_names_the_arm_chain_and_omits_the_gripper(hanging_mapped, hanging_path):
    assert len(hanging_mapped.hinges) == 1 + 2 * 5
    assert load_robot_tree(hanging_path).name == "hanging"
    assert hanging_mapped.file.chains["l_arm"] == ["l_shoulder", "l_elbow", "l_wrist"]
    assert "torso" not in hanging_mapped.file.chains


def test_unlikely_arms_uncertain_sides_and_asymmetry_lower_the_import_confidence():
    def rate(likeness=3.0, off=0.0, certain=True, asymmetry=0.0):
        arms = {"l": SimpleNamespace(off=0.0), "r": SimpleNamespace(off=off)}
        sides = SimpleNamespace(certain=certain)
        return _rate_confidence(
            SimpleNamespace(likeness=likeness, arms=arms, sides=sides, asymmetry=asymmetry, is_doubtful=False), ()
        )

    assert rate() == rate(likeness=9.0) == 1.0
    assert rate(likeness=2.0) == pytest.approx(0.5)
    assert rate(likeness=0.5) == 0.0
    assert rate(certain=False) == pytest.approx(0.7)
    assert rate(off=0.5) == rate(asymmetry=0.5) == pytest.approx(np.exp(-1.0))
