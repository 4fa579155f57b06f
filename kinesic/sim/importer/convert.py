"""Conversion of MJCF or URDF files to robot tables with review notes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees, exp
from pathlib import Path

import msgspec

from kinesic.body.robot import SIDE_NAMES, SIDES, Robot, Side
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import ImportTable, RobotFile, ServoTable, SourceTable
from kinesic.files.unicode_text import escape_surrogates
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.importer.hand import MappedHand, find_hand
from kinesic.sim.importer.hand_tables import Hands, with_hands
from kinesic.sim.importer.hinges import MappedHinge, describe_source, name_hinges, spell_angle
from kinesic.sim.importer.joint_words import is_contradiction
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.rest_pose import find_limits_nearest_to_zero, rest_pose, with_exclusions
from kinesic.sim.importer.segments import lay_out_segments
from kinesic.sim.importer.servos import servo
from kinesic.sim.importer.tables import name_servo, robot_tables
from kinesic.sim.importer.wishes import read_wishes
from kinesic.sim.importer.zero_pose import HumanoidGeometry, analyse_geometry

REVIEW_CONFIDENCE = 0.6  # confidence in the joint mapping below which a person must review the mapping
ZERO_CONFIDENCE_LIKENESS = 1.0  # score of `likeness` (higher: more like a human arm) up to which the confidence is 0
FULL_CONFIDENCE_LIKENESS = 3.0  # score of `likeness` from which on the score does not reduce the confidence
LEANING_SCALE = 0.5  # [rad] angle of a hanging arm off the vertical that divides the confidence by e
ASYMMETRY_SCALE = 0.5  # [arm lengths] asymmetry of the arms that divides the confidence by e
CONTRADICTION_RATE = 3.0  # rate at which the confidence decays with the fraction of joints named after other body parts
DOUBTFUL_LIMB_FACTOR = 0.5  # factor on the confidence if the arms may be legs
GUESSED_SIDE_FACTOR = 0.7  # factor on the confidence if the left side is guessed
# Placeholder servo with 1 Nm stall torque, until the loads of the hinges are known.
UNIT_SERVO = ServoTable(0, 48.0, 1.0, 1.0, 60.0, 1.0, 0.0, (0.01,) * 3, 800.0, 0.0, 128.0, 1e-6, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Mapped:
    """Converted robot with its hinge mapping and the confidence in it."""

    file: RobotFile  # robot tables to be written
    figure: HumanoidGeometry  # geometry in the zero pose
    hinges: tuple[MappedHinge, ...]  # hinges without fingers
    hands: Mapping[Side, MappedHand]  # hands with fingers, by side
    remarks: Mapping[str, str]  # hinge or servo name -> source of its values
    confidence: float  # 0..1, of the mapping

    @property
    def doubtful(self) -> bool:
        """Whether a person must review the mapping before the robot moves."""
        return self.confidence < REVIEW_CONFIDENCE


def import_humanoid(path: Path, wished: Sequence[str] = ()) -> Mapped:
    """Convert an MJCF or URDF humanoid to kinesic robot tables.

    Args:
        path: File of the robot.
        wished: Requested hinges of joints, each as JOINT=HINGE.

    Raises:
        ConfigError: the file cannot be read, or no two arms are found.
    """
    geometry = analyse_geometry(*read_wishes(load_robot_tree(path), wished))
    hinges = name_hinges(geometry)
    layout = lay_out_segments(geometry, hinges)
    hands = {side: hand for side in geometry.arms if (hand := find_hand(geometry, side)) is not None}
    fingers = tuple(hinge for hand in hands.values() for finger in hand.fingers for hinge in finger.hinges)
    unit_servos = {name_servo(hinge): UNIT_SERVO for hinge in (*hinges, *fingers)}
    tables_without_hands = robot_tables(geometry, layout, hinges, unit_servos, find_limits_nearest_to_zero(hinges))
    draft = with_hands(tables_without_hands, hands, geometry.tree, layout)
    servos, sources = _choose_servos(geometry, (*hinges, *fingers), draft, path)
    file = msgspec.structs.replace(draft, servos=servos)
    rest = {name: angle for name, angle in draft.rest.items() if name in {hinge.name for hinge in fingers}}
    rest = {name: angle for name, angle in (rest_pose(geometry, hinges, file, path, rest) | rest).items() if angle}
    file = with_exclusions(msgspec.structs.replace(file, rest=rest), path)
    turns = (*hinges, *(turn for hand in hands.values() for finger in hand.fingers for turn in finger.turns))
    joint_names = {turn.name: geometry.tree.joints[turn.joint].name for turn in turns}
    file = _add_sources(file, {turn.name: describe_source(turn, joint_names[turn.name]) for turn in turns})
    confidence = _rate_confidence(geometry, hinges)
    file.robot.imported = ImportTable(
        escape_surrogates(path.name),
        round(confidence, 2),
        [*_review(geometry, hinges, hands), *_review_servos(sources)],
    )
    remarks = {hinge.name: spell_angle(hinge, joint_names[hinge.name]) for hinge in (*hinges, *fingers)}
    return Mapped(file, geometry, hinges, hands, remarks | sources, confidence)


def _add_sources(file: RobotFile, sources: Mapping[str, SourceTable]) -> RobotFile:
    """Note the imported joint's name in each hinge and coupling table."""
    return msgspec.structs.replace(
        file,
        hinge=[msgspec.structs.replace(hinge, source=sources[hinge.name]) for hinge in file.hinge],
        coupling=[msgspec.structs.replace(coupling, source=sources[coupling.name]) for coupling in file.coupling],
    )


