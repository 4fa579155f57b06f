"""An arm as closed forms want it: twists exactly along their bones, and no more hinges than aim them.

Real robots miss that by degrees and centimetres. The ideal arm keeps centres and hinges, so its angles are a good
guess for the real one; inverse kinematics finishes on the real one.
"""

from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.skeleton import Hinge

LENGTHWISE = 0.8  # cosine to its bone from which a joint's last hinge is a twist
EXACT = 1e-9  # sine of the angle below which it lies along the bone already
MOST_SWINGS = 2  # of one joint


def ideal(chain: Chain) -> Chain:
    """The chain itself, where it is ideal already.

    A joint's last hinge near its bone comes to lie along it. Where more than two others swing the bone, the one
    nearest to it is left out, and stays where it is.
    """
    kept: list[int] = []
    joints: list[ChainJoint] = []
    rows = iter(chain.indices)
    for joint in chain.joints:
        indices = [next(rows) for _ in joint.hinges]
        hinges = _aiming(_straightened(joint))
        kept += [index for index, hinge in zip(indices, joint.hinges, strict=True) if _named(hinge, hinges)]
        joints.append(joint if hinges == joint.hinges else replace(joint, hinges=hinges))
    if all(new is old for new, old in zip(joints, chain.joints, strict=True)):
        return chain
    return replace(chain, joints=tuple(joints), indices=tuple(kept))


def _straightened(joint: ChainJoint) -> ChainJoint:
    """The joint with its twist along its bone."""
    length = float(np.linalg.norm(joint.bone))
    if not joint.hinges or length == 0.0:
        return joint
    along, last = joint.bone / length, joint.hinges[-1]
    cosine = float(last.axis @ along)
    if abs(cosine) < LENGTHWISE or float(np.linalg.norm(np.cross(last.axis, along))) < EXACT:
        return joint
    twist = replace(last, axis=sealed(np.sign(cosine) * along))
    return replace(joint, hinges=(*joint.hinges[:-1], twist))


def _aiming(joint: ChainJoint) -> tuple[Hinge, ...]:
    """Its hinges without those that are one too many."""
    hinges, bone = joint.hinges, joint.bone
    twists = bool(hinges) and _lengthwise(hinges[-1], bone) > 1.0 - EXACT
    swings = list(hinges[:-1] if twists else hinges)
    while len(swings) > MOST_SWINGS:
        swings.remove(max(swings, key=lambda hinge: _lengthwise(hinge, bone)))
    if len(swings) + twists == len(hinges):
        return hinges
    return (*swings, hinges[-1]) if twists else tuple(swings)


def _lengthwise(hinge: Hinge, bone: Floats) -> float:
    return abs(float(hinge.axis @ bone)) / max(float(np.linalg.norm(bone)), 1e-12)


def _named(hinge: Hinge, hinges: tuple[Hinge, ...]) -> bool:
    return any(hinge.name == other.name for other in hinges)
