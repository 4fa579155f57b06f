"""Corrects goals from measured positions: a disturbance observer that also learns how heavy the load really is.

Feed-forward sends each hinge u = q + lead, which would be exact for servos as their data sheets say. Real ones deviate
by e = measured - reference, and follow, linearised about the reference (I inertia, s stall torque, w no-load speed,
g gain, r rate gain, f viscous friction),

    I e'' + (s / w + r + f) e' + s g e = s g (c + push - share load - pace lead),

where c is the correction of the goal, load and lead are the parts of it that carry torque and speed, share and pace say
by how much what they do is overestimated, and push is whatever else disturbs, as an angle of the goal. A torque
constant that is wrong shows in the share, a gain in both, a delay of goals in the pace. Per tick:

1. A Luenberger observer of (e, e', push), its three poles at exp(-BANDWIDTH T), compares its forecast for the last
   tick with the position measured there: one cycle old, rounded to ticks.
2. What it finds as push while something was led is ascribed to share and pace by recursive least squares: a wrong
   torque constant then is foreseen at the next acceleration, a wrong gain at the next speed, not noticed after it.
3. c = share load + pace lead - RESTORING (e, e', push); bounded in size and in rate; goals stay within the ranges.

Stability: whatever is learned, share load + pace lead enters as a bounded disturbance; what is left is linear. Closed
over a plant with a bus latency from 0 to 20 ms, known to the observer or not, all poles of all hinges lie within the
unit circle when stall torque, no-load speed or inertia is wrong by a factor of 2, and for the pessimistic twin. Two
such errors at once may oscillate where they leave the servo's own loop hardly damped or double its stiffness at 20 ms:
then only the bounds hold, and servos that wrong are better fitted first. Where it is known of servos, less is restored.

A goal further than 1 / g from the measured position gives no more duty: the observer knows what could act, so that
nothing winds up. Where g is less than believed, duty is full only further away, and full duty would explain away what g
lacks: DOUBT is the room in which it still shows.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
import scipy

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Body, Command
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import Robot
from kinesic.controller.feedforward import FeedForwardGoals
from kinesic.controller.observer_step import compile_tick

BANDWIDTH = 100.0  # [rad/s] of the observer's three poles
CLEAR_LOAD = np.radians(2.0)  # of lead, at which the first sign of a load is half believed
FORGETTING = 5.0  # [s] after which older loads count less
LARGEST_CORRECTION = np.radians(10.0)  # [rad] of correction
DOUBT = 1.2  # times the error of full duty, up to which a servo is believed to give more for more
SLICES = 1024  # of a period, for its exact solution


@dataclass(frozen=True, eq=False)
class LoadEstimate:
    """Belief about the hinges at one tick, in joint order."""

    rows: Floats  # (7 + h, n) all of it, one under another

    @property
    def motion(self) -> Floats:
        """(3, n) deviation [rad], its speed [rad/s], push [rad of goal]; `h` corrections under way follow [rad]."""
        return self.rows[:3]

    @property
    def share(self) -> Floats:
        """(n,) share by which each hinge's load exceeds the modelled one."""
        return np.asarray(self.rows[-4])

    @property
    def pace(self) -> Floats:
        """(n,) share by which each hinge's speed takes more lead than the modelled one."""
        return np.asarray(self.rows[-3])

    @property
    def correction(self) -> Floats:
        """(n,) [rad] of the goal, as sent."""
        return np.asarray(self.rows[-2])

    @property
    def goals(self) -> Floats:
        """(n,) [rad]."""
        return np.asarray(self.rows[-1])


@dataclass(frozen=True, eq=False)
class ObserverInputs:
    """The observer's inputs at all ticks, computed from the commands before anything is measured."""

    angles: Floats  # (m, n) [rad] reference
    goals: Floats  # (m, n) [rad] as the feed-forward has them
    lowest: Floats  # (m, n) [rad] to which they may be corrected
    highest: Floats  # (m, n) [rad]
    loads: Floats  # (m, n) [rad] part of the goals that carries torque
    noticed: Floats  # (m, n) [rad] the same, as late as its effects are noticed
    trust: Floats  # (m, n) [1/rad] share for each push that is found
    leads: Floats  # (m, n) [rad] part of the goals that carries speed
    noticed_leads: Floats  # (m, n) [rad] likewise
    trust_leads: Floats  # (m, n) [1/rad] likewise

    @cached_property
    def rows(self) -> Floats:
        """(m, 10, n) all arrays, one under another."""
        return np.stack([getattr(self, field.name) for field in fields(self)], axis=1)


