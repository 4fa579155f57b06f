"""What a robot's motion has told of its servos: by how much more, or less, they have to be led than data sheets say.

A performance that begins with what an earlier one has told is right from its first motion on.
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Measurements
from kinesic.body.robot import Robot
from kinesic.body.servo import follow_lags
from kinesic.controller.observer_step import SHARES
from kinesic.sim.fit import fit_factors
from kinesic.sim.fit_parameters import Figure
from kinesic.sim.log import Log
from kinesic.sim.servo_factors import Factors

TOLD: tuple[Figure, ...] = ("latency", "gain")  # by a few seconds of motion; the correction learns what else is wrong


@dataclass(frozen=True, eq=False)
class LearnedGains:
    """Shares by which goals have to lead more than the model of the servos says, in joint order; 0: as it says."""

    load: Floats  # (n,) of what carries torque
    lead: Floats  # (n,) of what carries speed
    delay: float = 0.0  # [s] until goals reach the servos

    @classmethod
    def of_twin(cls, robot: Robot, twin: Factors) -> "LearnedGains":
        """Makes what a twin that was fitted to a robot's servos says of them.

        Args:
            robot: as its data sheets describe it.
            twin: how far its servos are from them.
        """
        sheet, own = robot.drives, twin.applied(robot).drives
        load = sheet.gain * sheet.stall / (own.gain * own.stall) - 1.0
        lead = follow_lags(own) / follow_lags(sheet) - 1.0
        return cls(sealed(np.clip(load, *SHARES)), sealed(np.clip(lead, *SHARES)), twin.latency)


def identify(measured: Measurements, robot: Robot) -> LearnedGains:
    """Finds gains and delay of a robot's servos from a motion that they have made, whatever corrected its goals.

    Args:
        measured: of a performance that began at rest.
        robot: as its data sheets describe it.
    """
    log = Log(times=measured.times, goals=measured.goals, angles=measured.angles)
    return LearnedGains.of_twin(robot, fit_factors(log, robot, free=TOLD).factors)
