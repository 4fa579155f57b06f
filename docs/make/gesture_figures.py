"""Write kinesic/studio/page/figures.json: every gesture as a moving stick figure, for the lists of the studio."""

import json
from base64 import b64encode
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.planning.plan import Plan
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import BEHAVIOUR_ID, plan_gesture

OUT = Path(__file__).parents[2] / "kinesic/studio/page/figures.json"
ROBOT = "human"  # robot with fingers, so that hand shapes are visible
FRAME_COUNT = 12  # number of frames per gesture
UNITS_PER_ARM = 92.0  # picture units per arm length; coordinates are single bytes
FIGURE_ORIGIN = (128.0, 122.0)  # [picture units] gesture origin: rightward, downward
VIEW_YAW = np.radians(20.0)  # [rad] camera yaw towards the robot's left
VIEW_PITCH = np.radians(12.0)  # [rad] camera elevation above the robot
HEAD_HEIGHT = 0.1  # [m] height of the head's centre above the base of the skull


def points(robot: Robot, angles: Floats) -> Floats:
    """Return the points (k, 3) [m] of a stick figure.

    They are head, neck and trunk, then each arm from shoulder to fingertips.
    """
    frames = robot.skeleton.frames(angles)
    head = robot.skeleton.segment(robot.sites["eyes"].segment)
    neck = robot.skeleton.segment(robot.chains["neck"][0])
    found = [
        frames.origins[head] + frames.rotations[head] @ np.array((0.0, 0.0, HEAD_HEIGHT)),
        frames.origins[neck],
        frames.origins[robot.skeleton.segment(robot.chains["torso"][0])],
    ]
    for side in SIDES:
        arm = robot.arm(side)
        found += [frames.origins[k] for k in (arm.shoulder, arm.elbow, arm.wrist)]
        for tip in robot.finger_tips(side).values():
            found.append(frames.origins[tip.segment] + frames.rotations[tip.segment] @ tip.place)
    return np.array(found)


def project(robot: Robot, places: Floats) -> Floats:
    """Project points (k, 3) [m] to picture units (k, 2), rightward and downward."""
    x, y, z = ((places - robot.gesture_origin) / robot.arm_length).T
    across = y * np.cos(VIEW_YAW) - x * np.sin(VIEW_YAW)
    depth = x * np.cos(VIEW_YAW) + y * np.sin(VIEW_YAW)
    up = z * np.cos(VIEW_PITCH) - depth * np.sin(VIEW_PITCH)
    units = np.stack([FIGURE_ORIGIN[0] + UNITS_PER_ARM * across, FIGURE_ORIGIN[1] - UNITS_PER_ARM * up], axis=-1)
    return np.clip(np.round(units), 0, 255)


def figure(plan: Plan) -> dict[str, object]:
    """Return a gesture's frames (base64), duration [s] and stroke frame index."""
    robot, zero = plan.setup.robot, plan.trajectory.zero
    times = {sync.sync: zero + sync.planned for sync in plan.syncs if sync.behaviour == BEHAVIOUR_ID}
    begin, end = min(times.values()), max(times.values())
    moments = np.linspace(begin, end, FRAME_COUNT)
    angles = plan.trajectory.sample(moments)[0]
    units = np.array([project(robot, points(robot, row)) for row in angles]).astype(np.uint8)
    still = int(np.argmin(np.abs(moments - times.get("stroke", (begin + end) / 2))))
    return {"frames": b64encode(units.tobytes()).decode(), "seconds": round(end - begin, 2), "still": still}


def main() -> None:
    """Plan all gestures and write their figures."""
    setup = set_up(ROBOT)
    fingers = len(setup.robot.finger_tips("l"))
    figures = {}
    for form in setup.lexicon.forms:
        plan = plan_gesture(form, setup)
        if any(sync.behaviour == BEHAVIOUR_ID for sync in plan.syncs):
            figures[form.id] = figure(plan)
    OUT.write_text(json.dumps({"fingers": fingers, "frames": FRAME_COUNT, "figures": figures}, indent=0) + "\n")


if __name__ == "__main__":
    main()
