"""Inverse kinematics of arms and torso: positions, poses and tracking."""

from kinesic.body.reach import Reach
from kinesic.ik.pose import PoseSolution
from kinesic.ik.pose import hold_reach as hold
from kinesic.ik.pose import solve_pose as pose
from kinesic.ik.solve import Solution, solve
from kinesic.ik.track import Tracker, track
from kinesic.ik.two_hands import Both
from kinesic.ik.two_hands import reach_both as two_hands

__all__ = [
    "Both",
    "PoseSolution",
    "Reach",
    "Solution",
    "Tracker",
    "hold",
    "pose",
    "solve",
    "track",
    "two_hands",
]
