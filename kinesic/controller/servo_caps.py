"""Caps of servo velocity and power for a planned motion near people.

A servo that is blocked, or gets a late goal, moves with all of its power. Caps leave it what the motion needs. The
velocity is that of the setpoints, which contain the feed-forward. The duty is
POWER_MARGIN * max(planned duty, holding duty + pace / no-load velocity) + POWER_RESERVE, so that every posture can be
held and left.
"""

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.command import COMMAND_RATE
from kinesic.controller.feedforward import FeedForwardSetpoints
from kinesic.hardware.supervisor.caps import ServoCaps
from kinesic.planning.setup import Setup

VELOCITY_MARGIN = 1.1  # largest velocity of a servo's set point / largest velocity of the setpoints
POWER_MARGIN = 1.2  # power cap / largest computed duty; covers friction and supply voltage that differ from the model
POWER_RESERVE = 0.05  # additional duty, for corrections of tracking errors


def compute_caps(setpoints: FeedForwardSetpoints, setup: Setup, *, pace: float) -> ServoCaps:
    """Compute the caps for a motion.

    Args:
        setpoints: of the motion at the command rate.
        setup: robot.
        pace: [rad/s] largest joint velocity of the supervisor's own moves.
    """
    drives = setup.robot.drives
    velocities = np.abs(np.diff(setpoints.setpoints, axis=0)).max(axis=0, initial=0.0) * COMMAND_RATE
    holding = (setup.dynamics.load.holding + drives.frictionloss) / drives.stall
    needed = np.maximum(np.abs(setpoints.duties).max(axis=0, initial=0.0), holding + pace / drives.no_load)
    return ServoCaps(
        velocities=sealed(VELOCITY_MARGIN * np.maximum(velocities, pace)),
        duties=sealed(np.minimum(1.0, POWER_MARGIN * needed + POWER_RESERVE)),
        holding=sealed(np.minimum(1.0, POWER_MARGIN * holding + POWER_RESERVE)),
    )
