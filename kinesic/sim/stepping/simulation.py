"""A robot in MuJoCo: its model and data, and where its hinges are in them.

Making them takes longer than most of what a dry run measures; those of performances that are over serve the next ones.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np

from kinesic.body.arrays import Indices
from kinesic.body.robot import Robot
from kinesic.sim.model import actuator_order, build_model, figures_of_links, fit_drives, joint_order, play_order
from kinesic.sim.servo_factors import Factors


@dataclass(frozen=True, eq=False)
class Simulation:
    """Model and data, and the places of the robot's hinges."""

    model: mujoco.MjModel
    data: mujoco.MjData
    joints: Indices | slice  # (n,) in qpos and qvel
    play: Indices  # (n,) likewise, of the play of gears; (0,) where they have none
    actuators: Indices | slice  # (n,) in ctrl


def build_simulation(robot: Robot, factors: Factors, *, touches: bool) -> Simulation:
    """Builds the physics of a robot with some factors; where it need not touch itself, its steps take less time."""
    model = build_model(robot, servos=factors)
    if not touches:
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        if not factors.play:
            model.opt.solver = mujoco.mjtSolver.mjSOL_PGS  # what friction leaves to solve, it solves soonest
    joints, actuators = _place(joint_order(robot, model)), _place(actuator_order(robot, model))
    return Simulation(model, mujoco.MjData(model), joints, play_order(robot, model), actuators)


@contextmanager
def borrow_simulations(robot: Robot, twins: Sequence[Factors], *, touches: bool) -> Iterator[list[Simulation]]:
    """Lends a simulation to each of some twins for a `with` block, as if it was just built, but for its timestep.

    Nobody may use them once the block is left; those of a block that an exception ends are not lent again.
    """
    lent = [_take(robot, factors, touches=touches) for factors in twins]
    yield lent
    for factors, simulation in zip(twins, lent, strict=True):
        _shelf(robot, figures_of_links(factors), touches=touches).append(simulation)


def _take(robot: Robot, factors: Factors, *, touches: bool) -> Simulation:
    try:
        simulation = _shelf(robot, figures_of_links(factors), touches=touches).pop()
    except IndexError:
        return build_simulation(robot, factors, touches=touches)
    fit_drives(simulation.model, robot, factors)
    mujoco.mj_resetData(simulation.model, simulation.data)
    return simulation


@lru_cache(maxsize=4)  # two masses of two robots; whoever varies more builds more
def _shelf(robot: Robot, links: Factors, *, touches: bool) -> list[Simulation]:
    """Keeps the simulations that nobody uses now, and that differ in nothing but their drives."""
    return []


def _place(order: Indices) -> Indices | slice:
    """A slice where the robot's own order is MuJoCo's: a view costs less than a copy."""
    return slice(None) if np.array_equal(order, np.arange(len(order))) else order
