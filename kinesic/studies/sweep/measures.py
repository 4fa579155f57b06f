"""Observable measures of one gesture in the twin, kinetic energy included."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import SIDES, Side
from kinesic.metrics.dry_run import DryRun
from kinesic.motion.double_s import least_rest_times
from kinesic.planning.syncs import SyncTime
from kinesic.sim.kinematics import compute_motion_frames
from kinesic.studies.sweep.geometry import count_visits, hull_volume, length, mean_curvature, peak_speed, rms_jerk

MAX_HAND_DISTANCE = 0.8  # shoulder-hand distance / arm length up to which the elbow's offset is measured
BEND_LENGTH = 0.03  # step along a hand path in the measurement of curvature / arm length
MIN_STROKE_SIZE = 0.02  # [m] smaller hand motion during the stroke is body sway, not a stroke
NEAR_RATIO = 0.25  # distance from the stroke position / stroke size below which the hand has arrived
FAR_RATIO = 0.5  # distance from the stroke position / stroke size above which the hand has left


def kinetic_energy(dynamics: Dynamics, angles: Floats, speeds: Floats) -> Floats:
    """Return the kinetic energy of a robot's links and rotors.

    The energy is v^T M v / 2 with the joint velocities v and the mass matrix M.

    M v is the torque that accelerates the resting robot by v per second, beyond the torque that holds it.

    Args:
        dynamics: dynamics of the robot.
        angles: joint angles (m, n) [rad].
        speeds: joint velocities (m, n) [rad/s].

    Returns:
        Energies (m,) [J].
    """
    zeros = np.zeros_like(angles)
    momenta = dynamics.torques(angles, zeros, speeds) - dynamics.torques(angles, zeros, zeros)
    energies: Floats = 0.5 * np.vecdot(speeds, momenta)
    return energies


@dataclass(frozen=True)
class Measures:
    """Measures of one gesture in the twin.

    Unless stated otherwise, the hand with the larger value counts.
    """

    peak_speed: float  # [m/s] of a hand
    stroke_speed: float  # [m/s] of a hand, between strokeStart and strokeEnd
    allowed_speed: float  # [m/s] by the limits on the stroke's path, from rest to rest
    path_length: float  # [m] of both hands together
    swept_volume: float  # [m^3] convex hull of both hands' paths, with the position of a resting hand
    curvature: float | None  # [1/m] mean over the hands' paths; None: they hardly move
    torso_travel: float  # [rad] sum over the torso's joints
    shoulder_travel: float  # [rad] sum over the clavicles' joints
    jerk: float  # [m/s^3] RMS of a hand, below 10 Hz
    overshoot: float  # [rad] largest excess of a joint over the range of its keys
    stroke_error: float | None  # [s] arrival at the stroke minus the requested time; None: never arrived
    preparation: float  # [s] from start to ready
    elbow_offset: float | None  # [arm lengths] outwards from the shoulder, for hands within 80 % of reach; None: never
    strokes: int  # number of arrivals of the hand at the stroke's key
    energy: float  # [J] mean kinetic energy


@dataclass(frozen=True)
class MeasureFormat:
    """Label, unit and scale of a measure."""

    words: str
    unit: str
    scale: float  # from SI to the unit


MEASURE_FORMATS: Mapping[str, MeasureFormat] = {
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
    """Time window of a gesture in a dry run."""

    performance: DryRun
    syncs: Mapping[str, SyncTime]

    def time(self, sync: str) -> float:
        """Return a sync point's performed time [s], planned if not measured."""
        sums = self.syncs[sync]
        return self.performance.plan.trajectory.zero + sums.planned + (self.performance.lags.get(sums) or 0.0)

    def samples(self, begin: str, end: str) -> slice:
        """Return the sample range between two of a gesture's sync points."""
        times = self.performance.measured.times
        first, last = times.searchsorted([self.time(begin), self.time(end)])
        return slice(int(first), int(last) + 1)


def measures(performance: DryRun, behaviour: str) -> Measures:
    """Measure one gesture in a dry run.

    Args:
        performance: dry run in any twin.
        behaviour: id of the gesture.

    Raises:
        ValueError: the behaviour moves no hand.
    """
    syncs = {sync.sync: sync for sync in performance.plan.syncs if sync.behaviour == behaviour}
    uses = performance.plan.keyframes.uses.get(behaviour, frozenset())
    sides = [side for side in SIDES if f"{side}_hand" in uses]
    if not sides:
        raise ValueError(f"{behaviour} moves no hand; it cannot be measured")
    window = _Window(performance, syncs)
    measured, robot, period = performance.measured, performance.plan.setup.robot, performance.period
    whole, stroke = window.samples("start", "end"), window.samples("strokeStart", "strokeEnd")
    hands = [measured.hands[side] for side in sides]
    angles, speeds = measured.angles[whole], measured.velocities[whole]
    clavicles = [joint for side in SIDES for joint in robot.skeleton.joints_of(robot.arm(side).segments[:-3])]
    lag = performance.lags.get(syncs["stroke"])
    return Measures(
        peak_speed=max(peak_speed(hand[whole], period=period) for hand in hands),
        stroke_speed=max(peak_speed(hand[stroke], period=period) for hand in hands),
        allowed_speed=max(_compute_allowed_speed(window, side) for side in sides),
        path_length=sum(length(hand[whole]) for hand in hands),
        swept_volume=hull_volume(np.concatenate([hand[whole] for hand in measured.hands.values()])),
        curvature=_measure_curvature([hand[whole] for hand in hands], BEND_LENGTH * robot.arm_length),
        torso_travel=_measure_travel(angles, list(robot.joints("torso"))),
        shoulder_travel=_measure_travel(angles, clavicles),
        jerk=max(rms_jerk(hand[whole], period=period) for hand in hands),
        overshoot=_measure_overshoot(performance),
        stroke_error=None if lag is None else syncs["stroke"].planned - syncs["stroke"].requested + lag,
        preparation=window.time("ready") - window.time("start"),
        elbow_offset=_measure_elbow_offset(window, sides),
        strokes=max(_count_strokes(window, hand) for hand in hands),
        energy=float(kinetic_energy(performance.plan.setup.dynamics, angles, speeds).mean()),
    )


