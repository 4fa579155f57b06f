"""Retargeting by mink, differential inverse kinematics with position and velocity limits.

It follows the approach of general motion retargeting (GMR): weighted tasks for wrists and elbows, one step per frame.
mink is imported when a clip is retargeted.
"""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.capture.robot_motion import SAMPLE_RATE, RobotMotion
from kinesic.sim.model import build_model, find_joint_indices

WRIST_COST = 10.0  # cost of a wrist's position error, relative to an elbow's
ELBOW_COST = 1.0  # cost of an elbow's position error
POSTURE_COST = 0.01  # cost of a joint angle's distance from rest, for joints that no task moves
QP_DAMPING = 1e-3  # damping of the quadratic programs
SETTLING_STEPS = 50  # number of steps from rest to the first frame


def retarget_by_mink(desired: RobotMotion, robot: Robot) -> Floats:
    """Return joint angles (m, n) [rad] of a clip retargeted by mink.

    Raises:
        ModuleNotFoundError: mink is not installed.
    """
    import mink  # noqa: PLC0415 - optional

    model = build_model(robot)
    columns = find_joint_indices(robot, model)
    speeds = dict(zip(robot.skeleton.names, robot.drives.speed.tolist(), strict=True))
    limits = [mink.ConfigurationLimit(model), mink.VelocityLimit(model, speeds)]
    posture = mink.PostureTask(model, cost=POSTURE_COST)
    configuration = mink.Configuration(model)
    start = configuration.q
    start[columns] = robot.skeleton.rest
    configuration.update(start)
    posture.set_target_from_configuration(configuration)
    places = _target_places(desired, robot)
    tasks = {
        name: mink.FrameTask(name, "body", position_cost=cost, orientation_cost=0.0)
        for name, (cost, _) in places.items()
    }
    angles = np.empty_like(desired.angles)
    for k in [*([0] * SETTLING_STEPS), *range(len(angles))]:
        for name, task in tasks.items():
            task.set_target(mink.SE3.from_translation(places[name][1][k]))
        step = mink.solve_ik(
            configuration, [*tasks.values(), posture], 1.0 / SAMPLE_RATE, "daqp", damping=QP_DAMPING, limits=limits
        )
        configuration.integrate_inplace(step, 1.0 / SAMPLE_RATE)
        angles[k] = configuration.q[columns]
    return sealed(angles)


def _target_places(desired: RobotMotion, robot: Robot) -> dict[str, tuple[float, Floats]]:
    """Return costs and target positions (m, 3) [m] of elbows and wrists.

    Elbows are at the robot's own distance from the shoulder, in the direction of the clip.
    """
    frames, skeleton = robot.skeleton.rest_frames, robot.skeleton
    places = {}
    for side in SIDES:
        arm, path = robot.arm(side), desired.arms[side]
        base = skeleton.segments[skeleton.segment(arm.segments[0])].parent
        rotation = frames.rotations[skeleton.segment(base)] if base else np.eye(3)
        shoulder = frames.origins[arm.shoulder]
        upper = float(np.linalg.norm(frames.origins[arm.elbow] - shoulder))
        directions = path.elbow / np.maximum(np.linalg.norm(path.elbow, axis=1, keepdims=True), 1e-9)
        places[skeleton.segments[arm.elbow].name] = (ELBOW_COST, shoulder + upper * directions @ rotation.T)
        places[skeleton.segments[arm.wrist].name] = (WRIST_COST, shoulder + robot.arm_length * path.wrist @ rotation.T)
    return places
