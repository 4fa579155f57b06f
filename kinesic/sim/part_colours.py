"""Colours of a robot's parts, the same in films, pages and scenes."""

from typing import Literal

from kinesic.body.robot import SIDES, Robot, Side

RodPart = Literal["trunk", "limb", "l_hand", "r_hand"]
PART_COLOURS: dict[RodPart, tuple[float, ...]] = {
    "trunk": (0.34, 0.42, 0.52, 1.0),
    "limb": (0.93, 0.92, 0.89, 1.0),
    "l_hand": (0.95, 0.55, 0.22, 1.0),
    "r_hand": (0.16, 0.56, 0.66, 1.0),
}


def parts(robot: Robot) -> dict[str, RodPart]:
    """Return the body part of each segment, which determines its colour."""
    limbs = {segment for side in SIDES for segment in robot.arm(side).segments}
    limbs |= set(robot.chains.get("neck", ()))
    painted: dict[str, RodPart] = {s.name: "limb" if s.name in limbs else "trunk" for s in robot.skeleton.segments}
    colours: dict[Side, RodPart] = {"l": "l_hand", "r": "r_hand"}
    hands = {side: (robot.arm(side).segments[-1], *robot.fingers(side)) for side in SIDES}
    return painted | {name: colours[side] for side, names in hands.items() for name in names}


def shell_parts(robot: Robot) -> dict[str, RodPart]:
    """Return each segment's body part, with the trunk coloured as limb.

    The trunk is painted like the limbs.
    """
    return {name: "limb" if part == "trunk" else part for name, part in parts(robot).items()}
