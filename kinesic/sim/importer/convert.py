"""Converts a foreign robot's file to a robot's tables, with remarks for whoever reviews them."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, exp
from pathlib import Path

import msgspec

from kinesic.body.robot import SIDE_NAMES, SIDES, Robot, Side
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import ImportTable, RobotFile, ServoTable
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.importer.hand import MappedHand, find_hand
from kinesic.sim.importer.hand_tables import Hands, with_hands
from kinesic.sim.importer.hinges import MappedHinge, named_hinges, spell_angle
from kinesic.sim.importer.load import load_model
from kinesic.sim.importer.rest_pose import nearest_to_zero, rest_pose, with_exclusions
from kinesic.sim.importer.segments import lay_out_segments
from kinesic.sim.importer.servos import servo
from kinesic.sim.importer.tables import robot_tables, servo_of
from kinesic.sim.importer.zero_pose import HumanoidGeometry, geometry_of

REVIEW_BELOW = 0.6  # confidence
PLAIN, SURE = 1.0, 3.0  # likeness of a split at which confidence is 0, and 1
LEANING = 0.5  # [rad] an arm that hangs so far off takes two thirds of the confidence
UNEVEN = 0.5  # arm lengths of asymmetry that do so
UNTOLD = 0.7  # times the confidence where nothing says which side is left
UNIT = ServoTable(0, 48.0, 1.0, 1.0, 60.0, 1.0, 0.0, (0.01,) * 3, 800.0, 0.0, 128.0, 0.0, 0.0, 0.0)  # of 1 Nm


@dataclass(frozen=True, eq=False)
class Mapped:
    """A foreign robot as kinesic's, to be written and reviewed."""

    file: RobotFile
    figure: HumanoidGeometry
    hinges: tuple[MappedHinge, ...]  # without fingers
    hands: Mapping[Side, MappedHand]  # those that have fingers
    remarks: Mapping[str, str]  # hinge, or name of its servo -> where its figures come from
    confidence: float  # 0..1

    @property
    def doubtful(self) -> bool:
        """Whether a person must look at it before it moves."""
        return self.confidence < REVIEW_BELOW


def import_humanoid(path: Path) -> Mapped:
    """Maps an MJCF or URDF humanoid.

    Raises:
        ConfigError: the file cannot be read, or has no two arms.
    """
    found = geometry_of(load_model(path))
    hinges = named_hinges(found)
    where = lay_out_segments(found, hinges)
    hands = {side: hand for side in SIDES if (hand := find_hand(found, side)) is not None}
    fingers = tuple(hinge for hand in hands.values() for finger in hand.fingers for hinge in finger.hinges)
    alike = {servo_of(hinge): UNIT for hinge in (*hinges, *fingers)}
    plain = robot_tables(found, where, hinges, alike, nearest_to_zero(hinges))
    draft = with_hands(plain, hands, found.tree, where)
    servos, sources = _servos(found, (*hinges, *fingers), draft, path)
    file = msgspec.structs.replace(draft, servos=servos)
    rest = {name: angle for name, angle in draft.rest.items() if name in {hinge.name for hinge in fingers}}
    rest = {name: angle for name, angle in (rest_pose(found, hinges, file, path) | rest).items() if angle}
    file = with_exclusions(msgspec.structs.replace(file, rest=rest), path)
    confidence = _confidence(found)
    file.robot.imported = ImportTable(path.name, round(confidence, 2), _review(found, hinges, hands))
    joints = found.tree.joints
    remarks = {hinge.name: spell_angle(hinge, joints[hinge.joint].name) for hinge in (*hinges, *fingers)}
    return Mapped(file, found, hinges, hands, remarks | sources, confidence)


def _servos(
    figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], draft: RobotFile, path: Path
) -> tuple[dict[str, ServoTable], dict[str, str]]:
    """A servo model for each pair of hinges, strong enough for the worse side, and where its figures come from."""
    robot = Robot.of(robot_from_tables(draft, path))
    load = MujocoDynamics(robot).load
    found: dict[str, tuple[ServoTable, str]] = {}
    for hinge in hinges:
        joint = robot.skeleton.joint(hinge.name)
        foreign = figure.tree.joints[hinge.joint]
        model = servo(foreign, gravity=float(load.holding[joint]), inertia=float(load.inertia[joint]))
        found.setdefault(servo_of(hinge), model)
    return {name: table for name, (table, _) in found.items()}, {name: why for name, (_, why) in found.items()}


def _confidence(figure: HumanoidGeometry) -> float:
    """How far geometry speaks for the mapping, 0 to 1."""
    split = min(max((figure.likeness - PLAIN) / (SURE - PLAIN), 0.0), 1.0)
    leaning = max(arm.off for arm in figure.arms.values())
    sides = 1.0 if figure.sides.certain else UNTOLD
    return split * sides * exp(-leaning / LEANING) * exp(-figure.asymmetry / UNEVEN)


def _review(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], hands: Hands) -> list[str]:
    assumed = [hinge.name for hinge in hinges if hinge.assumed]
    leaning = degrees(max(arm.off for arm in figure.arms.values()))
    said = {
        f"ranges of {', '.join(assumed)} are assumed, as the file tells none": bool(assumed),
        "which side is left is a guess": not figure.sides.certain,
        "pairs of hinges were found by name, as the file's pose is not symmetric": figure.sides.by_names,
        f"arms hang {leaning:.0f} deg off the vertical at best": leaning > 10.0,
        f"the arms differ by {100 * figure.asymmetry:.0f} % of their length": figure.asymmetry > 0.02,
        "palms are assumed to face the thighs": not hands,
        _words(hands): bool(hands),
        f"{_without_fingers(figure, hands)}": len(hands) < len(SIDES),
        "legs are left out, the trunk stands on a fixed base": True,
    }
    led = [f"{name} follows another hinge in its file, and has a motor here" for name in _unled(figure, hinges, hands)]
    return [*(text for text, applies in said.items() if applies), *led, *figure.tree.left_out]


def _words(hands: Hands) -> str:
    """Which fingers were found."""
    each = {side: ", ".join(finger.name for finger in hand.fingers) for side, hand in hands.items()}
    found = "; ".join(f"{SIDE_NAMES[side]}: {names}" for side, names in each.items())
    return f"fingers, and where palms look, were found by geometry, straight at zero ({found})"


def _without_fingers(figure: HumanoidGeometry, hands: Hands) -> str:
    """Says of what hangs on the last hinge of an arm that it is held."""
    tree = figure.tree
    held = [
        tree.joints[k].name
        for side in SIDES
        if side not in hands
        for k in tree.below(figure.arms[side].joints[-1])
        if k not in figure.arms[side].joints
    ]
    return f"{', '.join(held)} are held: a hand needs a thumb and two fingers" if held else "hands have no fingers"


def _unled(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], hands: Hands) -> list[str]:
    """Hinges that follow another one in the file, but not here."""
    follows = {name for hand in hands.values() for finger in hand.fingers for name in finger.follows}
    every = [*hinges, *(turn for hand in hands.values() for finger in hand.fingers for turn in finger.turns)]
    joints = figure.tree.joints
    return [joints[turn.joint].name for turn in every if joints[turn.joint].follows and turn.name not in follows]
