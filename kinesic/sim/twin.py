"""The robot in physics: follows commands as its servos would, and keeps what happened."""

from collections import deque
from itertools import pairwise
from math import ceil, inf

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command, State
from kinesic.body.dynamics import Clearance
from kinesic.body.measurements import Measurements
from kinesic.body.robot import SIDES, Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.factors import NOMINAL, Factors
from kinesic.sim.kinematics import motion_frames
from kinesic.sim.model import actuator_order, build, joint_order

STEP = 0.004  # [s] longest physics step: angles stay within 0.05 deg of those with steps of 1 ms
SAME_TIME = 1e-9  # [s] below which two times are one


class Twin:
    """A sink that steps physics up to each command's time with the goals written before.

    The goals are rounded to the servos' ticks. Time zero is the first command's.
    """

    def __init__(
        self,
        robot: Robot,
        *,
        factors: Factors = NOMINAL,
        step: float = STEP,
        latency: float = 0.0,
        start: Floats | None = None,
    ) -> None:
        """Stands still, its servos holding the posture it starts from.

        Args:
            robot: what is simulated.
            factors: how far its servos and masses are from the description.
            step: [s] longest step of the physics; each command's interval is cut into equal steps.
            latency: [s] from a command's time until its goals reach the servos.
            start: (n,) [rad] first posture; the robot's rest posture if not given.

        Raises:
            ValueError: step is not positive, or latency is negative.
        """
        if not step > 0:
            raise ValueError(f"step is {step} s, must be above 0 (0.004 is accurate)")
        if latency < 0:
            raise ValueError(f"latency is {latency} s, must be at least 0")
        self._robot = factors.applied(robot)
        self._step, self._latency = step, latency
        self._model = build(robot, servos=factors)
        self._data = mujoco.MjData(self._model)
        self._order = joint_order(robot, self._model)
        self._actuators = actuator_order(robot, self._model)
        self._ticks = np.array([drive.tick for drive in robot.drives])
        posture = robot.skeleton.rest if start is None else start
        self._data.qpos[self._order] = posture
        self._goals = self._rounded(posture)
        self._data.ctrl[self._actuators] = self._goals
        self._time = -inf  # [s] of the performance, before the first command
        self._waiting: deque[tuple[float, Floats]] = deque()  # goals under way, with the time they arrive
        self._steps: list[Floats] = [self._data.qpos.copy()]  # every posture of the physics
        self._samples: list[tuple[float, int, Floats, Floats]] = []  # time, steps so far, speeds, goals in force

    def write(self, command: Command, /) -> None:
        """Steps up to the command's time, then takes its goals.

        Raises:
            ValueError: time runs backwards.
        """
        if self._time == -inf:
            self._time = command.time
        if command.time < self._time - SAME_TIME:
            raise ValueError(f"command at {command.time} s after one at {self._time} s: time must not decrease")
        while self._waiting and self._waiting[0][0] <= command.time - SAME_TIME:
            arrival, goals = self._waiting.popleft()
            self._advance(arrival)
            self._goals = goals
            self._data.ctrl[self._actuators] = goals
        self._advance(command.time)
        self._samples.append((command.time, len(self._steps), self._data.qvel.copy(), self._goals))
        self._waiting.append((command.time + self._latency, self._rounded(command.goals)))

    def close(self) -> None:
        """Ends the performance; the measurements stay."""

    def state(self) -> State:
        """What the robot is doing now."""
        return State(
            angles=sealed(self._steps[-1][self._order]),
            speeds=sealed(self._data.qvel[self._order]),
            accelerations=sealed(self._data.qacc[self._order]),
        )

    def forget(self) -> None:
        """Drops what was measured so far, for performances without end; the robot moves on."""
        del self._steps[:-1]
        self._samples.clear()

    def measurements(self) -> Measurements:
        """What was seen so far, sampled at the times of the commands.

        Duties and torques are those of the servos' law for the goals in force just before each command.

        Raises:
            ValueError: no command was written yet.
        """
        if not self._samples:
            raise ValueError("no command was written, so nothing was measured: write commands first")
        counts = [count for _, count, _, _ in self._samples]
        postures = np.array(self._steps)[:, self._order]
        angles = postures[np.array(counts) - 1]
        speeds = np.array([speed for _, _, speed, _ in self._samples])[:, self._order]
        goals = np.array([goal for _, _, _, goal in self._samples])
        duties, torques = self._drive(goals - angles, speeds)
        return Measurements(
            times=sealed([time for time, _, _, _ in self._samples]),
            angles=sealed(angles),
            speeds=sealed(speeds),
            torques=sealed(torques),
            duties=sealed(duties),
            hands=self._hands(angles),
            clearance=self._clearance(postures, counts),
        )

    def _advance(self, time: float) -> None:
        """Physics up to a time, in equal steps no longer than the asked one."""
        span = time - self._time
        if span <= SAME_TIME:
            return
        model, data = self._model, self._data
        count = ceil(span / self._step - SAME_TIME)
        model.opt.timestep = span / count
        half = span / count / 2
        qpos, qvel = data.qpos, data.qvel
        for _ in range(count):
            mujoco.mj_step(model, data)
            # MuJoCo's semi-implicit steps run half a step ahead of the held goals; its speeds lie on time
            self._steps.append(qpos - half * qvel)
        self._time = time

    def _rounded(self, goals: Floats) -> Floats:
        """(n,) [rad] as the servos' registers hold them."""
        rounded: Floats = np.rint(goals / self._ticks) * self._ticks
        return rounded

    def _drive(self, errors: Floats, speeds: Floats) -> tuple[Floats, Floats]:
        """Demanded duties and torques [Nm] of the servos, (m, n) each."""
        drives = self._robot.drives
        gain = np.array([drive.gain for drive in drives])
        rate = np.array([drive.rate_gain / drive.stall for drive in drives])
        stall = np.array([drive.stall for drive in drives])
        no_load = np.array([drive.no_load for drive in drives])
        duties = gain * errors - rate * speeds
        return duties, stall * (np.clip(duties, -1.0, 1.0) - speeds / no_load)

    def _hands(self, angles: Floats) -> dict[str, Floats]:
        """Side -> (m, 3) [m] the wrist's centre in the world."""
        skeleton = self._robot.skeleton
        frames = motion_frames(skeleton, angles)
        return {
            side: sealed(frames.origins[skeleton.segment(self._robot.chains[f"{side}_arm"][-1])].T) for side in SIDES
        }

    def _clearance(self, postures: Floats, counts: list[int]) -> Clearance:
        """The closest approach on all steps since the command before, for each command."""
        every = CapsuleDistances(self._robot).clearance(postures)
        edges = [0, *counts]
        closest = [
            begin + int(np.argmin(every.distances[begin:end]))
            for begin, end in ((min(a, b - 1), b) for a, b in pairwise(edges))
        ]
        return Clearance(sealed(every.distances[closest]), [every.pairs[k] for k in closest])
