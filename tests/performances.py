"""Setups, performances and motions for tests of several packages."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Measurements, SetpointRows
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.controller.dry_run import dry_run
from kinesic.metrics.dry_run import DryRun
from kinesic.motion.condition import condition
from kinesic.motion.keys import KeyPosture
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.dynamics import MujocoDynamics

ROBOT = Robot.load()
DYNAMICS = MujocoDynamics(ROBOT)
LIMITS = Limits.of(ROBOT, DYNAMICS.load)  # computed once, because finding worst-case postures is slow
BLOCK_BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="block">{}</bml>'
HURRIED_BML = BLOCK_BML.format(
    '<speech id="s"><text><sync id="one"/>Hello there, <sync id="two"/>welcome</text></speech>'
    '<gesture id="rushed" lexeme="offer" mode="RIGHT_HAND" start="0" stroke="0.25" end="0.6"/>'
    '<gesture id="odd" lexeme="xyzzy" stroke="1"/>'
    '<head id="nod" lexeme="NOD" stroke="s:two"/>'
)
CALM_BML = BLOCK_BML.format('<gesture id="offering" lexeme="offer" mode="RIGHT_HAND" stroke="2"/>')


@pytest.fixture(scope="session")
def known() -> Setup:
    """Setup with the default robot and style."""
    return set_up()


@pytest.fixture(scope="session")
def hurried(known: Setup) -> DryRun:
    """Performance with an early stroke, a timely nod and an unknown gesture."""
    return dry_run(plan(HURRIED_BML, known, source="hurried.bml"))


@pytest.fixture(scope="session")
def calm(known: Setup) -> DryRun:
    """Performance of one gesture with enough time."""
    return dry_run(plan(CALM_BML, known, source="calm.bml"))


def generous(count: int) -> Limits:
    """Return limits that are never reached."""
    return Limits(*(sealed(np.full(count, value)) for value in (-10, 10, 1e2, 1e4, 1e6, 1e-6, 1e-4, 1.0)))


@pytest.fixture(scope="session")
def through() -> Callable[[Floats, Floats], Trajectory]:
    """Return a function that makes a motion through (m, n) postures at (m,) times."""

    def made(times: Floats, angles: Floats) -> Trajectory:
        whole = (True,) * angles.shape[1]
        keys = tuple(KeyPosture(float(time), sealed(row), whole) for time, row in zip(times, angles, strict=True))
        return condition(keys, generous(angles.shape[1])).trajectory

    return made


def bearing(measured: Measurements, duties: Floats) -> Measurements:
    """Return servo measurements in which resting hinges need the given duties.

    Their torque is the same fraction of the stall torque.
    """
    drives = measured.drives
    goals = SetpointRows(sealed(measured.angles + duties / drives.gain), sealed(np.ones(len(drives))))
    return replace(measured, velocities=sealed(np.zeros_like(duties)), in_force=goals)