def _measure_travel(angles: Floats, joints: list[int]) -> float:
    """Return the summed rotation [rad] of the given joints over time."""
    return float(np.abs(np.diff(angles[:, joints], axis=0)).sum())


def _measure_curvature(paths: list[Floats], step: float) -> float | None:
    """Return the mean curvature [1/m] of all sufficiently long hand paths."""
    sums = [curvature for path in paths if (curvature := mean_curvature(path, step=step)) is not None]
    return float(np.mean(sums)) if sums else None


def _compute_allowed_speed(window: _Window, side: Side) -> float:
    """Estimate the largest hand speed [m/s] that limits allow a stroke.

    A rest-to-rest motion that uses its limits well has a peak of at most twice its mean speed. A joint that reverses
    stops in between.
    """
    setup = window.performance.plan.setup
    begin, end = (window.syncs[sync].requested for sync in ("strokeStart", "stroke"))
    keys = [posture.angles for posture in window.performance.plan.postures.postures if begin <= posture.time <= end]
    if len(keys) < 2:
        return 0.0
    arm = list(setup.robot.arm(side).joints)
    turns = sum_turns(np.diff(np.stack(keys), axis=0))[:, arm]
    seconds = float(least_rest_times(turns, setup.limits.part(np.array(arm))).sum(axis=0).max())
    wrist = setup.robot.arm(side).wrist
    return (
        2.0 * length(compute_motion_frames(setup.robot.skeleton, np.stack(keys)).origins[wrist].T) / seconds
        if seconds
        else 0.0
    )


def sum_turns(steps: Floats) -> Floats:
    """Sum the rotation [rad] of each joint between successive reversals.

    Returns:
        Sums (k, n) [rad], none negative; unused rows are 0.
    """
    reversals = np.cumsum(np.vstack([np.zeros_like(steps[:1]), steps[1:] * steps[:-1] < 0.0]), axis=0).astype(np.intp)
    sums = np.zeros_like(steps)
    np.add.at(sums, (reversals, np.arange(steps.shape[1])), np.abs(steps))
    return sums


def _measure_overshoot(performance: DryRun) -> float:
    """Return the largest excess [rad] of a joint beyond its key angles."""
    postures = performance.plan.postures.postures
    keys = np.stack([posture.angles for posture in postures])
    keyed = np.array([posture.keyed for posture in postures])
    low = np.where(keyed, keys, np.inf).min(axis=0)
    high = np.where(keyed, keys, -np.inf).max(axis=0)
    angles = performance.measured.angles
    excess = np.maximum(angles.max(axis=0) - high, low - angles.min(axis=0))
    return float(excess.max(initial=0.0))


def _measure_elbow_offset(window: _Window, sides: list[Side]) -> float | None:
    """Return the mean outward offset of the elbows [arm lengths].

    Only samples of stroke and hold with the hand within a fraction of the reach count; outwards is relative to the
    chest.
    """
    performance = window.performance
    robot = performance.plan.setup.robot
    frames = compute_motion_frames(robot.skeleton, performance.measured.angles[window.samples("strokeStart", "relax")])
    offsets = []
    for side in sides:
        arm = robot.arm(side)
        shoulder, elbow, wrist = (frames.origins[k] for k in (arm.shoulder, arm.elbow, arm.wrist))
        chest = frames.rotations[robot.skeleton.segment(robot.arms[side].base)]
        outward = chest[:, 1] * (1.0 if side == "l" else -1.0)
        is_near = np.linalg.norm(wrist - shoulder, axis=0) <= MAX_HAND_DISTANCE * robot.arm_length
        if is_near.any():
            offsets.append(float(((elbow - shoulder) * outward).sum(axis=0)[is_near].mean()) / robot.arm_length)
    return float(np.mean(offsets)) if offsets else None


def _count_strokes(window: _Window, hand: Floats) -> int:
    """Count a hand's arrivals at the place of the sync point `stroke`.

    A hand that hardly moves counts 0.
    """
    stroke = hand[window.samples("strokeStart", "strokeEnd")]
    position = hand[min(int(window.performance.measured.times.searchsorted(window.time("stroke"))), len(hand) - 1)]
    stroke_size = float(np.linalg.norm(stroke - position, axis=1).max(initial=0.0))
    return (
        count_visits(stroke, position, near=NEAR_RATIO * stroke_size, far=FAR_RATIO * stroke_size)
        if stroke_size > MIN_STROKE_SIZE
        else 0
    )
