"""What an observer could measure of one gesture in the twin; kinetic energy by the inverse dynamics of planning."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import SIDES, Side
from kinesic.controller.performance import Performance
from kinesic.motion.double_s import least_rest_times
from kinesic.planning.syncs import SyncTime
from kinesic.sim.kinematics import motion_frames
from kinesic.studies.sweep.geometry import hull_volume, length, mean_curvature, peak_speed, rms_jerk, visits

WITHIN_REACH = 0.8  # of the arm's length: farther out the elbow has no room to move
BEND = 0.03  # of the arm's length: the arc over which a bend is judged
LEAST_WAY = 0.02  # [m] below which a hand only sways with the body
NEAR, FAR = 0.25, 0.5  # of a stroke's widest distance from its key: arrived, and left again


def kinetic_energy(dynamics: Dynamics, angles: Floats, speeds: Floats) -> Floats:
    """Computes the kinetic energy of links and rotors: half of speed times mass matrix times speed.

    The product of mass matrix and speed is the torque that would accelerate the resting robot by as much as its speed
    is, beyond the torque that holds it.

    Args:
        dynamics: of the robot.
        angles: (m, n) [rad].
        speeds: (m, n) [rad/s].

    Returns:
        (m,) [J].
    """
    still = np.zeros_like(angles)
    momenta = dynamics.torques(angles, still, speeds) - dynamics.torques(angles, still, still)
    energies: Floats = 0.5 * np.vecdot(speeds, momenta)
    return energies


@dataclass(frozen=True)
class Measures:
    """One gesture as the twin performed it, from its start to its end; of two hands the one that does more."""

    peak_speed: float  # [m/s] of a hand
    stroke_speed: float  # [m/s] of a hand, between strokeStart and strokeEnd
    allowed_speed: float  # [m/s] that the limits leave to the stroke's way, from rest to rest
    path_length: float  # [m] of both hands
    swept_volume: float  # [m^3] convex hull of both hands' paths, the resting one's place included
    curvature: float | None  # [1/m] mean of a hand's path, both averaged; None: they hardly move
    torso_travel: float  # [rad] sum over its hinges
    shoulder_travel: float  # [rad] sum over the hinges of the collar bones
    jerk: float  # [m/s^3] root mean square of a hand, below 10 Hz
    overshoot: float  # [rad] of the hinge that goes farthest beyond its keys
    stroke_error: float | None  # [s] arrival at the stroke minus the asked time; None: never arrived
    preparation: float  # [s] from start to ready
    elbow_offset: float | None  # [arm lengths] outwards of the shoulder, hand within 80 % of reach; None: it never is
    strokes: int  # how many times the hand comes to the stroke's key
    energy: float  # [J] mean kinetic energy


@dataclass(frozen=True)
class MeasureFormat:
    """How a measure is written."""

    words: str
    unit: str
    scale: float  # from SI to the unit


SHOWN: Mapping[str, MeasureFormat] = {
    "peak_speed": MeasureFormat("peak hand speed", "m/s", 1.0),
    "stroke_speed": MeasureFormat("peak hand speed of the stroke", "m/s", 1.0),
    "allowed_speed": MeasureFormat("speed that limits leave to the stroke", "m/s", 1.0),
    "path_length": MeasureFormat("path of the hands", "m", 1.0),
    "swept_volume": MeasureFormat("swept volume", "l", 1e3),
    "curvature": MeasureFormat("mean curvature of the path", "1/m", 1.0),
    "torso_travel": MeasureFormat("torso travel", "deg", float(np.degrees(1.0))),
    "shoulder_travel": MeasureFormat("shoulder travel", "deg", float(np.degrees(1.0))),
    "jerk": MeasureFormat("RMS jerk of the hand", "m/s\u00b3", 1.0),
    "overshoot": MeasureFormat("overshoot beyond keys", "deg", float(np.degrees(1.0))),
    "stroke_error": MeasureFormat("stroke error", "ms", 1e3),
    "preparation": MeasureFormat("preparation", "s", 1.0),
    "elbow_offset": MeasureFormat("elbow offset", "arm lengths", 1.0),
    "strokes": MeasureFormat("strokes", "", 1.0),
    "energy": MeasureFormat("mean kinetic energy", "J", 1.0),
}


@dataclass(frozen=True, eq=False)
class _Window:
    """A gesture in a performance: its sync points and the samples between them."""

    performance: Performance
    syncs: Mapping[str, SyncTime]

    def time(self, sync: str) -> float:
        """Finds when the twin comes to a sync point, or is planned to [s] performance time."""
        found = self.syncs[sync]
        return self.performance.plan.trajectory.zero + found.planned + (self.performance.lags.get(found) or 0.0)

    def samples(self, begin: str, end: str) -> slice:
        """Picks the samples from one sync point to another."""
        times = self.performance.measured.times
        first, last = times.searchsorted([self.time(begin), self.time(end)])
        return slice(int(first), int(last) + 1)


def measures(performance: Performance, behaviour: str) -> Measures:
    """Measures one gesture of a performance.

    Args:
        performance: in any twin.
        behaviour: the gesture's id.

    Raises:
        ValueError: the behaviour moves no hand.
    """
    syncs = {sync.sync: sync for sync in performance.plan.syncs if sync.behaviour == behaviour}
    uses = performance.plan.keyframes.uses.get(behaviour, frozenset())
    sides = [side for side in SIDES if f"{side}_hand" in uses]
    if not sides:
        raise ValueError(f"{behaviour} moves no hand; nothing to measure")
    window = _Window(performance, syncs)
    measured, robot, period = performance.measured, performance.plan.setup.robot, performance.period
    whole, stroke = window.samples("start", "end"), window.samples("strokeStart", "strokeEnd")
    hands = [measured.hands[side] for side in sides]
    angles, speeds = measured.angles[whole], measured.speeds[whole]
    collars = [joint for side in SIDES for joint in robot.skeleton.joints_of(robot.arm(side).segments[:-3])]
    lag = performance.lags.get(syncs["stroke"])
    return Measures(
        peak_speed=max(peak_speed(hand[whole], period=period) for hand in hands),
        stroke_speed=max(peak_speed(hand[stroke], period=period) for hand in hands),
        allowed_speed=max(_allowed(window, side) for side in sides),
        path_length=sum(length(hand[whole]) for hand in hands),
        swept_volume=hull_volume(np.concatenate([hand[whole] for hand in measured.hands.values()])),
        curvature=_curvature([hand[whole] for hand in hands], BEND * robot.arm_length),
        torso_travel=_travel(angles, list(robot.joints("torso"))),
        shoulder_travel=_travel(angles, collars),
        jerk=max(rms_jerk(hand[whole], period=period) for hand in hands),
        overshoot=_overshoot(performance),
        stroke_error=None if lag is None else syncs["stroke"].planned - syncs["stroke"].asked + lag,
        preparation=window.time("ready") - window.time("start"),
        elbow_offset=_elbow_offset(window, sides),
        strokes=max(_strokes(window, hand) for hand in hands),
        energy=float(kinetic_energy(performance.plan.setup.dynamics, angles, speeds).mean()),
    )


def _travel(angles: Floats, joints: list[int]) -> float:
    """Sum of what some hinges turn [rad]."""
    return float(np.abs(np.diff(angles[:, joints], axis=0)).sum())


def _curvature(paths: list[Floats], step: float) -> float | None:
    """Mean curvature [1/m] of those paths that are long enough to bend."""
    found = [curvature for path in paths if (curvature := mean_curvature(path, step=step)) is not None]
    return float(np.mean(found)) if found else None


def _allowed(window: _Window, side: Side) -> float:
    """Twice the mean speed of a hand on its way from strokeStart to stroke when the hinges take their least time.

    A motion from rest to rest that uses its limits well peaks at no more than twice its mean speed; a hinge that turns
    back rests in between.
    """
    known = window.performance.plan.setup
    begin, end = (window.syncs[sync].asked for sync in ("strokeStart", "stroke"))
    keys = [posture.angles for posture in window.performance.plan.postures.postures if begin <= posture.time <= end]
    if len(keys) < 2:
        return 0.0
    arm = list(known.robot.arm(side).joints)
    turns = turns_one_way(np.diff(np.stack(keys), axis=0))[:, arm]
    seconds = float(least_rest_times(turns, known.limits.part(np.array(arm))).sum(axis=0).max())
    wrist = known.robot.arm(side).wrist
    return (
        2.0 * length(motion_frames(known.robot.skeleton, np.stack(keys)).origins[wrist].T) / seconds if seconds else 0.0
    )


def turns_one_way(steps: Floats) -> Floats:
    """Sums the steps (k, n) [rad] of each hinge from one reversal to the next.

    Returns:
        (k, n) [rad], none negative; rows that a hinge does not need are 0.
    """
    back = np.cumsum(np.vstack([np.zeros_like(steps[:1]), steps[1:] * steps[:-1] < 0.0]), axis=0).astype(np.intp)
    found = np.zeros_like(steps)
    np.add.at(found, (back, np.arange(steps.shape[1])), np.abs(steps))
    return found


def _overshoot(performance: Performance) -> float:
    """How far the hinge that exceeds most goes beyond the range of its own keys [rad]."""
    postures = performance.plan.postures.postures
    keys = np.stack([posture.angles for posture in postures])
    keyed = np.array([posture.keyed for posture in postures])
    low = np.where(keyed, keys, np.inf).min(axis=0)
    high = np.where(keyed, keys, -np.inf).max(axis=0)
    angles = performance.measured.angles
    beyond = np.maximum(angles.max(axis=0) - high, low - angles.min(axis=0))
    return float(beyond.max(initial=0.0))


def _elbow_offset(window: _Window, sides: list[Side]) -> float | None:
    """Mean way of an elbow outwards of its shoulder, as the chest sees it [arm lengths].

    Only samples of stroke and hold count in which the hand is within a share of the reach.
    """
    performance = window.performance
    robot = performance.plan.setup.robot
    frames = motion_frames(robot.skeleton, performance.measured.angles[window.samples("strokeStart", "relax")])
    offsets = []
    for side in sides:
        arm = robot.arm(side)
        shoulder, elbow, wrist = (frames.origins[k] for k in (arm.shoulder, arm.elbow, arm.wrist))
        chest = frames.rotations[robot.skeleton.segment(robot.arms[side].base)]
        outward = chest[:, 1] * (1.0 if side == "l" else -1.0)
        near = np.linalg.norm(wrist - shoulder, axis=0) <= WITHIN_REACH * robot.arm_length
        if near.any():
            offsets.append(float(((elbow - shoulder) * outward).sum(axis=0)[near].mean()) / robot.arm_length)
    return float(np.mean(offsets)) if offsets else None


def _strokes(window: _Window, hand: Floats) -> int:
    """How many times a hand comes to the stroke's key, from strokeStart to strokeEnd; 0 for one that hardly moves."""
    stroke = hand[window.samples("strokeStart", "strokeEnd")]
    place = hand[min(int(window.performance.measured.times.searchsorted(window.time("stroke"))), len(hand) - 1)]
    wide = float(np.linalg.norm(stroke - place, axis=1).max(initial=0.0))
    return visits(stroke, place, near=NEAR * wide, far=FAR * wide) if wide > LEAST_WAY else 0