@dataclass(frozen=True, eq=False)
class Observer:
    """Gains of an observer for the hinges of one or more bodies, at a rate of commands."""

    forecast: Floats  # (3, 3, n) of deviation, speed and push, one tick on
    gain: Floats  # (3, n) of the innovation
    period: float  # [s]
    arrival: Floats  # (h,) share of each goal under way, the newest first, in the tick that ends
    lower: Floats  # (n,) [rad] of goals
    upper: Floats  # (n,) [rad]
    step: Floats  # (n,) [rad] of correction per tick: the speed that plans leave to servos
    full: Floats  # (n,) [rad] error at which the duty is full beyond doubt
    restoring: float = 1.0  # the part of RESTORING that is used: see `controller.stability`

    @classmethod
    def of(cls, robot: Robot, dynamics: Dynamics, *, period: float, delay: float = 0.0, bodies: int = 1) -> "Observer":
        """Designs the observer of a robot's hinges.

        Args:
            robot: its drives and ranges.
            dynamics: the inertia of each hinge in its worst posture.
            period: [s] between goals.
            delay: [s] of the bus.
            bodies: how many such robots are observed, their hinges one after another: numpy takes as long for many.
        """
        drives = robot.drives
        forecast = forecast_servo(robot, dynamics, period)
        gain = _gains(forecast, np.exp(-BANDWIDTH * period))
        step = (drives.no_load - drives.speed) * period
        late = int(delay / period)
        arrival = np.zeros(late + 2)
        arrival[late:] = late + 1 - delay / period, delay / period - late
        return cls(
            forecast=sealed(np.tile(forecast.transpose(1, 2, 0), bodies)),
            gain=sealed(np.tile(gain.T, bodies)),
            period=period,
            arrival=sealed(arrival),
            lower=sealed(np.tile(robot.skeleton.lower, bodies)),
            upper=sealed(np.tile(robot.skeleton.upper, bodies)),
            step=sealed(np.tile(step, bodies)),
            full=sealed(np.tile(DOUBT / drives.gain, bodies)),
        )

    @cached_property
    def _step(self) -> Callable[[Floats, Floats, Floats], Floats]:
        """Function of rows of belief, measured deviation and rows of inputs, with CasADi's own memory."""
        hinges, late = len(self.lower), len(self.arrival)
        gains: Floats = np.concatenate([self.forecast.reshape(9, hinges), self.gain, [self.step, self.full]])
        inputs = np.zeros((7 + late, hinges)), np.zeros(hinges), np.zeros((10, hinges))
        constant, found = (gains, np.array(self.arrival)), np.zeros((7 + late, hinges))
        function = compile_tick(hinges, late, self.restoring)
        memory, run = function.buffer()
        for k, values in enumerate((*inputs, *constant)):
            memory.set_arg(k, values.data)  # type: ignore[call-arg]  # the stub asks for C's arguments
        memory.set_res(0, found.data)  # type: ignore[call-arg]  # the same
        kept = function, memory, constant  # CasADi has only their addresses

        def step(*given: Floats, _kept: object = kept) -> Floats:
            for memory_of, values in zip(inputs, given, strict=True):
                memory_of[:] = values
            run()
            rows = found.copy()
            rows.setflags(write=False)
            return rows

        return step

    def begin(self) -> LoadEstimate:
        """Begins where the reference begins, without deviation."""
        return LoadEstimate(np.zeros((7 + len(self.arrival), len(self.lower))))

    def precompute_inputs(self, stream: Sequence[Command], setpoints: FeedForwardGoals) -> ObserverInputs:
        """Precomputes the observer's inputs for all ticks from the commands; they do not depend on measurements.

        Args:
            stream: commands as the feed-forward has them.
            setpoints: of the same ticks.
        """
        angles, goals = np.array([command.angles for command in stream]), np.array([c.goals for c in stream])
        return self.inputs(angles, goals, setpoints)

    def inputs(self, angles: Floats, goals: Floats, setpoints: FeedForwardGoals) -> ObserverInputs:
        """Precomputes the same from the reference and the goals of all commands, (m, n) [rad] each."""
        bodies = len(self.lower) // setpoints.loads.shape[1]
        angles, goals, loads, leads = (
            np.tile(rows, bodies) for rows in (angles, goals, setpoints.loads, setpoints.leads)
        )
        noticed, noticed_leads = self._notice(loads), self._notice(leads)
        forgotten = self.period / FORGETTING
        known = np.zeros(loads.shape[1])
        learned = _smoothed(noticed**2 + noticed_leads**2, known, forgotten) / forgotten
        return ObserverInputs(
            angles=angles,
            goals=goals,
            lowest=np.maximum(self.lower, goals - LARGEST_CORRECTION),
            highest=np.minimum(self.upper, goals + LARGEST_CORRECTION),
            loads=loads,
            noticed=noticed,
            trust=noticed / (CLEAR_LOAD**2 + learned),
            leads=leads,
            noticed_leads=noticed_leads,
            trust_leads=noticed_leads / (CLEAR_LOAD**2 + learned),
        )

    def _notice(self, led: Floats) -> Floats:
        """(m, n) parts of goals, as late as their effects are noticed."""
        late = len(self.arrival)
        earlier = np.concatenate([np.broadcast_to(led[0], (late + 1, led.shape[1])), led])
        acting = sum(share * earlier[late - 1 - k : -2 - k] for k, share in enumerate(self.arrival))
        return _smoothed(acting, led[0], noticing(self.period))

    def after(self, belief: LoadEstimate, deviation: Floats, inputs: ObserverInputs, tick: int) -> LoadEstimate:
        """Advances the estimate by one tick, and corrects the goals.

        Args:
            belief: at the tick before.
            deviation: (n,) [rad] measured minus reference at the tick before; NaN where a servo did not answer.
            inputs: of all ticks.
            tick: which one this is.

        Returns:
            The belief of this tick, with corrected goals.
        """
        return LoadEstimate(self._step(belief.rows, deviation, inputs.rows[tick]))


