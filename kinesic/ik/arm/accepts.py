"""Validation and normal form of arm chains.

The closed forms aim a bone with at most two hinges and turn it about itself with one more. Axes need not be
perpendicular to one another or to the bone.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.config import ConfigError
from kinesic.body.skeleton import Hinge

PARALLEL_SINE = 1e-9  # sine of the angle below which two lines are parallel
MIN_BONE_RATIO = 1e-6  # shortest accepted bone / length of the chain
UNIT_TOLERANCE = 1e-6  # largest deviation of an axis' length from 1
MIN_JOINTS = 3  # smallest number of joints of an arm: shoulder, elbow and wrist
MAX_SWING_HINGES = 2  # largest number of hinges of one joint that swing its bone


def accept_chain(chain: Chain) -> Chain:
    """Convert an arm chain to the solver's normal form, or raise.

    A joint's first hinge that lies along the parent's bone slides down that bone and becomes the parent's twist:
    the motion is the same. So a wrist written as twist, pitch, roll leaves two hinges to aim the hand.

    Args:
        chain: of any robot.

    Returns:
        A chain with the same hinges in the same order and the same places for the same angles.

    Raises:
        ConfigError: the chain breaks a rule; the message names the rule, the place and a remedy.
    """
    where = f"chain {chain.name}"
    if len(chain.joints) < MIN_JOINTS:
        raise ConfigError(f"{where} has {len(chain.joints)} joints; an arm has at least shoulder, elbow, wrist")
    _check_figures(where, "origin_in_base", chain.origin_in_base)
    _check_figures(where, "palm", chain.palm)
    for joint in chain.joints:
        _check_figures(where, f"bone of joint {joint.name}", joint.bone)
    for joint in chain.joints:
        if joint is not chain.joints[-1]:
            _check_bone(where, joint, float(chain.lengths.sum()))
        for hinge in joint.hinges:
            _check_hinge(f"{where}: hinge {hinge.name}", hinge)
    joints = _move_twist_hinges_to_parent(chain.joints)
    for joint in joints:
        _check_joint(where, joint)
    return replace(chain, joints=joints)


def _move_twist_hinges_to_parent(joints: Sequence[ChainJoint]) -> tuple[ChainJoint, ...]:
    """Reassign first hinges parallel to the parent's bone to the parent joint."""
    regrouped = [joints[0]]
    for joint in joints[1:]:
        parent = regrouped[-1]
        slides = int(bool(joint.hinges) and _parallel(joint.hinges[0].axis, parent.bone))
        regrouped[-1] = replace(parent, hinges=parent.hinges + joint.hinges[:slides])
        regrouped.append(replace(joint, hinges=joint.hinges[slides:]))
    return tuple(regrouped)


def _check_joint(where: str, joint: ChainJoint) -> None:
    for first, second in zip(joint.hinges, joint.hinges[1:], strict=False):
        if _parallel(first.axis, second.axis):
            raise ConfigError(
                f"{where}: joint {joint.name}: hinges {first.name} and {second.name} turn about the same line; "
                f"one of them is enough, or give them different axes"
            )
    twists = bool(joint.hinges) and _parallel(joint.hinges[-1].axis, joint.bone)
    swings = [hinge.name for hinge in (joint.hinges[:-1] if twists else joint.hinges)]
    if len(swings) > MAX_SWING_HINGES:
        raise ConfigError(
            f"{where}: joint {joint.name}: hinges {', '.join(swings)} all swing its bone {joint.bone.tolist()}; "
            f"at most two may swing it, and a last one may twist it: align the axis of {swings[-1]} with the bone"
        )


def _check_bone(where: str, joint: ChainJoint, size: float) -> None:
    length = float(np.linalg.norm(joint.bone))
    if not length > MIN_BONE_RATIO * size:
        raise ConfigError(
            f"{where}: joint {joint.name}: its bone is {length:g} m long; put hinges with a common centre into "
            f"one joint (only the bone of the hand may have length 0)"
        )


def _check_hinge(where: str, hinge: Hinge) -> None:
    _check_figures(where, "axis", hinge.axis)
    length = float(np.linalg.norm(hinge.axis))
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise ConfigError(f"{where}: axis {hinge.axis.tolist()} has length {length:g}; divide it by its length")
    if not np.isfinite([hinge.lower, hinge.upper, hinge.rest]).all():
        raise ConfigError(f"{where}: range [{hinge.lower}, {hinge.upper}], rest {hinge.rest}: all must be finite [rad]")
    if hinge.lower > hinge.upper:
        raise ConfigError(
            f"{where}: range [{hinge.lower:g}, {hinge.upper:g}] rad is empty; write the lower limit first"
        )


def _check_figures(where: str, name: str, values: Floats) -> None:
    if np.shape(values) != (3,) or not np.isfinite(values).all():
        raise ConfigError(f"{where}: {name} is {np.asarray(values).tolist()}; it needs three finite numbers")


def _parallel(axis: Floats, line: Floats) -> bool:
    return float(np.linalg.norm(np.cross(axis, line))) < PARALLEL_SINE * float(np.linalg.norm(line))
