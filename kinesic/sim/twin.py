"""Simulated robot that follows commands and records measurements."""

from collections import deque
from collections.abc import Container
from functools import lru_cache
from math import ceil, inf

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command, Measurements, State
from kinesic.body.robot import Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.model import sum_hinge_values
from kinesic.sim.power import SaggingSupply
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.stepping.addresses import TwinParts, function_address, timestep_address
from kinesic.sim.stepping.driven_motion import HingePlaces
from kinesic.sim.stepping.friction_step import FrictionParts, find_friction_parts
from kinesic.sim.stepping.recorder import Recorder
from kinesic.sim.stepping.simulation import Simulation, build_simulation
from kinesic.sim.stepping.step_log import StepLog, StepRecord

MAX_PHYSICS_STEP = 0.004  # [s] longest physics step: angles stay within 0.05 deg of those with steps of 1 ms
TIME_TOLERANCE = 1e-9  # [s] difference up to which two times count as equal


class Twin:
    """Simulated robot: steps MuJoCo to the time of each command.

    The previous setpoints act in these steps. Setpoints are rounded to the servos' ticks. Time zero is that of the
    first command.
    """

    def __init__(
        self,
        robot: Robot,
        *,
        factors: Factors = NOMINAL_FACTORS,
        step: float = MAX_PHYSICS_STEP,
        start: Floats | None = None,
        rounds: bool = True,
        touches: bool = True,
        simulation: Simulation | None = None,
    ) -> None:
        """Build the physics with servos that hold the start posture.

        Args:
            robot: Description.
            factors: Deviations of servos and masses from the description.
            step: [s] longest physics step; each command's interval is divided into equal steps.
            start: (n,) [rad] first posture; the robot's rest posture if not given.
            rounds: Whether setpoints are rounded to ticks, as in the servos' registers.
            touches: Whether segments of the robot collide; without, steps are a tenth faster, and the result is the
                same unless segments meet.
            simulation: Model and data to use, from `build_simulation`; built here if not given.

        Raises:
            ValueError: step is not positive.
        """
        if not step > 0:
            raise ValueError(f"step is {step} s, must be above 0 (0.004 is accurate)")
        self._robot = factors.applied(robot)
        self._make_distances = _make_distances(robot)  # independent of the factors
        self._step, self._latency = step, factors.latency
        body = simulation or build_simulation(robot, factors, touches=touches)
        self._model, self._data = body.model, body.data
        self._order, self._play, self._actuators = body.joints, body.play, body.actuators
        self._supply = SaggingSupply.of(self._robot.drives, factors)
        self._ticks = robot.drives.tick if rounds else None
        posture = robot.skeleton.rest if start is None else start
        self._data.qpos[self._order] = posture
        self._control, self._options = (
            self._data.ctrl,
            self._model.opt,
        )  # cached, as each attribute lookup costs as much as an addition of arrays
        goals = self._round_to_ticks(posture)
        self._control[self._actuators] = goals
        self._goals = goals  # (n,) [rad] setpoints in force
        self._time = -inf  # [s] performance time; -inf before the first command
        self._waiting: deque[tuple[float, Floats]] = deque()  # setpoints in transit, with their time of arrival
        self._log = StepLog(self._data.qpos, self._data.qvel, goals)

    def write(self, command: Command, /) -> None:
        """Advance the physics to the command's time, then accept the command's setpoints.

        Raises:
            ValueError: the time is before that of the previous command.
        """
        if self._time == -inf:
            self._time = command.time
        if command.time < self._time - TIME_TOLERANCE:
            raise ValueError(f"command at {command.time} s after one at {self._time} s: time must not decrease")
        while self._waiting and self._waiting[0][0] <= command.time - TIME_TOLERANCE:
            arrival, goals = self._waiting.popleft()
            self._advance(arrival)
            self._log.aim(goals)
            self._control[self._actuators] = self._goals = goals
        self._advance(command.time)
        sent = self._round_to_ticks(command.setpoints)
        self._log.mark(command.time, sent)
        self._waiting.append((command.time + self._latency, sent))

    def replay(self, times: Floats, goals: Floats, seen: Container[int]) -> Floats:
        """Follow setpoints that act immediately, and return selected angles.

        Faster than commands, as nothing is measured.

        Args:
            times: (k,) [s], increasing; the first is the start time.
            goals: (k - 1, n) [rad] setpoints from each time to the next.
            seen: Indices of the times at which angles are returned.

        Returns:
            (m, n) [rad] angles of the hinges at these times.
        """
        self._time = float(times[0])
        angles = [self._select_hinges(self._log.posture)] if 0 in seen else []
        for k, (time, setpoints) in enumerate(zip(times[1:].tolist(), self._round_to_ticks(goals), strict=True), 1):
            self._control[self._actuators] = self._goals = setpoints
            self._advance(time)
            if k in seen:
                angles.append(self._select_hinges(self._log.posture))
        return np.array(angles)

    def close(self) -> None:
        """End the performance but keep the measurements."""

    def positions(self) -> Floats:
        """Return the angles (n,) [rad] at the last command, rounded to ticks.

        They are rounded like the values of the servos' registers.
        """
        return self._round_to_ticks(self._select_hinges(self._log.posture))

    def state(self) -> State:
        """Return the current angles, velocities and accelerations of the hinges."""
        return State(
            angles=sealed(self._select_hinges(self._log.posture)),
            velocities=sealed(self._select_hinges(self._data.qvel)),
            accelerations=sealed(self._select_hinges(self._data.qacc)),
        )

    def forget(self) -> None:
        """Delete all measurements, for performances of unlimited length.

        The motion continues.
        """
        self._log.forget()

    @property
    def physics(self) -> tuple[mujoco.MjModel, mujoco.MjData]:
        """MuJoCo model and data, for callers that step them directly."""
        return self._model, self._data

    def parts(self) -> TwinParts | None:
        """Return addresses and arrays for a compiled physics loop, or None.

        Must be called before the first command.

        Returns:
            None if only Python can step this twin.
        """
        step, timestep = function_address("mj_step"), timestep_address(self._model)
        if step is None or timestep is None or self._supply:
            return None
        data, hinges = self._data, np.arange(len(self._goals))
        return TwinParts(
            step=step,
            model=int(self._model._address),
            data=int(data._address),
            clock=function_address("mjcb_time") or 0,
            timestep=timestep,
            positions=data.qpos,
            velocities=data.qvel,
            control=data.ctrl,
            hinges=np.arange(len(data.qpos))[self._order],
            play=self._play,
            actuators=hinges[self._actuators],
            ticks=np.empty(0) if self._ticks is None else self._ticks,
            longest=self._step,
            latency=self._latency,
        )

    def friction_parts(self) -> FrictionParts | None:
        """Return physics step stages for a compiled loop, or None.

        Must be called before the first command.

        Returns:
            None if steps must use `mj_step`.
        """
        return find_friction_parts(self._model, self._data, self._step)

    def take(self, record: StepRecord) -> None:
        """Record steps and commands that a compiled loop has performed."""
        self._log.take(record)
        self._time = float(record.times[-1])
        self._waiting += zip((record.times + self._latency).tolist(), record.sent, strict=True)
        for _ in record.aimed:
            self._goals = self._waiting.popleft()[1]

    def measurements(self) -> Measurements:
        """Return all measurements at the times of the commands.

        Duties and torques follow from the servos' control law for the setpoints in force just before each command.
        The clearance of a command is that of the closest posture since the previous command if one is closer than the
        robot's minimum clearance or than at all earlier commands; otherwise it is the clearance at the command.

        Raises:
            ValueError: no command was written yet.
        """
        recorder = self.recorder(len(self._log.times))
        recorder.add(self._log)
        return recorder.measurements()

    def recorder(self, commands: int) -> Recorder:
        """Create a recorder for a number of commands, for use with `record`."""
        motors = np.arange(len(self._data.qpos))[self._order]
        places = HingePlaces(motors, self._play)
        return Recorder(
            self._robot, self._make_distances, places, commands=commands, latency=self._latency, ticks=self._ticks
        )

    def record(self, recorder: Recorder) -> None:
        """Measure all steps since the last call, then delete them.

        Args:
            recorder: Recorder with capacity for their commands.

        Raises:
            ValueError: no command was written since, or more than the recorder has capacity for.
        """
        recorder.add(self._log)
        self.forget()

    def _advance(self, time: float) -> None:
        """Advance the physics to a time in equal steps.

        No step is longer than the longest allowed step.
        """
        span = time - self._time
        if span <= TIME_TOLERANCE:
            return
        model, data, step = self._model, self._data, mujoco.mj_step
        log_angles, log_velocities = self._log.log_angles, self._log.log_velocities
        count = ceil(span / self._step - TIME_TOLERANCE)
        self._options.timestep = span / count
        for _ in range(count):
            if self._supply or len(self._play):
                self._control[self._actuators] = self._find_motor_setpoints(self._supply)
            step(model, data)
            log_angles()
            log_velocities()
        self._log.stepped(count, span / count)
        self._time = time

    def _find_motor_setpoints(self, supply: SaggingSupply | None) -> Floats:
        """Return motor setpoints (n,) [rad] corrected for supply sag and backlash.

        With backlash the position of a motor differs from that of its hinge, which the servo measures.
        """
        data, goals = self._data, self._goals
        if supply:
            goals, fraction = supply.equivalent_setpoints(
                goals, self._select_hinges(data.qpos), self._select_hinges(data.qvel)
            )
            self._log.log_voltage(fraction)
        return goals - data.qpos[self._play] if len(self._play) else goals

    def _select_hinges(self, values: Floats) -> Floats:
        return sum_hinge_values(values, self._order, self._play)

    def _round_to_ticks(self, goals: Floats) -> Floats:
        """Return setpoints (n,) [rad] rounded to the servos' ticks, if enabled."""
        return goals.copy() if self._ticks is None else np.rint(goals / self._ticks) * self._ticks


@lru_cache(maxsize=4)
def _make_distances(robot: Robot) -> CapsuleDistances:
    return CapsuleDistances(robot)
