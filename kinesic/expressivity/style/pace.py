"""What the robot can: the least times of its hands, head and trunk, and how extent and power change a time at ease."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import AXES, MERGE, add_turns, scale_turn, turn_angles
from kinesic.motion.double_s import least_rest_times

COMFORT = 1.3  # natural time of a turn over the shortest that the servos can do
HASTE = 1.5  # factor on speed of a temporal extent of 1
FORCE = 2.4  # of a power of 1, as far as the servos let it
GATHERED = 2.0  # exponent of power: half of it does less than half, or the servos' limits would bind already
WEAKNESS = 1.6  # factor on time of a power of -1

_WAYS = np.linspace(0.0, 2.4, 25)  # [arm lengths] at which the shortest time of a hand is worked out
_POSTURES = 32  # of an arm, from which its hand starts
_MIDDLE = 0.5  # of each hinge's range, where these postures lie
_SKILLED = 0.25  # share of the postures that are quicker than what counts: elbows are placed with care
_PROBE = 1e-5  # [rad] for the slope
_DAMPING = 1e-3  # of an arm that can hardly move along some axis


def hurry_time(ease: float, least: float, extent: float, most: float) -> float:
    """Changes a time by an extent from -1 to 1; the fastest divides and the slowest multiplies it by `most` [s].

    It falls with the extent as long as servos can do with less: where the least time forbids the whole factor, the
    fastest takes the least time, and what lies between shares what room there is.

    Args:
        ease: time at extent 0 [s].
        least: that servos need [s].
        extent: -1 slow .. 1 fast.
        most: factor on speed at 1, from 1.
    """
    room = most if extent < 0 or least <= 0 else min(most, max(ease / least, 1.0))
    return float(max(least, ease * room**-extent))


def natural_time(ease: float, least: float, temporal: float, power: float, *, room: float = 1.0) -> float:
    """Changes a time at ease by temporal extent and power [s], never to less than the servos need.

    Args:
        ease: [s] without either.
        least: [s] that servos need.
        temporal: extent, -1 slow .. 1 fast.
        power: of a stroke, -1 weak .. 1 forceful.
        room: times the least time to which power shortens a way at most.
    """
    paced = hurry_time(ease, least, temporal, HASTE)
    if power <= 0.0:
        return hurry_time(paced, least, power, WEAKNESS)
    return hurry_time(paced, min(paced, room * least), power**GATHERED, FORCE)


@dataclass(frozen=True, eq=False)
class _Turning:
    """The hinges of a chain that serve an axis."""

    axes: Indices  # (k,) in `AXES`
    room: Floats  # (k,) [rad] of each
    all_room: Floats  # (k,) [rad] of all of its axis
    limits: Limits  # of the k hinges


@lru_cache(maxsize=32)
def _turning(robot: Robot, limits: Limits, chain: str) -> _Turning:
    skeleton, every = robot.skeleton, robot.joints(chain)
    served = [(k, axis) for axis, name in enumerate(AXES) for k in every if skeleton.names[k].endswith(name)]
    joints, axis = np.array(served, dtype=np.intp).reshape(-1, 2).T
    room = skeleton.upper[joints] - skeleton.lower[joints]
    all_room = [max(float(room[axis == own].sum()), _PROBE) for own in axis]
    return _Turning(axis, sealed(room), sealed(all_room), limits.part(joints))


@lru_cache(maxsize=256)  # a movement is asked for by its durations, its layers and what goes along with it
def _least_turn_time(robot: Robot, limits: Limits, chain: str, turn: Turn) -> float:
    turning = _turning(robot, limits, chain)
    turned = np.array(turn_angles(turn))[turning.axes] * turning.room / turning.all_room
    return float(least_rest_times(turned, turning.limits).max(initial=0.0))


@dataclass(frozen=True, eq=False)
class Pace:
    """How fast a robot moves from rest to rest; how fast its hands do so at ease is an `Effort`'s."""

    robot: Robot
    limits: Limits

    def turn_time(
        self, chain: str, turn: Turn, temporal: float = 0.0, power: float = 0.0, *, usual: float = 0.0
    ) -> float:
        """Finds the natural time of a rotation from upright [s].

        Args:
            chain: `neck` or `torso`.
            turn: where it goes.
            temporal: extent, -1 slow .. 1 fast.
            power: of a stroke, -1 weak .. 1 forceful.
            usual: what people take at least, when they are at ease [s].
        """
        least = self.least_turn_time(chain, turn)
        return natural_time(max(usual, COMFORT * least), least, temporal, power)

    def manageable_turn(self, chain: str, before: Turn, desired: Turn, seconds: float, haste: float) -> Turn:
        """Finds the part of the way between two rotations that a chain manages.

        Args:
            chain: `neck` or `torso`.
            before: where it begins.
            desired: where it would end.
            seconds: for the way [s].
            haste: share of them that it may need at most.
        """
        change = add_turns(desired, scale_turn(before, -1.0))
        share = min(1.0, haste * seconds / max(self.least_turn_time(chain, change), MERGE))
        return add_turns(before, scale_turn(change, share**3))  # least times shrink no slower than the cube root

    def least_hand_time(self, distance: float) -> float:
        """Finds the shortest time of a hand's way [s], of an arm in a good posture; it grows with the way [m]."""
        return float(np.interp(distance / self.robot.arm_length, _WAYS, self._least_hand_times))

    def least_turn_time(self, chain: str, turn: Turn) -> float:
        """Finds the shortest time of a rotation from upright [s]; hinges of one axis share it by how far they go."""
        return _least_turn_time(self.robot, self.limits, chain, turn)

    @cached_property
    def _least_hand_times(self) -> Floats:
        """[s] for each of `_WAYS`, of the slower hand."""
        times = [self._times_of(side) for side in SIDES if self.robot.arm(side).joints]
        return sealed(np.max(times, axis=0) if times else np.zeros(len(_WAYS)))

    def _times_of(self, side: Side) -> Floats:
        """[s] for each of `_WAYS`: along the easiest axis, from the quicker postures."""
        arm = np.array(self.robot.arm(side).joints, dtype=np.intp)
        limits = self.limits.part(arm)
        slopes, ease = self._slopes(side), limits.acceleration
        within = slopes * ease @ slopes.transpose(0, 2, 1) + _DAMPING * np.eye(3)
        # (c, 3, k) [rad/m], the more of a hinge the better it speeds up
        turns = np.linalg.inv(within) @ (slopes * ease)
        times = least_rest_times(self.robot.arm_length * _WAYS[:, None, None, None] * turns, limits).max(axis=-1)
        return np.asarray(np.quantile(times.min(axis=-1), _SKILLED, axis=1))

    def _slopes(self, side: Side) -> Floats:
        """(c, 3, k) [m/rad] how a hand moves with the hinges of its arm, from postures near the middle."""
        skeleton, arm = self.robot.skeleton, list(self.robot.arm(side).joints)
        lower, upper = skeleton.lower[arm], skeleton.upper[arm]
        spread = _MIDDLE * (np.random.default_rng(0).random((_POSTURES, len(arm))) - 0.5)
        postures = np.tile(skeleton.rest, (_POSTURES, len(arm) + 1, 1))
        postures[..., arm] = ((lower + upper) / 2 + spread * (upper - lower))[:, None]
        postures[:, np.arange(1, len(arm) + 1), arm] += _PROBE
        hands = skeleton.frames(postures).origins[:, :, self.robot.arm(side).wrist]
        slopes: Floats = ((hands[:, 1:] - hands[:, :1]) / _PROBE).transpose(0, 2, 1)
        return slopes