def _choose_servos(
    figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], draft: RobotFile, path: Path
) -> tuple[dict[str, ServoTable], dict[str, str]]:
    """Choose a servo model for each left-right pair of hinges.

    Each model is strong enough for the side with the larger load.

    Returns:
        Servo tables and the sources of their values, both by servo name.
    """
    robot = Robot.of(robot_from_tables(draft, path))
    load = MujocoDynamics(robot).load
    geometry: dict[str, tuple[ServoTable, str]] = {}
    for hinge in hinges:
        joint = robot.skeleton.joint(hinge.name)
        foreign = figure.tree.joints[hinge.joint]
        model = servo(foreign, gravity=float(load.holding[joint]), inertia=float(load.inertia[joint]))
        geometry.setdefault(name_servo(hinge), model)
    return {name: table for name, (table, _) in geometry.items()}, {
        name: source for name, (_, source) in geometry.items()
    }


def _rate_confidence(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...]) -> float:
    """Compute the confidence 0..1 in the joint mapping.

    Geometry and joint names count.
    """
    split = min(
        max((figure.likeness - ZERO_CONFIDENCE_LIKENESS) / (FULL_CONFIDENCE_LIKENESS - ZERO_CONFIDENCE_LIKENESS), 0.0),
        1.0,
    )
    leaning = max(arm.off for arm in figure.arms.values())
    sides = 1.0 if figure.sides.certain else GUESSED_SIDE_FACTOR
    geometry = split * sides * exp(-leaning / LEANING_SCALE) * exp(-figure.asymmetry / ASYMMETRY_SCALE)
    names = exp(-CONTRADICTION_RATE * len(_list_contradictions(figure, hinges)) / max(len(hinges), 1))
    return geometry * names * (DOUBTFUL_LIMB_FACTOR if figure.is_doubtful else 1.0)


def _list_contradictions(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...]) -> list[str]:
    """List the joints with names of another body part than their hinge."""
    unrequested = [hinge for hinge in hinges if hinge.joint not in figure.wishes.hinges]
    joints = [(hinge.name, figure.tree.joints[hinge.joint].name) for hinge in unrequested]
    return [f"{joint} ({hinge})" for hinge, joint in joints if is_contradiction(hinge, joint)]


