"""The robot in physics: follows commands as its servos would, and keeps what happened."""

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
from kinesic.sim.model import of_hinges
from kinesic.sim.power import Supply
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.stepping.addresses import TwinParts, function_address, timestep_address
from kinesic.sim.stepping.driven_motion import HingePlaces
from kinesic.sim.stepping.friction_step import FrictionParts, find_friction_parts
from kinesic.sim.stepping.recorder import Recorder
from kinesic.sim.stepping.simulation import Simulation, build_simulation
from kinesic.sim.stepping.step_log import StepLog, StepRecord

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
        start: Floats | None = None,
        rounds: bool = True,
        touches: bool = True,
        simulation: Simulation | None = None,
    ) -> None:
        """Builds the physics; its servos hold the posture it starts from.

        Args:
            robot: what is simulated.
            factors: how far its servos and masses are from the description.
            step: [s] longest step of the physics; each command's interval is cut into equal steps.
            start: (n,) [rad] first posture; the robot's rest posture if not given.
            rounds: goals to ticks, as the servos' registers do.
            touches: itself where segments meet; a tenth faster without, and the same as long as they stay apart.
            simulation: model and data in which it moves, as `build_simulation` makes them; its own if not given.

        Raises:
            ValueError: step is not positive.
        """
        if not step > 0:
            raise ValueError(f"step is {step} s, must be above 0 (0.004 is accurate)")
        self._robot = factors.applied(robot)
        self._distances = _distances(robot)  # the same for all factors
        self._step, self._latency = step, factors.latency
        body = simulation or build_simulation(robot, factors, touches=touches)
        self._model, self._data = body.model, body.data
        self._order, self._play, self._actuators = body.joints, body.play, body.actuators
        self._supply = Supply.of(self._robot.drives, factors)
        self._ticks = robot.drives.tick if rounds else None
        posture = robot.skeleton.rest if start is None else start
        self._data.qpos[self._order] = posture
        self._control, self._options = self._data.ctrl, self._model.opt  # looked up once: each costs as much as a sum
        goals = self._rounded(posture)
        self._control[self._actuators] = goals
        self._goals = goals  # (n,) [rad] in force
        self._time = -inf  # [s] of the performance, before the first command
        self._waiting: deque[tuple[float, Floats]] = deque()  # goals under way, with the time they arrive
        self._log = StepLog(self._data.qpos, self._data.qvel, goals)

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
            self._log.aim(goals)
            self._control[self._actuators] = self._goals = goals
        self._advance(command.time)
        sent = self._rounded(command.goals)
        self._log.mark(command.time, sent)
        self._waiting.append((command.time + self._latency, sent))

    def replay(self, times: Floats, goals: Floats, seen: Container[int]) -> Floats:
        """Steps with goals that act at once, in less time than commands take, and measures nothing.

        Args:
            times: (k,) [s], increasing, the first that of where it starts.
            goals: (k - 1, n) [rad] from each time to the next.
            seen: which of the times are looked at.

        Returns:
            (m, n) [rad] where its hinges are at the times that are looked at.
        """
        self._time = float(times[0])
        found = [self._of_hinges(self._log.posture)] if 0 in seen else []
        for k, (time, asked) in enumerate(zip(times[1:].tolist(), self._rounded(goals), strict=True), 1):
            self._control[self._actuators] = self._goals = asked
            self._advance(time)
            if k in seen:
                found.append(self._of_hinges(self._log.posture))
        return np.array(found)

    def close(self) -> None:
        """Ends the performance; the measurements stay."""

    def positions(self) -> Floats:
        """(n,) [rad] at the last command, as the servos' registers have them."""
        return self._rounded(self._of_hinges(self._log.posture))

    def state(self) -> State:
        """What the robot is doing now."""
        return State(
            angles=sealed(self._of_hinges(self._log.posture)),
            speeds=sealed(self._of_hinges(self._data.qvel)),
            accelerations=sealed(self._of_hinges(self._data.qacc)),
        )

    def forget(self) -> None:
        """Drops all measurements so far, for performances without end; the robot moves on."""
        self._log.forget()

    @property
    def physics(self) -> tuple[mujoco.MjModel, mujoco.MjData]:
        """Its model and data, for whoever steps them otherwise."""
        return self._model, self._data

    def parts(self) -> TwinParts | None:
        """Hands its physics to a compiled loop, before the first command; None where only Python can step it."""
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
            speeds=data.qvel,
            control=data.ctrl,
            hinges=np.arange(len(data.qpos))[self._order],
            play=self._play,
            actuators=hinges[self._actuators],
            ticks=np.empty(0) if self._ticks is None else self._ticks,
            longest=self._step,
            latency=self._latency,
        )

    def friction_parts(self) -> FrictionParts | None:
        """Hands the stages of its steps to a compiled loop, before the first command; None: steps stay whole."""
        return find_friction_parts(self._model, self._data, self._step)

    def take(self, record: StepRecord) -> None:
        """Takes what a compiled loop has done with its parts as if it had been written command by command."""
        self._log.take(record)
        self._time = float(record.times[-1])
        self._waiting += zip((record.times + self._latency).tolist(), record.sent, strict=True)
        for _ in record.aimed:
            self._goals = self._waiting.popleft()[1]

    def measurements(self) -> Measurements:
        """Samples all that was measured so far at the times of the commands.

        Duties and torques are those of the servos' law for the goals in force just before each command. The clearance
        of a command is that of the closest posture since the command before, wherever one is nearer than the robot's
        least clearance or than at any command so far; elsewhere it is that at the command.

        Raises:
            ValueError: no command was written yet.
        """
        recorder = self.recorder(len(self._log.times))
        recorder.add(self._log)
        return recorder.measurements()

    def recorder(self, commands: int) -> Recorder:
        """Makes a recorder with room for so many commands: see `record`."""
        motors = np.arange(len(self._data.qpos))[self._order]
        places = HingePlaces(motors, self._play)
        return Recorder(
            self._robot, self._distances, places, commands=commands, latency=self._latency, ticks=self._ticks
        )

    def record(self, recorder: Recorder) -> None:
        """Has a recorder measure what was done since the last time, and forgets it here.

        Raises:
            ValueError: no command was written since, or more than the recorder has room for.
        """
        recorder.add(self._log)
        self.forget()

    def _advance(self, time: float) -> None:
        """Physics up to a time, in equal steps no longer than the asked one."""
        span = time - self._time
        if span <= SAME_TIME:
            return
        model, data, step = self._model, self._data, mujoco.mj_step
        keep_angles, keep_speeds = self._log.keep_angles, self._log.keep_speeds
        count = ceil(span / self._step - SAME_TIME)
        self._options.timestep = span / count
        for _ in range(count):
            if self._supply or len(self._play):
                self._control[self._actuators] = self._asked(self._supply)
            step(model, data)
            keep_angles()
            keep_speeds()
        self._log.stepped(count, span / count)
        self._time = time

    def _asked(self, supply: Supply | None) -> Floats:
        """(n,) [rad] goals of motors, whose position is not the hinge's where gears have play; servos measure it."""
        data, goals = self._data, self._goals
        if supply:
            goals, share = supply.goals(goals, self._of_hinges(data.qpos), self._of_hinges(data.qvel))
            self._log.keep_supplied(share)
        return goals - data.qpos[self._play] if len(self._play) else goals

    def _of_hinges(self, values: Floats) -> Floats:
        return of_hinges(values, self._order, self._play)

    def _rounded(self, goals: Floats) -> Floats:
        """(n,) [rad] as the servos' registers hold them."""
        return goals.copy() if self._ticks is None else np.rint(goals / self._ticks) * self._ticks


@lru_cache(maxsize=4)
def _distances(robot: Robot) -> CapsuleDistances:
    return CapsuleDistances(robot)
