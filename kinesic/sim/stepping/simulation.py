"""MuJoCo model and data of a robot with its hinge indices.

Building them takes longer than most of a dry run, so simulations of finished performances are reused.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np

from kinesic.body.arrays import Indices
from kinesic.body.robot import Robot
from kinesic.sim.model import (
    build_model,
    find_actuator_indices,
    find_joint_indices,
    find_play_indices,
    select_link_factors,
    write_drives,
)
from kinesic.sim.servo_factors import Factors


@dataclass(frozen=True, eq=False)
class Simulation:
    """MuJoCo model and data, with the indices of the robot's hinges."""

    model: mujoco.MjModel
    data: mujoco.MjData
    joints: Indices | slice  # (n,) indices of hinges in qpos and qvel
    play: Indices  # (n,) indices of backlash joints; (0,) without backlash
    actuators: Indices | slice  # (n,) indices in ctrl


def build_simulation(robot: Robot, factors: Factors, *, touches: bool) -> Simulation:
    """Build the physics of a robot with servo factors.

    Args:
        robot: Description.
        factors: Deviations of servos and masses from the description.
        touches: Whether segments of the robot collide; steps are faster without.
    """
    model = build_model(robot, servos=factors)
    if not touches:
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        if not factors.play:
            model.opt.solver = mujoco.mjtSolver.mjSOL_PGS  # fastest solver when friction is the only constraint
    joints, actuators = (
        _choose_index(find_joint_indices(robot, model)),
        _choose_index(find_actuator_indices(robot, model)),
    )
    return Simulation(model, mujoco.MjData(model), joints, find_play_indices(robot, model), actuators)


@contextmanager
def borrow_simulations(robot: Robot, twins: Sequence[Factors], *, touches: bool) -> Iterator[list[Simulation]]:
    """Provide a simulation for each twin during a `with` block.

    A reused simulation equals a new one except for its timestep. Simulations must not be used after the block. If an
    exception ends the block, its simulations are not reused.
    """
    simulations = [_reuse_or_build(robot, factors, touches=touches) for factors in twins]
    yield simulations
    for factors, simulation in zip(twins, simulations, strict=True):
        _find_simulation_pool(robot, select_link_factors(factors), touches=touches).append(simulation)


def _reuse_or_build(robot: Robot, factors: Factors, *, touches: bool) -> Simulation:
    try:
        simulation = _find_simulation_pool(robot, select_link_factors(factors), touches=touches).pop()
    except IndexError:
        return build_simulation(robot, factors, touches=touches)
    write_drives(simulation.model, robot, factors)
    mujoco.mj_resetData(simulation.model, simulation.data)
    return simulation


@lru_cache(maxsize=4)  # enough for two masses of two robots
def _find_simulation_pool(robot: Robot, links: Factors, *, touches: bool) -> list[Simulation]:
    """Return the pool of a robot's reusable simulations with given link factors."""
    return []


def _choose_index(order: Indices) -> Indices | slice:
    """Return hinge indices, as a slice if the order is MuJoCo's.

    A view by slice costs less than a copy by indices.
    """
    return slice(None) if np.array_equal(order, np.arange(len(order))) else order