def noticing(period: float) -> float:
    """Returns the share of what acts that is noticed after a tick [s]."""
    return 1.0 / (1.0 + 3.0 / (BANDWIDTH * period))


def correct_goals(
    stream: Sequence[Command],
    setpoints: FeedForwardGoals,
    bodies: Sequence[Body],
    observer: Observer,
) -> Iterator[tuple[Command, ...]]:
    """Corrects the goals of commands for each body by what it did with those before.

    All commands of a tick must be written before the next ones are taken, as `play_together` does.

    Args:
        stream: commands as the feed-forward has them.
        setpoints: of the same ticks.
        bodies: each is read once per tick.
        observer: of as many.
    """
    inputs, belief = observer.precompute_inputs(stream, setpoints), observer.begin()
    for tick, command in zip(range(len(setpoints.loads)), stream, strict=True):
        if tick == 0:
            yield (command,) * len(bodies)
        else:
            measured = np.concatenate([body.positions() for body in bodies])
            belief = observer.after(belief, measured - inputs.angles[tick - 1], inputs, tick)
            state = command.time, command.angles, command.speeds, command.accelerations
            rows = belief.goals.reshape(len(bodies), -1)
            yield tuple(Command(*state, goals, command.face) for goals in rows)  # `replace` takes three times as long


def forecast_servo(robot: Robot, dynamics: Dynamics, period: float) -> Floats:
    """Finds the transition (n, 3, 3) of deviation, its speed and a held push of each hinge over a period [s]."""
    drives = robot.drives
    inertia = np.maximum(dynamics.load.inertia, drives.armature)
    stiffness = drives.stall * drives.gain / inertia
    drag = (drives.stall / drives.no_load + drives.rate_gain + drives.damping) / inertia
    return _forecast(stiffness, drag, period)


def _forecast(stiffness: Floats, drag: Floats, period: float) -> Floats:
    """(n, 3, 3) transition of deviation, speed and a held push over a period."""
    rates = np.zeros((len(stiffness), 3, 3))
    rates[:, 0, 1] = 1.0
    rates[:, 1] = np.stack([-stiffness, -drag, stiffness], axis=1)
    small = rates * period / SLICES
    transition: Floats = np.linalg.matrix_power(np.eye(3) + small + small @ small / 2, SLICES)
    return transition


def _gains(transition: Floats, pole: float) -> Floats:
    """(n, 3) gains of the innovation that put all three poles of the observer in one place (Ackermann)."""
    rows = [np.broadcast_to(np.eye(3)[0], transition.shape[:2])]
    for _ in range(2):
        rows.append(np.einsum("ni,nij->nj", rows[-1], transition))
    last = np.linalg.solve(np.stack(rows, axis=1), np.eye(3)[2])
    polynomial = np.linalg.matrix_power(transition - pole * np.eye(3), 3)
    ahead = np.einsum("nij,nj->ni", polynomial, last)
    gains: Floats = np.linalg.solve(transition, ahead[..., None])[..., 0]
    return gains


def _smoothed(values: Floats, start: Floats, share: float) -> Floats:
    """(m, n) following values, by a share of the difference each row."""
    driven = share * values
    driven[0] += (1.0 - share) * start
    followed, _ = scipy.linalg.lapack.dtbtrs(np.outer([1.0, share - 1.0], np.ones(len(values))), driven, uplo="L")
    return np.ascontiguousarray(followed)
