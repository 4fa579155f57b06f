"""Solve inverse kinematics: hand position, full pose, both hands, and a path."""

import numpy as np

from kinesic import Robot, ik

robot = Robot.load("upper22")
arm = robot.arms["l"]

reach = ik.Reach(np.array([0.25, 0.20, -0.10]), palm=np.array([0.0, -1.0, 0.0]))  # [m] in the frame of the arm's base
solution = ik.solve(arm, reach, start=arm.rest)
print(f"solve: {1000 * solution.residual:.3f} mm from the target, palm {solution.palm_error:.3f} rad off")

rotations, centres = arm.frames(solution.angles)
posed = ik.pose(arm, centres[-2], rotations[-1], start=arm.rest)
print(f"pose: {1000 * posed.residual:.3f} mm and {posed.turn:.4f} rad off")

front = robot.gesture_origin  # [m] in the world: on the midline, at elbow height
targets = {"l": front + np.array([0.30, 0.12, 0.05]), "r": front + np.array([0.30, -0.12, 0.05])}
both = ik.two_hands(robot, targets, start=robot.skeleton.rest)
print(f"two_hands: {1000 * max(both.residuals.values()):.3f} mm at most, torso moved {both.torso_travel:.2f} rad")

phases = np.linspace(0.0, 2 * np.pi, 200)
circle = arm.hand(solution.angles) + 0.05 * np.stack([0 * phases, np.cos(phases) - 1, np.sin(phases)], axis=1)
for target, angles in zip(circle, ik.track(arm, circle, period=0.01, start=solution.angles), strict=True):
    error = np.linalg.norm(arm.hand(angles) - target)  # Each solution is computed when it is needed.
print(f"track: {1000 * error:.3f} mm from the end of the circle")
