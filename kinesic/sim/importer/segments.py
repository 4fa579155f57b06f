"""The segments of a foreign robot: where each begins, what it weighs and what shape it has."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Side
from kinesic.body.robot_schema import BodyTable, CapsuleTable, Triple
from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.hinge_row import common_point
from kinesic.sim.importer.hinges import MappedHinge
from kinesic.sim.importer.model_tree import BASE, ModelPart
from kinesic.sim.importer.zero_pose import HumanoidGeometry

# radius, as a share of the length: of the upper arm, of the forearm, again of the forearm, of the arm
UPPER_GIRTH, FORE_GIRTH, HAND_GIRTH, HEAD_GIRTH = 0.15, 0.14, 0.12, 0.17
HAND_LENGTH = 0.45  # of the forearm
BETWEEN = 0.035  # [m] air between the trunk and a hanging arm
LEAST_GIRTH = 0.01  # [m]
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
        """The name of the segment that carries arms and neck."""
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
    """Names what carries the shoulder: a collar bone that moves, or the motors' housing that does not."""
    return f"{side}_sternoclavicular" if figure.split.girdle else f"{side}_acromioclavicular"


def _centre(rows: list[MappedHinge], near: Floats) -> Floats:
    anchors, axes = (np.array([getattr(hinge, name) for hinge in rows]) for name in ("anchor", "axis"))
    return sealed(common_point(anchors, axes, near))


def bodies(figure: HumanoidGeometry, where: SegmentLayout, hinges: tuple[MappedHinge, ...]) -> list[BodyTable]:
    """Makes the [[body]] tables."""
    carried = carried_parts(figure, where, hinges)
    tables = []
    for name, parent in where.parents.items():
        part = figure.tree.lump(carried.get(name, ())) if carried.get(name) else ModelPart(0.0, where.origins[name], ())
        origin = where.origins[name] - (where.origins[parent] if parent != "world" else np.zeros(3))
        made = own_capsules(part.shapes, where.origins[name]) or _made(figure, where, name, part)
        tables.append(
            BodyTable(
                name=name,
                parent=parent,
                pos=rounded_triple(origin),
                mass=round(part.mass, 4),
                capsules=made,
            )
        )
    return tables


def carried_parts(
    figure: HumanoidGeometry, where: SegmentLayout, hinges: tuple[MappedHinge, ...]
) -> dict[str, list[int]]:
    """Finds the parts of the tree that each segment is made of. Legs are left out.

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


def _made(figure: HumanoidGeometry, where: SegmentLayout, name: str, part: ModelPart) -> list[CapsuleTable]:
    arm = figure.arms["l"].centres
    upper, fore = arm.lengths
    side, _, kind = name.rpartition("_")
    zero = np.zeros(3)
    if kind == "shoulder":
        end = where.origins[f"{side}_elbow"] - where.origins[name]
        return [bone_capsule(zero, end, UPPER_GIRTH * upper, spared=0.2)]
    if kind == "elbow":
        return [bone_capsule(zero, where.origins[f"{side}_wrist"] - where.origins[name], FORE_GIRTH * fore)]
    if kind == "wrist":
        return [
            bone_capsule(zero, hand_vector(figure, where, "l" if side == "l" else "r"), HAND_GIRTH * fore, spared=0.3)
        ]
    if kind in ("acromioclavicular", "sternoclavicular"):
        return [bone_capsule(zero, where.origins[f"{side}_shoulder"] - where.origins[name], UPPER_GIRTH * upper)]
    if name == HEAD:
        centre, radius = part.centre - where.origins[name], HEAD_GIRTH * figure.arm_length
        return [bone_capsule(centre - np.array([0, 0, 0.2 * radius]), centre + np.array([0, 0, 0.2 * radius]), radius)]
    if name == ROOT and where.carrier == TRUNK:
        return [
            bone_capsule(-0.1 * arm.shoulder * [0, 1, 0], 0.1 * arm.shoulder * [0, 1, 0], 0.4 * float(arm.shoulder[1]))
        ]
    return _trunk(figure, where, name)


def _trunk(figure: HumanoidGeometry, where: SegmentLayout, name: str) -> list[CapsuleTable]:
    arm = figure.arms["l"].centres
    shoulders = where.inside(name, np.array([arm.shoulder[0], 0.0, arm.shoulder[2]]))
    made = trunk_capsules(np.zeros(3), shoulders, float(arm.shoulder[1]), UPPER_GIRTH * arm.lengths[0])
    if not figure.neck:
        low, high, radius = (share * figure.arm_length for share in FIXED_HEAD)
        up = np.array([0.0, 0.0, 1.0])
        made.append(bone_capsule(shoulders + low * up, shoulders + high * up, radius))
    return made


def hand_vector(figure: HumanoidGeometry, where: SegmentLayout, side: Side) -> Floats:
    """Finds the vector (3,) [m] from the wrist along the hand, in the last segment."""
    at = figure.arms[side].centres
    return sealed(at.fore * HAND_LENGTH * at.lengths[1])


def bone_capsule(start: Floats, end: Floats, radius: float, *, spared: float = 0.0) -> CapsuleTable:
    """Makes a capsule along a bone that keeps a share of it free at its start."""
    begin = start + spared * (end - start)
    return CapsuleTable(rounded_triple(begin), rounded_triple(end), round(max(radius, LEAST_GIRTH), DIGITS))


def own_capsules(shapes: Sequence[Capsule], origin: Floats) -> list[CapsuleTable]:
    """Moves the model's shapes into the frame of a segment."""
    return [
        CapsuleTable(rounded_triple(s.start - origin), rounded_triple(s.end - origin), round(s.radius, DIGITS))
        for s in shapes
    ]


def trunk_capsules(waist: Floats, shoulders: Floats, half_width: float, arm_radius: float) -> list[CapsuleTable]:
    """Makes chest and belly between the shoulders and the waist.

    Args:
        waist: (3,) [m] in the segment.
        shoulders: (3,) [m] the point between both, in the segment.
        half_width: [m] from the midline to a shoulder.
        arm_radius: [m] of an upper arm.
    """
    reach = max(half_width - arm_radius - BETWEEN, LEAST_GIRTH)
    radius = 0.62 * reach
    side = np.array([0.0, reach - radius, 0.0])
    chest = shoulders - np.array([0.0, 0.0, 0.8 * radius])
    belly = waist + np.array([0.0, 0.0, radius])
    if belly[2] > chest[2] - 0.5 * radius:
        return [bone_capsule(chest - side, chest + side, radius)]
    return [bone_capsule(chest - side, chest + side, radius), bone_capsule(belly, (belly + chest) / 2, 0.9 * radius)]


def rounded_triple(point: Floats) -> Triple:
    """Rounds a place or direction (3,) as a file holds it."""
    x, y, z = (round(float(value), DIGITS) + 0.0 for value in point)
    return x, y, z
