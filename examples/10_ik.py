"""Inverse kinematics alone: a place for a hand, a whole pose, both hands with the torso, a path to follow."""

import numpy as np

from kinesic import Robot, ik

robot = Robot.load("upper22")
arm = robot.arms["l"]

reach = ik.Reach(np.array([0.25, 0.20, -0.10]), palm=np.array([0.0, -1.0, 0.0]))  # [m] in the frame of the arm's base
solution = ik.solve(arm, reach, start=arm.rest)
print(f"solve: {1000 * solution.residual:.3f} mm from the place, palm {solution.palm_error:.3f} rad off")

rotations, centres = arm.frames(solution.angles)
held = ik.pose(arm, centres[-2], rotations[-1], start=arm.rest)
print(f"pose: {1000 * held.residual:.3f} mm and {held.turn:.4f} rad off")

front = robot.gesture_origin  # [m] in the world: midline, elbows' height
places = {"l": front + np.array([0.30, 0.12, 0.05]), "r": front + np.array([0.30, -0.12, 0.05])}
both = ik.two_hands(robot, places, start=robot.skeleton.rest)
print(f"two_hands: {1000 * max(both.residuals.values()):.3f} mm at most, torso moved {both.torso_travel:.2f} rad")

turns = np.linspace(0.0, 2 * np.pi, 200)
circle = arm.hand(solution.angles) + 0.05 * np.stack([0 * turns, np.cos(turns) - 1, np.sin(turns)], axis=1)
for place, angles in zip(circle, ik.track(arm, circle, period=0.01, start=solution.angles), strict=True):
    behind = np.linalg.norm(arm.hand(angles) - place)  # each is answered before the next is asked for
print(f"track: {1000 * behind:.3f} mm from the end of the circle")
