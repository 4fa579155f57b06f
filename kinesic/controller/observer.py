"""Disturbance observer that corrects setpoints from measured positions.

Feed-forward sends each hinge u = q + lead, which is exact for servos that match their data sheets. Real servos deviate
by e = measured - reference, and follow, linearised about the reference (I inertia, s stall torque, w no-load speed,
g gain, r rate gain, f viscous friction),

    I e'' + (s / w + r + f) e' + s g e = s g (c + push - share load - pace lead),

where c is the correction of the setpoint, load and lead are its parts for torque and velocity, share and pace are the
relative errors of their effects, and push is any other disturbance, as an angle of the setpoint. A wrong torque
constant appears in share, a wrong gain in both, a delay of setpoints in pace. Per tick:

1. A Luenberger observer of (e, e', push), its three poles at exp(-OBSERVER_BANDWIDTH T), compares its forecast for the
   last tick with the position measured there: one cycle old, rounded to ticks.
2. Recursive least squares attributes push to share and pace while load or lead is not zero. A wrong torque constant is
   then compensated at the next acceleration, a wrong gain at the next velocity, without waiting for an error.
3. c = share load + pace lead - RESTORING_GAINS (e, e', push), bounded in size and rate; setpoints stay within the joint
   ranges.

Stability: share load + pace lead enters as a bounded disturbance; the remaining loop is linear. With a bus latency of 0
to 20 ms, known to the observer or not, all poles of all hinges lie within the unit circle if stall torque, no-load
speed or inertia is wrong by a factor of 2, and for the pessimistic twin. Two such errors at once may oscillate if they
leave the servo's own loop nearly undamped, or double its stiffness at 20 ms: then only the bounds hold, and such servos
should be fitted first. For servos that are known to be so, the restoring gains are reduced.

A setpoint further than 1 / g from the measured position gives no more duty. The observer takes the saturation into
account, so that it does not wind up. If g is smaller than estimated, duty saturates later, and assuming full duty would
hide the smaller g: SATURATION_MARGIN is the range in which it still shows.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from kinesic._kernel import controller as kernel
from kinesic.body.arrays import Floats, seal_in_place, sealed
from kinesic.body.command import Body, Command
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import Robot
from kinesic.controller.feedforward import FeedForwardSetpoints
from kinesic.controller.observer_step import pack_observer
from kinesic.motion.recursion import sum_decaying

OBSERVER_BANDWIDTH = 100.0  # [rad/s] frequency of the three observer poles
REGULARISATION_OFFSET = np.radians(2.0)  # [rad] setpoint offset at which the first load error estimate is halved
FORGETTING_TIME = 5.0  # [s] time constant of the recursive least squares
MAX_CORRECTION = np.radians(10.0)  # [rad] largest correction of a setpoint
SATURATION_MARGIN = 1.2  # factor on the position error of nominally full duty, above which duty counts as saturated
EXPONENTIAL_STEPS = 1024  # substeps per control period in the computation of the matrix exponential


@dataclass(frozen=True, eq=False)
class LoadEstimate:
    """Observer state at one control tick, in joint order."""

    rows: Floats  # (7 + h, n) state: motion, h corrections in flight, share, pace, correction, setpoints

    @property
    def motion(self) -> Floats:
        """Deviation [rad], its velocity [rad/s], and the disturbance [rad], (3, n)."""
        return self.rows[:3]

    @property
    def share(self) -> Floats:
        """Estimated relative load error, (n,): load / modelled load - 1."""
        return np.asarray(self.rows[-4])

    @property
    def pace(self) -> Floats:
        """Estimated relative velocity offset error, (n,): offset / modelled offset - 1."""
        return np.asarray(self.rows[-3])

    @property
    def correction(self) -> Floats:
        """Correction applied to each setpoint, (n,) [rad]."""
        return np.asarray(self.rows[-2])

    @property
    def setpoints(self) -> Floats:
        """Corrected setpoints, (n,) [rad]."""
        return np.asarray(self.rows[-1])


@dataclass(frozen=True, eq=False)
class ObserverInputs:
    """Observer inputs at all control ticks, computed before any measurement."""

    angles: Floats  # (m, n) [rad] angles of the reference
    setpoints: Floats  # (m, n) [rad] feed-forward setpoints
    lowest: Floats  # (m, n) [rad] smallest corrected setpoint
    highest: Floats  # (m, n) [rad] largest corrected setpoint
    loads: Floats  # (m, n) [rad] setpoint offsets for torque
    noticed: Floats  # (m, n) [rad] torque offsets, delayed and smoothed like their measured effects
    trust: Floats  # (m, n) [1/rad] gain from the disturbance to the load error
    leads: Floats  # (m, n) [rad] setpoint offsets for velocity
    noticed_leads: Floats  # (m, n) [rad] velocity offsets, delayed and smoothed like their measured effects
    trust_leads: Floats  # (m, n) [1/rad] gain from the disturbance to the velocity error

    @cached_property
    def rows(self) -> Floats:
        """Observer inputs of each control tick, (m, 10, n), in field order."""
        return np.stack([getattr(self, field.name) for field in fields(self)], axis=1)


@dataclass(frozen=True, eq=False)
class Observer:
    """Disturbance observer for the hinges of one or more robots."""

    forecast: Floats  # (3, 3, n) transition of deviation, velocity and disturbance over one tick
    gain: Floats  # (3, n) gain of the innovation
    period: float  # [s] duration of a tick
    arrival: Floats  # (h,) fraction of each setpoint in flight that acts in this tick, the newest first
    lower: Floats  # (n,) [rad] smallest setpoint
    upper: Floats  # (n,) [rad] largest setpoint
    step: Floats  # (n,) [rad] largest change of the correction per tick, from the velocity reserve of the servos
    full: Floats  # (n,) [rad] position error at which the duty is certainly full
    restoring: float = 1.0  # fraction of RESTORING_GAINS that the correction uses; see `controller.stability`

    @classmethod
    def of(cls, robot: Robot, dynamics: Dynamics, *, period: float, delay: float = 0.0, bodies: int = 1) -> "Observer":
        """Design the observer of a robot's hinges.

        Args:
            robot: its drives and ranges.
            dynamics: the inertia of each hinge in its worst posture.
            period: [s] between setpoints.
            delay: [s] of the bus.
            bodies: number of such robots; their hinges are concatenated, which vectorises the computation.
        """
        drives = robot.drives
        forecast = forecast_servo(robot, dynamics, period)
        gain = _place_poles(forecast, np.exp(-OBSERVER_BANDWIDTH * period))
        step = (drives.no_load - drives.speed) * period
        ticks = int(delay / period)
        arrival = np.zeros(ticks + 2)
        arrival[ticks:] = ticks + 1 - delay / period, delay / period - ticks
        return cls(
            forecast=sealed(np.tile(forecast.transpose(1, 2, 0), bodies)),
            gain=sealed(np.tile(gain.T, bodies)),
            period=period,
            arrival=sealed(arrival),
            lower=sealed(np.tile(robot.skeleton.lower, bodies)),
            upper=sealed(np.tile(robot.skeleton.upper, bodies)),
            step=sealed(np.tile(step, bodies)),
            full=sealed(np.tile(SATURATION_MARGIN / drives.gain, bodies)),
        )

    @cached_property
    def compiled(self) -> kernel.Observer:
        """Observer constants, packed for the compiled kernel."""
        return pack_observer(self.forecast, self.gain, self.step, self.full, self.arrival, self.restoring)

    def begin(self) -> LoadEstimate:
        """Return the initial state, without deviation from the reference."""
        return LoadEstimate(np.zeros((7 + len(self.arrival), len(self.lower))))

    def precompute_inputs(self, stream: Sequence[Command], setpoints: FeedForwardSetpoints) -> ObserverInputs:
        """Compute the observer's inputs for all ticks of a command stream.

        The inputs do not depend on measurements.

        Args:
            stream: commands with feed-forward.
            setpoints: feed-forward of the same ticks.
        """
        angles, goals = np.array([command.angles for command in stream]), np.array([c.setpoints for c in stream])
        return self.compute_inputs(angles, goals, setpoints)

    def compute_inputs(self, angles: Floats, goals: Floats, setpoints: FeedForwardSetpoints) -> ObserverInputs:
        """Compute observer inputs from reference and setpoints, (m, n) [rad] each."""
        bodies = len(self.lower) // setpoints.loads.shape[1]
        angles, goals, loads, leads = (
            np.tile(rows, bodies) for rows in (angles, goals, setpoints.loads, setpoints.leads)
        )
        noticed, noticed_leads = self._delay(loads), self._delay(leads)
        forgetting_rate = self.period / FORGETTING_TIME
        start = np.zeros(loads.shape[1])
        information = _smooth(noticed**2 + noticed_leads**2, start, forgetting_rate) / forgetting_rate
        return ObserverInputs(
            angles=angles,
            setpoints=goals,
            lowest=np.maximum(self.lower, goals - MAX_CORRECTION),
            highest=np.minimum(self.upper, goals + MAX_CORRECTION),
            loads=loads,
            noticed=noticed,
            trust=noticed / (REGULARISATION_OFFSET**2 + information),
            leads=leads,
            noticed_leads=noticed_leads,
            trust_leads=noticed_leads / (REGULARISATION_OFFSET**2 + information),
        )

    def _delay(self, offsets: Floats) -> Floats:
        """Delay and smooth setpoint offsets (m, n) like their measured effects."""
        count = len(self.arrival)
        padded = np.concatenate([np.broadcast_to(offsets[0], (count + 1, offsets.shape[1])), offsets])
        acting = sum(fraction * padded[count - 1 - k : -2 - k] for k, fraction in enumerate(self.arrival))
        return _smooth(acting, offsets[0], detection_rate(self.period))

    def advance(self, estimate: LoadEstimate, deviation: Floats, inputs: ObserverInputs, tick: int) -> LoadEstimate:
        """Update the estimate with a measurement and correct the setpoints.

        Args:
            estimate: at the previous tick.
            deviation: (n,) [rad] measured minus reference at the previous tick; NaN for a servo that did not answer.
            inputs: of all ticks.
            tick: index of this tick.

        Returns:
            Estimate at this tick, with corrected setpoints.
        """
        rows = estimate.rows.copy()
        kernel.advance(self.compiled, inputs.rows[tick], deviation, rows)
        return LoadEstimate(seal_in_place(rows))


def detection_rate(period: float) -> float:
    """Return the fraction of a disturbance detected after one period [s]."""
    return 1.0 / (1.0 + 3.0 / (OBSERVER_BANDWIDTH * period))


def correct_setpoints(
    stream: Sequence[Command],
    setpoints: FeedForwardSetpoints,
    bodies: Sequence[Body],
    observer: Observer,
) -> Iterator[tuple[Command, ...]]:
    """Yield commands with setpoints corrected by the measured positions.

    All commands of a tick must be written before the next tick is taken, as `play_together` does.

    Args:
        stream: commands with feed-forward.
        setpoints: feed-forward of the same ticks.
        bodies: each is read once per tick.
        observer: of the same number of bodies.
    """
    inputs, estimate = observer.precompute_inputs(stream, setpoints), observer.begin()
    for tick, command in zip(range(len(setpoints.loads)), stream, strict=True):
        if tick == 0:
            yield (command,) * len(bodies)
        else:
            measured = np.concatenate([body.positions() for body in bodies])
            estimate = observer.advance(estimate, measured - inputs.angles[tick - 1], inputs, tick)
            state = command.time, command.angles, command.velocities, command.accelerations
            rows = estimate.setpoints.reshape(len(bodies), -1)
            yield tuple(Command(*state, goals, command.face) for goals in rows)  # faster than `replace`


def forecast_servo(robot: Robot, dynamics: Dynamics, period: float) -> Floats:
    """Compute each servo's transition matrix of deviation, velocity and disturbance.

    Returns:
        (n, 3, 3) over a period [s].
    """
    drives = robot.drives
    inertia = np.maximum(dynamics.load.inertia, drives.armature)
    stiffness = drives.stall * drives.gain / inertia
    drag = (drives.stall / drives.no_load + drives.rate_gain + drives.damping) / inertia
    return _compute_transition(stiffness, drag, period)


def _compute_transition(stiffness: Floats, drag: Floats, period: float) -> Floats:
    """Compute servo transition matrices (n, 3, 3) from stiffness and drag.

    Both are per inertia: [1/s^2] and [1/s].
    """
    rates = np.zeros((len(stiffness), 3, 3))
    rates[:, 0, 1] = 1.0
    rates[:, 1] = np.stack([-stiffness, -drag, stiffness], axis=1)
    small = rates * period / EXPONENTIAL_STEPS
    transition: Floats = np.linalg.matrix_power(np.eye(3) + small + small @ small / 2, EXPONENTIAL_STEPS)
    return transition


def _place_poles(transition: Floats, pole: float) -> Floats:
    """Compute observer gains (n, 3) with three equal poles (Ackermann)."""
    rows = [np.broadcast_to(np.eye(3)[0], transition.shape[:2])]
    for _ in range(2):
        rows.append(np.einsum("ni,nij->nj", rows[-1], transition))
    last = np.linalg.solve(np.stack(rows, axis=1), np.eye(3)[2])
    polynomial = np.linalg.matrix_power(transition - pole * np.eye(3), 3)
    ahead = np.einsum("nij,nj->ni", polynomial, last)
    gains: Floats = np.linalg.solve(transition, ahead[..., None])[..., 0]
    return gains


def _smooth(values: Floats, start: Floats, rate: float) -> Floats:
    """Apply a first-order low-pass filter along the rows, (m, n).

    Args:
        values: (m, n).
        start: (n,) before the first row.
        rate: fraction of the difference that each row takes over.
    """
    driven = rate * values
    driven[0] += (1.0 - rate) * start
    return sum_decaying(driven, 1.0 - rate)
