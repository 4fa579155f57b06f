"""Stopping times of the arms when a block yields to a person."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.realizer.occupancy import ARM_ROLES, arm_hinges
from kinesic.realizer.realizer import Scene, advance, begin, interrupt, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.session.setup import set_up

BLOCK_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="{}"/></bml>'
YIELDING_GESTURES = ("BEAT", "large", "offer", "refuse", "wave", "think", "come_here", "me", "you", "stop")
INTERRUPTION_TIMES = np.arange(0.3, 2.0, 0.4)  # [s] times of interruptions after the start of the gesture
STILL_VELOCITY = np.radians(2.0)  # [rad/s] velocity below which an arm is still
STILL_DURATION = 0.2  # [s] shortest standstill that counts as a stop
WATCHED_DURATION = 3.0  # [s] evaluated time after an interruption


def measure_arm_stops() -> list[float]:
    """Measure the stopping time [s] of the arms for each interruption.

    It begins with the first changed command.
    """
    setup = set_up()
    hinges = [hinge for role in ARM_ROLES for hinge in arm_hinges(role, setup.robot)]
    stops = []
    for lexeme in YIELDING_GESTURES:
        prepared = prepare_block(read_request(Message(BLOCK_TEMPLATE.format(lexeme)), setup), setup)
        for time in INTERRUPTION_TIMES.tolist():
            scene = advance(begin(Scene.of(setup), prepared, 0.0), time)
            times = time + np.arange(0.0, WATCHED_DURATION, KNOT_INTERVAL)
            moving = interrupt(scene, time, yields=True).motion.sample(times)[1][:, hinges]
            stops.append(_first_rest(np.abs(moving).max(axis=1)))
    return stops


def _first_rest(velocities: Floats) -> float:
    """Return the start [s] of the first standstill in velocities (m,)."""
    needed = round(STILL_DURATION / KNOT_INTERVAL)
    moving = np.flatnonzero(velocities >= STILL_VELOCITY)
    gaps = np.diff(np.concatenate([[-1], moving, [len(velocities) + needed]]))
    return float(np.concatenate([[-1], moving])[np.argmax(gaps > needed)] + 1) * KNOT_INTERVAL
