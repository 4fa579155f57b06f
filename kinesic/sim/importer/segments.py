"""The segments of a foreign robot: where each begins, what it weighs and what shape it has."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Side
from kinesic.body.robot_schema import BodyTable, CapsuleTable
from kinesic.sim.importer import shapes
from kinesic.sim.importer.hinge_row import common_point
from kinesic.sim.importer.hinges import MappedHinge
from kinesic.sim.importer.model_tree import BASE, Part
from kinesic.sim.importer.zero_pose import HumanoidGeometry

ROOT, TRUNK, HEAD = "humanoid_root", "vl5", "skullbase"
FIXED_HEAD = (0.15, 0.45, 0.14)  # arm lengths above the shoulders from and to, and radius, of a head without neck
WAIST = 0.9  # arm lengths below the shoulders where the trunk has no hinge
DIGITS = 6


@dataclass(frozen=True, eq=False)
class SegmentLayout:
    """Segments and where they begin when the arms hang."""

    parents: Mapping[str, str]  # segment -> parent, parents first
    origins: Mapping[str, Floats]  # segment -> (3,) [m] in the world

    @property
    def carrier(self) -> str:
        """What carries arms and neck."""
        return TRUNK if TRUNK in self.parents else ROOT

    def inside(self, segment: str, point: Floats) -> Floats:
        """(3,) [m] of a point of the world in a segment."""
        return sealed(point - self.origins[segment])


def lay_out_segments(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...]) -> SegmentLayout:
    """Names the segments and places their origins at the centres of their hinges."""
    left = figure.arms["l"].centres.shoulder
    shoulders = np.array([left[0], 0.0, left[2]])
    waist = shoulders - np.array([0.0, 0.0, WAIST * figure.arm_length])
    parents, origins = {ROOT: "world"}, {ROOT: sealed(waist)}
    if figure.trunk:
        rows = [hinge for hinge in hinges if hinge.segment == TRUNK]
        parents[TRUNK], origins[TRUNK] = ROOT, _centre(rows, shoulders)
        origins[ROOT] = origins[TRUNK]
    carrier = TRUNK if figure.trunk else ROOT
    if figure.neck:
        rows = [hinge for hinge in hinges if hinge.segment == HEAD]
        parents[HEAD], origins[HEAD] = carrier, _centre(rows, rows[-1].anchor)
    for side in SIDES:
        at = figure.arms[side].centres
        girdle = housing(figure, side)
        rows = [hinge for hinge in hinges if hinge.segment == girdle]
        parents[girdle] = carrier
        origins[girdle] = _centre(rows, rows[-1].anchor) if rows else at.shoulder
        centres = {"shoulder": at.shoulder, "elbow": at.elbow, "wrist": at.wrist}
        for part, before in zip(centres, (girdle, f"{side}_shoulder", f"{side}_elbow"), strict=True):
            parents[f"{side}_{part}"], origins[f"{side}_{part}"] = before, centres[part]
    return SegmentLayout(parents, origins)


def housing(figure: HumanoidGeometry, side: Side) -> str:
    """What carries the shoulder: a collar bone that moves, or the motors' housing that does not."""
    return f"{side}_sternoclavicular" if figure.split.girdle else f"{side}_acromioclavicular"


def _centre(rows: list[MappedHinge], near: Floats) -> Floats:
    anchors, axes = (np.array([getattr(hinge, name) for hinge in rows]) for name in ("anchor", "axis"))
    return sealed(common_point(anchors, axes, near))


def bodies(figure: HumanoidGeometry, where: SegmentLayout, hinges: tuple[MappedHinge, ...]) -> list[BodyTable]:
    """The [[body]] tables."""
    carried = _carried(figure, where, hinges)
    tables = []
    for name, parent in where.parents.items():
        part = figure.tree.lump(carried.get(name, ())) if carried.get(name) else Part(0.0, where.origins[name], ())
        origin = where.origins[name] - (where.origins[parent] if parent != "world" else np.zeros(3))
        made = shapes.own(part.shapes, where.origins[name]) or _made(figure, where, name, part)
        tables.append(
            BodyTable(
                name=name,
                parent=parent,
                pos=_triple(origin),
                mass=round(part.mass, 4),
                capsules=made,
            )
        )
    return tables


