"""Conversion between joint rotations and joint positions (thesis 7.3.1).

A joint's rotation is relative to rest, in the frame of its bone at rest: x along the bone, y aside, z up. Its up
vector travels with the bone by the smallest turn, so that a bone which is aimed is not twisted.
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import rotation_about
from kinesic.ik.thesis.chain import MIN_BONE_RATIO, BallChain

PARALLEL_SINE = 1e-9  # sine of the angle below which two directions are parallel
MIN_OFFSET_RATIO = 1e-9  # [chain lengths] mean distance from the base-hand line below which swivel is undefined


@dataclass(frozen=True, eq=False)
class Carrier:
    """Position and rotation of the base on which a chain stands."""

    point: Floats  # (3,) [m]
    rotation: Floats  # (3, 3) in the world

    @classmethod
    def at_rest(cls, chain: BallChain) -> "Carrier":
        """Make an unrotated base at the chain's first joint."""
        return cls(chain.points[0], np.eye(3))


@dataclass(frozen=True, eq=False)
class ChainPosture:
    """Posture of a ball-joint chain, as rotations, frames and positions."""

    rotations: Floats  # (n, 3, 3) of the joints away from rest, each in the frame of its own bone at rest
    frames: Floats  # (n, 3, 3) in the world: columns along the bone, aside, up
    points: Floats  # (n + 1, 3) [m]
    end: Carrier  # base for chains that start at the last point


def transport_up(up: Floats, start: Floats, end: Floats) -> Floats:
    """Rotate an up vector together with its bone, without twist.

    The turn is about start x end; between opposite directions it is a half turn about the up vector itself.

    Args:
        up: (3,) unit, across `start`.
        start: (3,) unit.
        end: (3,) unit.
    """
    normal = np.cross(start, end)
    sine = float(np.linalg.norm(normal))
    if sine < PARALLEL_SINE:
        return up
    turned: Floats = rotation_about(normal / sine, float(np.arctan2(sine, start @ end))) @ up
    return turned


def stance_of(chain: BallChain, rotations: Floats, carrier: Carrier) -> ChainPosture:
    """Compute joint positions and frames from joint rotations.

    Args:
        chain: at rest.
        rotations: (n, 3, 3) of the joints away from rest.
        carrier: base of the chain.
    """
    frames, points = np.empty_like(chain.frames), np.empty_like(chain.points)
    points[0], turn = carrier.point, carrier.rotation
    for k, (rest, length) in enumerate(zip(chain.frames, chain.lengths, strict=True)):
        frames[k] = turn @ rest @ rotations[k]
        turn = frames[k] @ rest.T
        points[k + 1] = points[k] + length * frames[k, :, 0]
    return ChainPosture(sealed(rotations), sealed(frames), sealed(points), Carrier(sealed(points[-1]), sealed(turn)))


def aim_bones(chain: BallChain, before: Floats, points: Floats, carrier: Carrier) -> ChainPosture:
    """Aim each bone at the next point by the smallest rotation.

    Args:
        chain: at rest.
        before: (n, 3, 3) initial rotations relative to rest; they define the twist.
        points: (n + 1, 3) [m] where the masses have come to rest; their distances need not be the bones' lengths.
        carrier: base of the chain.
    """
    bones = np.diff(points, axis=0)
    lengths = np.linalg.norm(bones, axis=1)
    rotations, turn = np.empty_like(before), carrier.rotation
    for k, rest in enumerate(chain.frames):
        carried = turn @ rest
        frame = carried @ before[k]
        if lengths[k] > MIN_BONE_RATIO * chain.size:
            frame = _rotate_without_twist(frame, bones[k] / lengths[k])
        rotations[k] = carried.T @ frame
        turn = frame @ rest.T
    return stance_of(chain, rotations, carrier)


def _rotate_without_twist(frame: Floats, along: Floats) -> Floats:
    """Return a bone's frame (3, 3) rotated without twist to another direction."""
    side = np.cross(transport_up(frame[:, 2], frame[:, 0], along), along)
    side /= np.linalg.norm(side)
    return np.stack([along, side, np.cross(along, side)], axis=1)


def swivel_chain(points: Floats, up: Floats) -> Floats:
    """Rotate a chain about its base-hand line towards a direction.

    Both ends and all spring lengths stay: the swivel is the degree of freedom that the masses leave open.

    Args:
        points: (n + 1, 3) [m].
        up: (3,) where the joints between the ends should go.

    Returns:
        (n + 1, 3) [m]; unchanged where the chain is straight, closed, or `up` lies along its line.
    """
    line = points[-1] - points[0]
    span, size = float(np.linalg.norm(line)), float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    if span < MIN_OFFSET_RATIO * size:
        return points
    axis = line / span
    away = (points - points[0]).mean(axis=0)
    bend, wish = away - (away @ axis) * axis, up - (up @ axis) * axis
    if np.linalg.norm(bend) < MIN_OFFSET_RATIO * size or np.linalg.norm(wish) < MIN_OFFSET_RATIO * np.linalg.norm(up):
        return points
    angle = float(np.arctan2(axis @ np.cross(bend, wish), bend @ wish))
    turned: Floats = points[0] + (points - points[0]) @ rotation_about(axis, angle).T
    return turned
