"""MPEG-4 BAP names, signs and ranges of an imported robot's hinges.

They follow from the axes in the hanging pose.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import degrees, pi, radians

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.robot import Side
from kinesic.body.robot_schema import SourceTable
from kinesic.sim.importer.arm import MIN_TWIST_COSINE
from kinesic.sim.importer.hanging_pose import find_elbow_sense
from kinesic.sim.importer.hinge_names import SPINE_TURNS, VERTEBRA_NAMES, VERTEBRAE_UPWARDS, find_segment
from kinesic.sim.importer.zero_pose import MIRROR_SIGNS, HumanoidGeometry

ZERO_DIGITS = 6  # decimal digits of joint zeros [deg] in robot files
MAX_USEFUL_RANGE = radians(350)  # [rad] widest joint range that is used; a default replaces wider ranges

# Default ranges [deg] of hinges without a range in their file, after human anatomy.
ANATOMICAL_RANGES = {
    "torsion": (-60.0, 60.0),
    "tilt": (-20.0, 35.0),
    "roll": (-25.0, 25.0),
    "sternoclavicular_abduct": (-10.0, 25.0),
    "sternoclavicular_rotate": (-20.0, 20.0),
    "sternoclavicular_twisting": (-20.0, 20.0),
    "shoulder_flexion": (-60.0, 170.0),
    "shoulder_abduct": (-20.0, 120.0),
    "shoulder_twisting": (-90.0, 90.0),
    "elbow_flexion": (0.0, 135.0),
    "elbow_twisting": (-90.0, 90.0),
    "wrist_flexion": (-60.0, 60.0),
    "wrist_pivot": (-30.0, 30.0),
    "wrist_twisting": (-90.0, 90.0),
}
# Signs of the components x, y, z of a left hinge's positive axis, by name suffix. The largest component decides; 0
# means the sign of _DEFAULT_POSITIVE_AXES. Right hinges are mirrored.
_POSITIVE_AXES = {"elbow_flexion": (-1, -1, 1), "wrist_flexion": (-1, 0, 0), "wrist_pivot": (0, 1, 0)}
_DEFAULT_POSITIVE_AXES = (1, -1, 1)  # signs of the positive axis of all hinges not listed in _POSITIVE_AXES


@dataclass(frozen=True, eq=False)
class MappedHinge:
    """Imported hinge with its name and conversion to kinesic's angle."""

    name: str
    segment: str
    joint: int  # index in the tree
    sign: float  # sign of the file's angle relative to kinesic's
    zero: float  # [rad] the file's angle where kinesic's is zero
    anchor: Floats  # (3,) [m] point on the axis in the world, with hanging arms
    axis: Floats  # (3,) unit vector in the world, with hanging arms
    lower: float  # [rad] lower limit
    upper: float  # [rad] upper limit
    assumed: bool  # whether the range is a default, as the file gives none


def name_hinges(figure: HumanoidGeometry) -> tuple[MappedHinge, ...]:
    """Return names, signs and ranges of all mapped hinges except fingers.

    Trunk and neck come first.
    """
    mapped = [*_spine(figure, "vl5", figure.trunk), *_spine(figure, "skullbase", figure.neck)]
    for side in figure.arms:
        mapped += _arm(figure, side)
    return _rename_hinges(figure, mapped) if figure.wishes.hinges else tuple(mapped)


def _rename_hinges(figure: HumanoidGeometry, mapped: Sequence[MappedHinge]) -> tuple[MappedHinge, ...]:
    """Exchange names within a segment until hinges have the requested names.

    Raises:
        ConfigError: a joint belongs to another segment than the requested hinge.
    """
    names, segments = ({hinge.joint: getattr(hinge, key) for hinge in mapped} for key in ("name", "segment"))
    for joint, wanted in figure.wishes.hinges.items():
        if segments.get(joint) != find_segment(wanted):
            place = f"moves {segments[joint]}" if joint in segments else "is on no path to the head or a hand"
            raise ConfigError(f"--map {figure.tree.joints[joint].name}={wanted}: this joint {place}")
        for other in [k for k, name in names.items() if name == wanted]:
            names[other] = names[joint]
        names[joint] = wanted
    return tuple(
        hinge if names[hinge.joint] == hinge.name else _name_again(figure, hinge, names[hinge.joint])
        for hinge in mapped
    )


def _name_again(figure: HumanoidGeometry, hinge: MappedHinge, name: str) -> MappedHinge:
    axis = figure.tree.joints[hinge.joint].axis
    if name[:2] not in ("l_", "r_"):
        return _map_hinge(figure, hinge.joint, name, hinge.segment, float(np.sign(axis[int(np.argmax(np.abs(axis)))])))
    side: Side = "l" if name.startswith("l_") else "r"
    sign = _find_elbow_sign(figure, side, hinge.joint) if name.endswith("elbow_flexion") else 0.0
    sign = sign or _find_axis_sign(name[2:], axis, side)
    return _map_hinge(figure, hinge.joint, name, hinge.segment, sign)


def _spine(figure: HumanoidGeometry, segment: str, joints: Sequence[int]) -> Iterator[MappedHinge]:
    """Name the hinges of trunk or neck.

    Hinges about one axis get vertebrae from the lowest up.
    """
    axes = [figure.tree.joints[k].axis for k in joints]
    laterals = [int(np.argmax(np.abs(axis))) for axis in axes]
    names = {
        lateral: iter(sorted(VERTEBRA_NAMES[segment][: laterals.count(lateral)], key=VERTEBRAE_UPWARDS.index))
        for lateral in laterals
    }
    for k, axis, lateral in zip(joints, axes, laterals, strict=True):
        name = f"{next(names[lateral])}_{SPINE_TURNS[lateral]}"
        yield _map_hinge(figure, k, name, segment, float(np.sign(axis[lateral])))


