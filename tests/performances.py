"""Facts, performances and motions that tests of several rooms share."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Measurements, TickRows
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.controller.perform import perform, set_up
from kinesic.controller.performance import Performance
from kinesic.motion.condition import condition
from kinesic.motion.keys import KeyPosture
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.setup import Setup
from kinesic.sim.dynamics import MujocoDynamics

ROBOT = Robot.load()
DYNAMICS = MujocoDynamics(ROBOT)
LIMITS = Limits.of(ROBOT, DYNAMICS.load)  # once for all modules: worst postures take a while to be found
BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="block">{}</bml>'
HURRIED = BLOCK.format(
    '<speech id="s"><text><sync id="one"/>Hello there, <sync id="two"/>welcome</text></speech>'
    '<gesture id="rushed" lexeme="offer" mode="RIGHT_HAND" start="0" stroke="0.25" end="0.6"/>'
    '<gesture id="odd" lexeme="xyzzy" stroke="1"/>'
    '<head id="nod" lexeme="NOD" stroke="s:two"/>'
)
CALM = BLOCK.format('<gesture id="offering" lexeme="offer" mode="RIGHT_HAND" stroke="2"/>')


@pytest.fixture(scope="session")
def known() -> Setup:
    """The default robot and style."""
    return set_up()


@pytest.fixture(scope="session")
def hurried(known: Setup) -> Performance:
    """A stroke that comes too soon, a nod in time, a gesture that nobody knows."""
    return perform(HURRIED, known, source="hurried.bml")


@pytest.fixture(scope="session")
def calm(known: Setup) -> Performance:
    """One gesture with all the time it wants."""
    return perform(CALM, known, source="calm.bml")


def generous(count: int) -> Limits:
    """Limits that nothing meets."""
    return Limits(*(sealed(np.full(count, value)) for value in (-10, 10, 1e2, 1e4, 1e6, 1e-6, 1e-4, 1.0)))


@pytest.fixture(scope="session")
def through() -> Callable[[Floats, Floats], Trajectory]:
    """A motion through (m, n) postures at (m,) times."""

    def made(times: Floats, angles: Floats) -> Trajectory:
        whole = (True,) * angles.shape[1]
        keys = tuple(KeyPosture(float(time), sealed(row), whole) for time, row in zip(times, angles, strict=True))
        return condition(keys, generous(angles.shape[1])).trajectory

    return made


def bearing(measured: Measurements, duties: Floats) -> Measurements:
    """Measurements with other duties, of hinges that stand still: their torque is that share of the stall torque."""
    drives = measured.drives
    goals = TickRows(sealed(measured.angles + duties / drives.gain), sealed(np.ones(len(drives))))
    return replace(measured, speeds=sealed(np.zeros_like(duties)), in_force=goals)
