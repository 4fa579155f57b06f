"""Motions as BVH files of the robot's skeleton.

The file has y up, z forward and x left, in centimetres. Its zero pose is the one in which all hinge angles are zero.
Each segment is a BVH joint with its H-Anim name. If the axes of a segment's hinges have different centres, there is one
BVH joint for each centre; all but the last have the name of their first rotation.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.body.rotation import rotation_about
from kinesic.body.skeleton import Skeleton

CENTIMETRES_PER_METRE = 100.0  # BVH offsets are in centimetres by convention
BVH_AXES = (1, 2, 0)  # indices of kinesic's axes y, z and x, which are BVH's x, y and z
ROTATION_CHANNELS = "Zrotation Yrotation Xrotation"  # order in which rotations are multiplied
POSITION_CHANNELS = "Xposition Yposition Zposition"  # channels of the root
CENTRE_TOLERANCE = 2e-4  # [m] distance up to which centres of rotation count as one
END_LENGTH = 0.05  # [m] bone of a last joint whose segment has no capsule


@dataclass(frozen=True, eq=False)
class _Joint:
    """BVH joint: rotations of a segment about one centre."""

    name: str
    parent: int  # index of the parent joint, -1 for the root
    offset: Floats  # (3,) [m] centre in the parent joint's frame
    turns: tuple[int, ...]  # rotations, indices of hinges and, after them, couplings
    end: Floats | None  # (3,) [m] end of the bone if no joint follows


def write_bvh(angles: Floats, robot: Robot, path: Path, *, rate: int) -> None:
    """Write a motion as a BVH file.

    Args:
        angles: (m, n) [rad].
        robot: with the skeleton.
        path: of the file.
        rate: [Hz] of the angles.
    """
    joints = _list_joints(robot)
    order = _order_by_depth(joints, 0)
    turns = robot.skeleton.with_couplings(angles)
    columns = [np.tile(_bvh_point(joints[0].offset), (len(angles), 1))]
    columns += [_euler_angles(_rotations(joint, turns, robot.skeleton)) for joint in (joints[k] for k in order)]
    with path.open("w", newline="\n", encoding="utf-8") as file:
        file.write("\n".join(["HIERARCHY", *_hierarchy(joints, 0, 0), "MOTION", f"Frames: {len(angles)}", ""]))
        file.write(f"Frame Time: {1.0 / rate:.6f}\n")
        np.savetxt(file, np.concatenate(columns, axis=1), fmt="%.6f")


def _list_joints(robot: Robot) -> Sequence[_Joint]:
    """Return the BVH joints of a robot, parents first."""
    skeleton = robot.skeleton
    parents = {segment.parent for segment in skeleton.segments}
    joints: list[_Joint] = []
    last: list[int] = []  # last joint of each segment
    centres: list[Floats] = []  # centre of that joint, in the segment
    for segment, (parent, origin, turns) in zip(skeleton.segments, skeleton.steps, strict=True):
        groups = list(_group_turns(turns))
        previous = origin if parent < 0 else origin - centres[parent]
        owner, end = -1 if parent < 0 else last[parent], None
        for number, (centre, members) in enumerate(groups):
            is_last = number == len(groups) - 1
            if is_last and segment.name not in parents:
                tips = [capsule.end for capsule in segment.capsules] or [np.array([0.0, 0.0, -END_LENGTH])]
                end = max(tips, key=lambda tip: float(np.linalg.norm(tip))) - centre
            name = segment.name if is_last else _turn_name(skeleton, members[0])
            joints.append(_Joint(name, owner, previous + centre, members, end))
            previous, owner = -centre, len(joints) - 1
        last.append(owner)
        centres.append(groups[-1][0])
    return joints


def _order_by_depth(joints: Sequence[_Joint], index: int) -> Sequence[int]:
    """Return the indices of a joint and its descendants, depth first."""
    children = [k for k, joint in enumerate(joints) if joint.parent == index]
    return [index, *(k for child in children for k in _order_by_depth(joints, child))]


def _group_turns(turns: Sequence[tuple[int, Floats | None]]) -> Iterator[tuple[Floats, tuple[int, ...]]]:
    """Yield each rotation centre (3,) [m] with the rotations about it."""
    centre, members = np.zeros(3), tuple[int, ...]()
    for turn, at in turns:
        place = np.zeros(3) if at is None else at
        if not members:
            centre = place
        elif float(np.linalg.norm(place - centre)) > CENTRE_TOLERANCE:
            yield centre, members
            centre, members = place, ()
        members = (*members, turn)
    yield centre, members


def _turn_name(skeleton: Skeleton, turn: int) -> str:
    count = len(skeleton.hinges)
    return skeleton.names[turn] if turn < count else skeleton.couplings[turn - count].name


def _hierarchy(joints: Sequence[_Joint], index: int, depth: int) -> Iterator[str]:
    """Yield the lines of a joint and of its descendants."""
    joint, indent = joints[index], "\t" * depth
    yield f"{indent}{'JOINT' if depth else 'ROOT'} {joint.name}"
    yield f"{indent}{{"
    yield f"{indent}\t{_offset(joint.offset if depth else np.zeros(3))}"  # the root has its place in channels
    yield f"{indent}\tCHANNELS " + (f"3 {ROTATION_CHANNELS}" if depth else f"6 {POSITION_CHANNELS} {ROTATION_CHANNELS}")
    for child in (k for k, other in enumerate(joints) if other.parent == index):
        yield from _hierarchy(joints, child, depth + 1)
    if joint.end is not None:
        yield from (f"{indent}\tEnd Site", f"{indent}\t{{", f"{indent}\t\t{_offset(joint.end)}", f"{indent}\t}}")
    yield f"{indent}}}"


def _offset(point: Floats) -> str:
    return "OFFSET " + " ".join(f"{value:.6f}" for value in _bvh_point(point))


def _bvh_point(point: Floats) -> Floats:
    """Convert a point (3,) [m] to BVH's axes and centimetres."""
    converted: Floats = CENTIMETRES_PER_METRE * point[list(BVH_AXES)]
    return converted


def _rotations(joint: _Joint, turns: Floats, skeleton: Skeleton) -> Floats:
    """Return the rotations (m, 3, 3) of a joint in BVH's axes.

    Args:
        joint: of the BVH file.
        turns: (m, n + c) [rad] angles of hinges and couplings.
        skeleton: of the robot.
    """
    rotation = np.tile(np.eye(3), (len(turns), 1, 1))
    for turn in joint.turns:
        rotation = rotation @ rotation_about(skeleton.axes[turn], turns[:, turn])
    return rotation[:, BVH_AXES][:, :, BVH_AXES]


def _euler_angles(rotations: Floats) -> Floats:
    """Convert rotations (m, 3, 3) to zyx Euler angles (m, 3) [deg]."""
    z = np.arctan2(rotations[:, 1, 0], rotations[:, 0, 0])
    y = np.arcsin(np.clip(-rotations[:, 2, 0], -1.0, 1.0))
    x = np.arctan2(rotations[:, 2, 1], rotations[:, 2, 2])
    return np.degrees(np.unwrap(np.stack([z, y, x], axis=1), axis=0))