def _carried(figure: HumanoidGeometry, where: SegmentLayout, hinges: tuple[MappedHinge, ...]) -> dict[str, list[int]]:
    """Segment -> the parts of the tree that it is made of. Legs are left out.

    What a shoulder hinge moves before the last one sits at the shoulder: it counts as the shoulder's housing.
    """
    tree = figure.tree
    found: dict[str, list[int]] = {name: [] for name in where.parents}
    found[ROOT].append(BASE)
    owner = {hinge.joint: hinge.segment for hinge in hinges}
    for side in SIDES:
        shoulder = figure.arms[side].joints[figure.split.girdle : figure.split.elbow]
        owner |= dict.fromkeys(shoulder[:-1], housing(figure, side))
    for k in range(len(tree.joints)):
        carriers = [owner[j] for j in tree.way(k) if j in owner]
        if carriers:
            found[carriers[-1]].append(k)
    return found


def _made(figure: HumanoidGeometry, where: SegmentLayout, name: str, part: Part) -> list[CapsuleTable]:
    """Capsules by proportion."""
    arm = figure.arms["l"].centres
    upper, fore = arm.lengths
    side, _, kind = name.rpartition("_")
    zero = np.zeros(3)
    if kind == "shoulder":
        end = where.origins[f"{side}_elbow"] - where.origins[name]
        return [shapes.bone(zero, end, shapes.UPPER * upper, spared=0.2)]
    if kind == "elbow":
        return [shapes.bone(zero, where.origins[f"{side}_wrist"] - where.origins[name], shapes.FORE * fore)]
    if kind == "wrist":
        return [
            shapes.bone(zero, hand_vector(figure, where, "l" if side == "l" else "r"), shapes.HAND * fore, spared=0.3)
        ]
    if kind in ("acromioclavicular", "sternoclavicular"):
        return [shapes.bone(zero, where.origins[f"{side}_shoulder"] - where.origins[name], shapes.UPPER * upper)]
    if name == HEAD:
        centre, radius = part.centre - where.origins[name], shapes.HEAD * figure.arm_length
        return [shapes.bone(centre - np.array([0, 0, 0.2 * radius]), centre + np.array([0, 0, 0.2 * radius]), radius)]
    if name == ROOT and where.carrier == TRUNK:
        return [
            shapes.bone(-0.1 * arm.shoulder * [0, 1, 0], 0.1 * arm.shoulder * [0, 1, 0], 0.4 * float(arm.shoulder[1]))
        ]
    return _trunk(figure, where, name)


def _trunk(figure: HumanoidGeometry, where: SegmentLayout, name: str) -> list[CapsuleTable]:
    arm = figure.arms["l"].centres
    shoulders = where.inside(name, np.array([arm.shoulder[0], 0.0, arm.shoulder[2]]))
    made = shapes.trunk(np.zeros(3), shoulders, float(arm.shoulder[1]), shapes.UPPER * arm.lengths[0])
    if not figure.neck:
        low, high, radius = (share * figure.arm_length for share in FIXED_HEAD)
        up = np.array([0.0, 0.0, 1.0])
        made.append(shapes.bone(shoulders + low * up, shoulders + high * up, radius))
    return made


def hand_vector(figure: HumanoidGeometry, where: SegmentLayout, side: Side) -> Floats:
    """(3,) [m] from the wrist along the hand, in the last segment."""
    at = figure.arms[side].centres
    return sealed(at.fore * shapes.HAND_LENGTH * at.lengths[1])


def _triple(point: Floats) -> tuple[float, float, float]:
    x, y, z = (round(float(value), DIGITS) + 0.0 for value in point)
    return x, y, z
