"""Turns a figure into the tables of a robot's file."""

from collections.abc import Mapping
from math import degrees

import numpy as np

from kinesic.body.robot import SIDES, Side
from kinesic.body.robot_schema import (
    CollisionTable,
    HingeTable,
    MountTable,
    RobotFile,
    RobotTable,
    ServoTable,
    SiteTable,
    Triple,
)
from kinesic.sim.importer.eyes import place_eyes
from kinesic.sim.importer.hinge_row import foot
from kinesic.sim.importer.hinges import MappedHinge
from kinesic.sim.importer.segments import HEAD, TRUNK, SegmentLayout, bodies, carried_parts, hand_vector, rounded_triple
from kinesic.sim.importer.zero_pose import HumanoidGeometry

CLEARANCE = 0.010  # [m]
PALM = 0.5  # of the hand's length
EYES_HIGH = 1.13  # [m] of the default robot, for whose eyes the targets below are placed
TARGETS: Mapping[str, Triple] = {
    "audience": (2.0, 0.0, 1.2),
    "camera": (1.5, 0.0, 1.3),
    "user": (1.5, 0.0, 1.1),
    "left": (1.0, 1.5, 1.0),
    "right": (1.0, -1.5, 1.0),
}


def robot_tables(
    figure: HumanoidGeometry,
    where: SegmentLayout,
    hinges: tuple[MappedHinge, ...],
    servos: Mapping[str, ServoTable],
    rest: Mapping[str, float],
) -> RobotFile:
    """Makes the file of a robot, without what is excluded from collisions.

    Args:
        figure: the robot, arms hanging.
        where: its segments.
        hinges: named.
        servos: a model for each hinge, named as `servo_of` says.
        rest: hinge -> [deg].
    """
    eyes = place_eyes(figure, where, carried_parts(figure, where, hinges))
    high = float((where.origins[eyes.body] + eyes.at)[2])
    return RobotFile(
        robot=RobotTable(name=figure.tree.name),
        body=bodies(figure, where, hinges),
        hinge=[_hinge(where, hinge) for hinge in hinges],
        chains=_chains(figure, where),
        sites={f"{side}_palm": _palm(figure, where, side) for side in SIDES} | {"eyes": eyes},
        collision=CollisionTable(clearance=CLEARANCE),
        rest=dict(rest),
        targets={name: (x, y, round(z + high - EYES_HIGH, 3)) for name, (x, y, z) in TARGETS.items()},
        servos=dict(servos),
    )


def servo_of(hinge: MappedHinge) -> str:
    """Names a hinge's servo model; mirror images share it."""
    return hinge.name.removeprefix("l_").removeprefix("r_")


def _hinge(where: SegmentLayout, hinge: MappedHinge) -> HingeTable:
    origin = where.origins[hinge.segment]
    at = rounded_triple(foot(origin, hinge.anchor, hinge.axis) - origin)
    x, y, z = (round(float(value), 9) + 0.0 for value in hinge.axis)
    return HingeTable(
        name=hinge.name,
        body=hinge.segment,
        axis=(x, y, z),
        range_deg=(round(degrees(hinge.lower), 3), round(degrees(hinge.upper), 3)),
        servo=servo_of(hinge),
        mount=MountTable(where.parents[hinge.segment], (0.0, 0.0, 0.0)),
        at=at,
    )


def _chains(figure: HumanoidGeometry, where: SegmentLayout) -> dict[str, list[str]]:
    chains = {"torso": [TRUNK]} if figure.trunk else {}
    if figure.neck:
        chains["neck"] = [HEAD]
    for side in SIDES:
        girdle = [f"{side}_sternoclavicular"] if figure.split.girdle else []
        chains[f"{side}_arm"] = [*girdle, f"{side}_shoulder", f"{side}_elbow", f"{side}_wrist"]
    return chains


def _palm(figure: HumanoidGeometry, where: SegmentLayout, side: Side) -> SiteTable:
    """The palm half-way along the hand, facing the thigh."""
    along = hand_vector(figure, where, side)
    inward = np.array([0.0, -1.0 if side == "l" else 1.0, 0.0])
    direction = along / np.linalg.norm(along)
    facing = inward - direction * (direction @ inward)
    return SiteTable(f"{side}_wrist", rounded_triple(PALM * along), rounded_triple(facing / np.linalg.norm(facing)))