def _arm(figure: HumanoidGeometry, side: Side) -> Iterator[MappedHinge]:
    arm, split = figure.arms[side], figure.split
    axes = dict(zip(arm.joints, arm.limb.axes, strict=True))
    rows = {
        "sternoclavicular": arm.joints[: split.girdle],
        "shoulder": arm.joints[split.girdle : split.elbow],
        "elbow": arm.joints[split.elbow : split.elbow + 1],
        "wrist": arm.joints[split.elbow + 1 :],
    }
    if split.wrist and abs(axes[rows["wrist"][0]] @ arm.centres.fore) > MIN_TWIST_COSINE:
        rows["elbow"], rows["wrist"] = (*rows["elbow"], rows["wrist"][0]), rows["wrist"][1:]
    along = {
        "sternoclavicular": arm.centres.upper,
        "shoulder": arm.centres.upper,
        "elbow": arm.centres.fore,
        "wrist": arm.centres.fore,
    }
    for part, row in rows.items():
        turns = _choose_suffixes(part, [axes[k] for k in row], along[part])
        for k, turn in zip(row, turns, strict=True):
            sign = _find_elbow_sign(figure, side, k) if turn == "flexion" and part == "elbow" else 0.0
            sign = sign or _find_axis_sign(f"{part}_{turn}", axes[k], side)
            yield _map_hinge(figure, k, f"{side}_{part}_{turn}", f"{side}_{part}", sign)


def _choose_suffixes(part: str, axes: list[Floats], along: Floats) -> list[str]:
    """Return distinct name suffixes for the hinges of a body part."""
    if part == "sternoclavicular":
        return _make_distinct(["abduct" if abs(x[0]) >= abs(x[2]) else "rotate" for x in axes])
    if part == "elbow":
        return ["flexion", "twisting"][: len(axes)]
    lengthwise = [abs(float(x @ along)) for x in axes]
    twist = max((k for k, cosine in enumerate(lengthwise) if cosine > MIN_TWIST_COSINE), default=-1)
    other_hinges = [k for k in range(len(axes)) if k != twist]
    flexion_axis = 1 if part == "shoulder" else 0  # index of the flexion's axis: y for a shoulder, x for a wrist
    flexion = max(other_hinges, key=lambda k: abs(axes[k][flexion_axis]), default=-1)
    other = "abduct" if part == "shoulder" else "pivot"
    return _make_distinct(
        ["twisting" if k == twist else "flexion" if k == flexion else other for k in range(len(axes))]
    )


def _make_distinct(names: list[str]) -> list[str]:
    return [name if name not in names[:k] else f"{name}{names[:k].count(name) + 1}" for k, name in enumerate(names)]


def _find_elbow_sign(figure: HumanoidGeometry, side: Side, joint: int) -> float:
    """Return the sign of angles that bend an elbow, 0 if unknown."""
    elbow = figure.tree.joints[joint]
    lower = -np.inf if elbow.lower is None else elbow.lower - elbow.zero
    upper = np.inf if elbow.upper is None else elbow.upper - elbow.zero
    return find_elbow_sense(figure.arms[side].limb, figure.split, lower, upper)


def _find_axis_sign(name: str, axis: Floats, side: Side) -> float:
    """Return +1 for an axis along kinesic's positive hinge axis, otherwise -1."""
    mirror = np.ones(3) if side == "l" else -MIRROR_SIGNS
    key = name if name in _POSITIVE_AXES else name.rpartition("_")[2]
    lateral = int(np.argmax(np.abs(axis)))
    positive_axis = np.array(_POSITIVE_AXES.get(key, _DEFAULT_POSITIVE_AXES), dtype=float) * mirror
    if not positive_axis[lateral]:
        positive_axis = np.array(_DEFAULT_POSITIVE_AXES) * mirror
    return float(np.sign(axis[lateral] * positive_axis[lateral]))


def _map_hinge(figure: HumanoidGeometry, joint: int, name: str, segment: str, sign: float) -> MappedHinge:
    foreign = figure.tree.joints[joint]
    lower, upper, assumed, zero = *_find_default_range(name), True, foreign.zero
    if foreign.lower is not None and foreign.upper is not None and foreign.upper - foreign.lower < MAX_USEFUL_RANGE:
        turns = np.round(((foreign.lower + foreign.upper) / 2 - zero) / (2 * pi))
        zero += 2 * pi * turns
        ends = sorted((sign * (foreign.lower - zero), sign * (foreign.upper - zero)))
        lower, upper, assumed = max(ends[0], -pi), min(ends[1], pi), False
    return MappedHinge(
        name, segment, joint, sign, zero, foreign.anchor, sealed(sign * foreign.axis), lower, upper, assumed
    )


def _find_default_range(name: str) -> tuple[float, float]:
    """Return a hinge's default range [rad], for files that give none."""
    lower_deg, upper_deg = next(
        ANATOMICAL_RANGES[key] for key in sorted(ANATOMICAL_RANGES, key=len, reverse=True) if key in name
    )
    return radians(lower_deg), radians(upper_deg)


def describe_source(hinge: MappedHinge, joint: str) -> SourceTable:
    """Return the robot file's entry for an imported joint's sign and zero."""
    return SourceTable(joint, 1 if hinge.sign > 0 else -1, round(degrees(hinge.zero), ZERO_DIGITS) + 0.0)


def spell_angle(hinge: MappedHinge, joint: str) -> str:
    """Return the file's joint angle as a formula of kinesic's angle."""
    return f"{joint} = {'' if hinge.sign > 0 else '-'}angle {degrees(hinge.zero):+.4f} deg"
