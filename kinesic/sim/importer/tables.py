"""Tables of a robot file, made from a humanoid's geometry."""

from collections.abc import Mapping
from math import degrees

import numpy as np

from kinesic.body.robot import Side
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
from kinesic.sim.importer.segments import (
    HEAD_SEGMENT,
    TRUNK_SEGMENT,
    SegmentLayout,
    assign_parts,
    bodies,
    compute_hand_vector,
    round_triple,
)
from kinesic.sim.importer.zero_pose import HumanoidGeometry

MIN_CLEARANCE = 0.010  # [m] self-collision clearance of imported robots
PALM_FRACTION = 0.5  # position of the palm along the hand, from wrist (0) to tip (1)
DEFAULT_EYE_HEIGHT = 1.13  # [m] height of the default robot's eyes, to which the targets refer
DEFAULT_TARGETS: Mapping[str, Triple] = {
    "audience": (2.0, 0.0, 1.2),
    "camera": (1.5, 0.0, 1.3),
    "user": (1.5, 0.0, 1.1),
    "left": (1.0, 1.5, 1.0),
    "right": (1.0, -1.5, 1.0),
}


def robot_tables(
    figure: HumanoidGeometry,
    layout: SegmentLayout,
    hinges: tuple[MappedHinge, ...],
    servos: Mapping[str, ServoTable],
    rest: Mapping[str, float],
) -> RobotFile:
    """Create the robot tables without fingers and collision exclusions.

    Args:
        figure: Robot with hanging arms.
        layout: Segments of the robot.
        hinges: Named hinges.
        servos: Servo models by the names of `name_servo`.
        rest: Hinge -> [deg].
    """
    eyes = place_eyes(figure, layout, assign_parts(figure, layout, hinges))
    eye_height = float((layout.origins[eyes.body] + eyes.at)[2])
    return RobotFile(
        robot=RobotTable(name=figure.tree.name),
        body=bodies(figure, layout, hinges),
        hinge=[_hinge(layout, hinge) for hinge in hinges],
        chains=_list_chains(figure, layout),
        sites={f"{side}_palm": _place_palm(figure, layout, side) for side in figure.arms} | {"eyes": eyes},
        collision=CollisionTable(clearance=MIN_CLEARANCE),
        rest=dict(rest),
        targets={
            name: (x, y, round(z + eye_height - DEFAULT_EYE_HEIGHT, 3)) for name, (x, y, z) in DEFAULT_TARGETS.items()
        },
        servos=dict(servos),
    )


def name_servo(hinge: MappedHinge) -> str:
    """Return the key of a hinge's servo table: its name without side."""
    return hinge.name.removeprefix("l_").removeprefix("r_")


def _hinge(layout: SegmentLayout, hinge: MappedHinge) -> HingeTable:
    origin = layout.origins[hinge.segment]
    at = round_triple(foot(origin, hinge.anchor, hinge.axis) - origin)
    x, y, z = (round(float(value), 9) + 0.0 for value in hinge.axis)
    return HingeTable(
        name=hinge.name,
        body=hinge.segment,
        axis=(x, y, z),
        range_deg=(round(degrees(hinge.lower), 3), round(degrees(hinge.upper), 3)),
        servo=name_servo(hinge),
        mount=MountTable(layout.parents[hinge.segment], (0.0, 0.0, 0.0)),
        at=at,
    )


def _list_chains(figure: HumanoidGeometry, layout: SegmentLayout) -> dict[str, list[str]]:
    chains = {"torso": [TRUNK_SEGMENT]} if figure.trunk else {}
    if figure.neck:
        chains["neck"] = [HEAD_SEGMENT]
    for side in figure.arms:
        girdle = [f"{side}_sternoclavicular"] if figure.split.girdle else []
        chains[f"{side}_arm"] = [*girdle, f"{side}_shoulder", f"{side}_elbow", f"{side}_wrist"]
    return chains


def _place_palm(figure: HumanoidGeometry, layout: SegmentLayout, side: Side) -> SiteTable:
    """Return a palm site halfway along the hand, facing the thigh."""
    along = compute_hand_vector(figure, layout, side)
    inward = np.array([0.0, -1.0 if side == "l" else 1.0, 0.0])
    direction = along / np.linalg.norm(along)
    facing = inward - direction * (direction @ inward)
    return SiteTable(
        f"{side}_wrist", round_triple(PALM_FRACTION * along), round_triple(facing / np.linalg.norm(facing))
    )
