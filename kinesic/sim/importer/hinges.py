"""Hinges with MPEG-4 BAP names: named, signed and measured by their axes in the hanging figure."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import degrees, pi, radians

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Side
from kinesic.sim.importer.arm import LENGTHWISE
from kinesic.sim.importer.hanging_pose import elbow_sense
from kinesic.sim.importer.zero_pose import ACROSS, HumanoidGeometry

KINDS = ("roll", "tilt", "torsion")  # of trunk and head, by the axis x, y, z that is nearest
VERTEBRAE = {"vl5": ("vl5", "vt10", "vt6", "vt1"), "skullbase": ("skullbase", "vc4", "vc7", "vc2")}
WHOLE_TURN = radians(350)  # a wider range is none

# Of a hinge without range in its file, after human anatomy [deg].
ANATOMY = {
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
_POSITIVE = {"elbow_flexion": (-1, -1, 1), "wrist_flexion": (-1, 0, 0), "wrist_pivot": (0, 1, 0)}  # of left hinges
_ASIDE = (1, -1, 1)  # of the others


@dataclass(frozen=True, eq=False)
class MappedHinge:
    """A hinge of the foreign robot as kinesic's."""

    name: str
    segment: str
    joint: int  # of the tree
    sign: float  # of the foreign angle against kinesic's
    zero: float  # [rad] foreign angle where kinesic's is zero
    anchor: Floats  # (3,) [m] in the world, hanging
    axis: Floats  # (3,) unit, in the world, hanging
    lower: float  # [rad]
    upper: float  # [rad]
    assumed: bool  # the range is not the file's


def named_hinges(figure: HumanoidGeometry) -> tuple[MappedHinge, ...]:
    """Names all hinges that kinesic moves, trunk and neck first."""
    found = [*_spine(figure, "vl5", figure.trunk), *_spine(figure, "skullbase", figure.neck)]
    for side in SIDES:
        found += _arm(figure, side)
    return tuple(found)


def _spine(figure: HumanoidGeometry, segment: str, joints: Sequence[int]) -> Iterator[MappedHinge]:
    used: set[str] = set()
    for k in joints:
        axis = figure.tree.joints[k].axis
        lateral = int(np.argmax(np.abs(axis)))
        names = [f"{vertebra}_{KINDS[lateral]}" for vertebra in VERTEBRAE[segment]]
        name = next(name for name in names if name not in used)
        used.add(name)
        yield _named(figure, k, name, segment, float(np.sign(axis[lateral])))


def _arm(figure: HumanoidGeometry, side: Side) -> Iterator[MappedHinge]:
    arm, split = figure.arms[side], figure.split
    axes = dict(zip(arm.joints, arm.limb.axes, strict=True))
    rows = {
        "sternoclavicular": arm.joints[: split.girdle],
        "shoulder": arm.joints[split.girdle : split.elbow],
        "elbow": arm.joints[split.elbow : split.elbow + 1],
        "wrist": arm.joints[split.elbow + 1 :],
    }
    if split.wrist and abs(axes[rows["wrist"][0]] @ arm.centres.fore) > LENGTHWISE:
        rows["elbow"], rows["wrist"] = (*rows["elbow"], rows["wrist"][0]), rows["wrist"][1:]
    along = {
        "sternoclavicular": arm.centres.upper,
        "shoulder": arm.centres.upper,
        "elbow": arm.centres.fore,
        "wrist": arm.centres.fore,
    }
    for part, row in rows.items():
        turns = _turns(part, [axes[k] for k in row], along[part])
        for k, turn in zip(row, turns, strict=True):
            sign = _sense(figure, side, k) if turn == "flexion" and part == "elbow" else 0.0
            sign = sign or _sign(f"{part}_{turn}", axes[k], side)
            yield _named(figure, k, f"{side}_{part}_{turn}", f"{side}_{part}", sign)


def _turns(part: str, axes: list[Floats], along: Floats) -> list[str]:
    """The last words of the names of one part's hinges, each once."""
    if part == "sternoclavicular":
        return _distinct(["abduct" if abs(x[0]) >= abs(x[2]) else "rotate" for x in axes])
    if part == "elbow":
        return ["flexion", "twisting"][: len(axes)]
    lengthwise = [abs(float(x @ along)) for x in axes]
    twist = max((k for k, share in enumerate(lengthwise) if share > LENGTHWISE), default=-1)
    rest = [k for k in range(len(axes)) if k != twist]
    main = 1 if part == "shoulder" else 0  # the flexion's axis: y of a shoulder, x of a wrist
    flexion = max(rest, key=lambda k: abs(axes[k][main]), default=-1)
    other = "abduct" if part == "shoulder" else "pivot"
    return _distinct(["twisting" if k == twist else "flexion" if k == flexion else other for k in range(len(axes))])


def _distinct(names: list[str]) -> list[str]:
    return [name if name not in names[:k] else f"{name}{names[:k].count(name) + 1}" for k, name in enumerate(names)]


def _sense(figure: HumanoidGeometry, side: Side, joint: int) -> float:
    """The sign in which an elbow bends, by its range."""
    elbow = figure.tree.joints[joint]
    lower = -np.inf if elbow.lower is None else elbow.lower - elbow.zero
    upper = np.inf if elbow.upper is None else elbow.upper - elbow.zero
    return elbow_sense(figure.arms[side].limb, figure.split, lower, upper)


def _sign(name: str, axis: Floats, side: Side) -> float:
    """+1 when the axis already points as kinesic's does."""
    mirror = np.ones(3) if side == "l" else -ACROSS
    key = name if name in _POSITIVE else name.rpartition("_")[2]
    lateral = int(np.argmax(np.abs(axis)))
    wanted = np.array(_POSITIVE.get(key, _ASIDE), dtype=float) * mirror
    if not wanted[lateral]:
        wanted = np.array(_ASIDE) * mirror
    return float(np.sign(axis[lateral] * wanted[lateral]))


def _named(figure: HumanoidGeometry, joint: int, name: str, segment: str, sign: float) -> MappedHinge:
    foreign = figure.tree.joints[joint]
    lower, upper, assumed, zero = *_default(name), True, foreign.zero
    if foreign.lower is not None and foreign.upper is not None and foreign.upper - foreign.lower < WHOLE_TURN:
        turns = np.round(((foreign.lower + foreign.upper) / 2 - zero) / (2 * pi))
        zero += 2 * pi * turns
        ends = sorted((sign * (foreign.lower - zero), sign * (foreign.upper - zero)))
        lower, upper, assumed = max(ends[0], -pi), min(ends[1], pi), False
    return MappedHinge(
        name, segment, joint, sign, zero, foreign.anchor, sealed(sign * foreign.axis), lower, upper, assumed
    )


def _default(name: str) -> tuple[float, float]:
    """[rad] of a hinge whose range nobody tells."""
    low, high = next(ANATOMY[key] for key in sorted(ANATOMY, key=len, reverse=True) if key in name)
    return radians(low), radians(high)


def spell_angle(hinge: MappedHinge, joint: str) -> str:
    """Spells how the foreign robot's angle follows from kinesic's."""
    return f"{joint} = {'' if hinge.sign > 0 else '-'}angle {degrees(hinge.zero):+.4f} deg"