def _review(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], hands: Hands) -> list[str]:
    assumed = [hinge.name for hinge in hinges if hinge.assumed]
    leaning = degrees(max(arm.off for arm in figure.arms.values()))
    contradictions = _list_contradictions(figure, hinges)
    unmapped = _list_unmapped(figure, hinges, hands)
    absent = "".join(SIDE_NAMES[side] for side in SIDES if side not in figure.arms)
    notes = {
        f"ranges of {', '.join(assumed)} are assumed, as the file gives none": bool(assumed),
        "which side is left is a guess": not figure.sides.certain,
        "pairs of hinges were found by name, as the file's pose is not symmetric": figure.sides.by_names,
        f"arms hang {leaning:.0f} deg off the vertical at best": leaning > 10.0,
        f"the arms differ by {100 * figure.asymmetry:.0f} % of their length": figure.asymmetry > 0.02,
        "palms are assumed to face the thighs": not hands,
        _describe_fingers(hands): bool(hands),
        f"{_describe_fixed_joints(figure, hands)}": len(hands) < len(figure.arms),
        f"held, because no hinge of kinesic fits: {', '.join(unmapped)}": bool(unmapped),
        f"the robot has no {absent} arm: gestures of that hand are performed by the other, or left out": bool(absent),
        f"names contradict the hinges of {', '.join(contradictions)}": bool(contradictions),
        "the arms may be legs: neither names nor geometry decide": figure.is_doubtful,
        "legs are left out, the trunk stands on a fixed base": bool(figure.legs),
        "the base is fixed": not figure.legs,
    }
    uncoupled_notes = [
        f"{name} follows another hinge in its file, and has a motor here"
        for name in _list_uncoupled_hinges(figure, hinges, hands)
    ]
    return [*(text for text, applies in notes.items() if applies), *uncoupled_notes, *figure.tree.left_out]


def _review_servos(sources: dict[str, str]) -> list[str]:
    """Return a review note that counts servos with assumed values, if any."""
    count = sum("assumed" in source for source in sources.values())
    return [f"{count} of {len(sources)} servos have assumed values, named beside them"] if count else []


def _describe_fingers(hands: Hands) -> str:
    """Describe the fingers that were found, for the review notes."""
    finger_names = {side: ", ".join(finger.name for finger in hand.fingers) for side, hand in hands.items()}
    geometry = "; ".join(f"{SIDE_NAMES[side]}: {names}" for side, names in finger_names.items())
    return f"fingers, and where palms look, were found by geometry, straight at zero ({geometry})"


def _describe_fixed_joints(figure: HumanoidGeometry, hands: Hands) -> str:
    """Describe the finger joints held still on arms without a recognised hand."""
    tree = figure.tree
    fixed_joints = [
        tree.joints[k].name
        for side in figure.arms
        if side not in hands
        for k in tree.below(figure.arms[side].joints[-1])
        if k not in figure.arms[side].joints
    ]
    return (
        f"{', '.join(fixed_joints)} are held: a hand needs a thumb and two fingers"
        if fixed_joints
        else "hands have no fingers"
    )


def _list_unmapped(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], hands: Hands) -> list[str]:
    """List the joints of trunk, neck and head that no hinge represents."""
    mapped = {hinge.joint for hinge in hinges} | {k for arm in figure.arms.values() for k in arm.joints}
    mapped |= set(figure.legs)
    hand_joints = {k for arm in figure.arms.values() for k in figure.tree.below(arm.joints[-1])}
    mapped |= (
        hand_joints
        if len(hands) < len(figure.arms)
        else {turn.joint for hand in hands.values() for finger in hand.fingers for turn in finger.turns}
    )
    return [joint.name for k, joint in enumerate(figure.tree.joints) if k not in mapped]


def _list_uncoupled_hinges(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...], hands: Hands) -> list[str]:
    """List the joints whose coupling to another joint is not imported."""
    follows = {name for hand in hands.values() for finger in hand.fingers for name in finger.follows}
    all_turns = [*hinges, *(turn for hand in hands.values() for finger in hand.fingers for turn in finger.turns)]
    joints = figure.tree.joints
    return [joints[turn.joint].name for turn in all_turns if joints[turn.joint].follows and turn.name not in follows]
