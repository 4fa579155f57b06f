"""Origins, masses and shapes of an imported robot's segments."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Side
from kinesic.body.robot_schema import BodyTable, CapsuleTable, Triple
from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.arm import HAND_LENGTH_RATIO
from kinesic.sim.importer.hinge_row import find_common_point, list_surface_points
from kinesic.sim.importer.hinges import MappedHinge
from kinesic.sim.importer.model_tree import BASE_INDEX, ModelPart
from kinesic.sim.importer.zero_pose import HumanoidGeometry, find_mid_shoulders, first_arm

UPPER_ARM_GIRTH = 0.15  # radius of a generated upper arm / its length
FOREARM_GIRTH = 0.14  # radius of a generated forearm / its length
HAND_GIRTH = 0.12  # radius of a generated hand / length of the forearm
HEAD_RADIUS_RATIO = 0.17  # radius of a generated head / length of the arm
MIN_HAND_RATIO = 0.1  # lower bound of the length of a hand / length of the forearm
MAX_HAND_RATIO = 1.2  # upper bound of the length of a hand / length of the forearm
ARM_TRUNK_GAP = 0.035  # [m] distance between a generated trunk and a hanging arm
MIN_RADIUS = 0.01  # [m] smallest radius of a generated capsule
ROOT_SEGMENT = "humanoid_root"  # name of the root segment in robot files
TRUNK_SEGMENT = "vl5"  # name of the trunk segment in robot files
HEAD_SEGMENT = "skullbase"  # name of the head segment in robot files
FIXED_HEAD = (0.15, 0.45, 0.14)  # [arm lengths] head without hinges: lower and upper end above the shoulders, radius
WAIST_DEPTH = 0.9  # [arm lengths] distance of the waist below the shoulders in a trunk without hinges
MAX_HOUSING_REACH = 0.25  # [upper arms] largest distance of a housing part's mass centre from the shoulder to the elbow
COORDINATE_DIGITS = 6  # decimal digits of coordinates in robot files


@dataclass(frozen=True, eq=False)
class SegmentLayout:
    """Parents and origins of the segments when the arms hang."""

    parents: Mapping[str, str]  # segment -> parent, parents first
    origins: Mapping[str, Floats]  # segment -> (3,) [m] in the world

    @property
    def carrier(self) -> str:
        """Name of the segment that carries arms and neck."""
        return TRUNK_SEGMENT if TRUNK_SEGMENT in self.parents else ROOT_SEGMENT

    def inside(self, segment: str, point: Floats) -> Floats:
        """Convert a point (3,) [m] from the world to a segment's frame."""
        return sealed(point - self.origins[segment])


def lay_out_segments(figure: HumanoidGeometry, hinges: tuple[MappedHinge, ...]) -> SegmentLayout:
    """Name the segments and place their origins at joint centres."""
    shoulders = find_mid_shoulders(figure)
    waist = shoulders - np.array([0.0, 0.0, WAIST_DEPTH * figure.arm_length])
    parents, origins = {ROOT_SEGMENT: "world"}, {ROOT_SEGMENT: sealed(waist)}
    if figure.trunk:
        rows = [hinge for hinge in hinges if hinge.segment == TRUNK_SEGMENT]
        parents[TRUNK_SEGMENT], origins[TRUNK_SEGMENT] = ROOT_SEGMENT, _centre(rows, shoulders)
        origins[ROOT_SEGMENT] = origins[TRUNK_SEGMENT]
    carrier = TRUNK_SEGMENT if figure.trunk else ROOT_SEGMENT
    if figure.neck:
        rows = [hinge for hinge in hinges if hinge.segment == HEAD_SEGMENT]
        parents[HEAD_SEGMENT], origins[HEAD_SEGMENT] = carrier, _centre(rows, rows[-1].anchor)
    for side, arm in figure.arms.items():
        arm_centres = arm.centres
        girdle = housing(figure, side)
        rows = [hinge for hinge in hinges if hinge.segment == girdle]
        parents[girdle] = carrier
        origins[girdle] = _centre(rows, rows[-1].anchor) if rows else arm_centres.shoulder
        centres = {"shoulder": arm_centres.shoulder, "elbow": arm_centres.elbow, "wrist": arm_centres.wrist}
        for part, parent_name in zip(centres, (girdle, f"{side}_shoulder", f"{side}_elbow"), strict=True):
            parents[f"{side}_{part}"], origins[f"{side}_{part}"] = parent_name, centres[part]
    return SegmentLayout(parents, origins)


def housing(figure: HumanoidGeometry, side: Side) -> str:
    """Return the name of the segment that carries the shoulder.

    This is a moving collar bone or a fixed housing of the motors.
    """
    return f"{side}_sternoclavicular" if figure.split.girdle else f"{side}_acromioclavicular"


def _centre(rows: list[MappedHinge], near: Floats) -> Floats:
    anchors, axes = (np.array([getattr(hinge, name) for hinge in rows]) for name in ("anchor", "axis"))
    return sealed(find_common_point(anchors, axes, near))


def bodies(figure: HumanoidGeometry, layout: SegmentLayout, hinges: tuple[MappedHinge, ...]) -> list[BodyTable]:
    """Create the [[body]] tables of all segments except fingers."""
    carried = assign_parts(figure, layout, hinges)
    tables = []
    for name, parent in layout.parents.items():
        part = (
            figure.tree.merge_parts(carried.get(name, ()))
            if carried.get(name)
            else ModelPart(0.0, layout.origins[name], ())
        )
        origin = layout.origins[name] - (layout.origins[parent] if parent != "world" else np.zeros(3))
        capsules = convert_capsules(part.shapes, layout.origins[name]) or _generate_capsules(figure, layout, name, part)
        tables.append(
            BodyTable(
                name=name,
                parent=parent,
                pos=round_triple(origin),
                mass=round(part.mass, 4),
                capsules=capsules,
            )
        )
    return tables


def assign_parts(
    figure: HumanoidGeometry, layout: SegmentLayout, hinges: tuple[MappedHinge, ...]
) -> dict[str, list[int]]:
    """Return the indices of the tree's parts that each segment contains.

    Legs are left out. Parts between the first and last shoulder hinges belong to the shoulder's housing, unless they
    lie along the upper arm.
    """
    tree = figure.tree
    carried: dict[str, list[int]] = {name: [] for name in layout.parents}
    carried[ROOT_SEGMENT].append(BASE_INDEX)
    owner = {hinge.joint: hinge.segment for hinge in hinges}
    for side, arm in figure.arms.items():
        shoulder = arm.joints[figure.split.girdle : figure.split.elbow]
        housed = [joint for joint in shoulder[:-1] if not _lies_along_upper_arm(figure, side, joint)]
        owner |= dict.fromkeys(housed, housing(figure, side))
    for k in range(len(tree.joints)):
        carriers = [owner[j] for j in tree.path_from_base(k) if j in owner]
        if carriers:
            carried[carriers[-1]].append(k)
    return carried


def _lies_along_upper_arm(figure: HumanoidGeometry, side: Side, joint: int) -> bool:
    """Return whether a shoulder joint's part lies along the upper arm."""
    centres = figure.arms[side].centres
    upper = centres.elbow - centres.shoulder
    offset = figure.tree.merge_parts([joint]).centre - centres.shoulder
    return float(offset @ upper) > MAX_HOUSING_REACH * float(upper @ upper)


def _generate_capsules(
    figure: HumanoidGeometry, layout: SegmentLayout, name: str, part: ModelPart
) -> list[CapsuleTable]:
    arm = first_arm(figure).centres
    (upper, fore), half_width = arm.lengths, abs(float(arm.shoulder[1]))
    side, _, kind = name.rpartition("_")
    zero = np.zeros(3)
    if kind == "shoulder":
        end = layout.origins[f"{side}_elbow"] - layout.origins[name]
        return [make_bone_capsule(zero, end, UPPER_ARM_GIRTH * upper, free_fraction=0.2)]
    if kind == "elbow":
        return [make_bone_capsule(zero, layout.origins[f"{side}_wrist"] - layout.origins[name], FOREARM_GIRTH * fore)]
    if kind == "wrist":
        return [
            make_bone_capsule(
                zero,
                compute_hand_vector(figure, layout, "l" if side == "l" else "r"),
                HAND_GIRTH * fore,
                free_fraction=0.3,
            )
        ]
    if kind in ("acromioclavicular", "sternoclavicular"):
        return [
            make_bone_capsule(zero, layout.origins[f"{side}_shoulder"] - layout.origins[name], UPPER_ARM_GIRTH * upper)
        ]
    if name == HEAD_SEGMENT:
        centre, radius = part.centre - layout.origins[name], HEAD_RADIUS_RATIO * figure.arm_length
        return [
            make_bone_capsule(centre - np.array([0, 0, 0.2 * radius]), centre + np.array([0, 0, 0.2 * radius]), radius)
        ]
    if name == ROOT_SEGMENT and layout.carrier == TRUNK_SEGMENT:
        return [
            make_bone_capsule(
                np.array([0.0, -0.1 * half_width, 0.0]),
                np.array([0.0, 0.1 * half_width, 0.0]),
                0.4 * half_width,
            )
        ]
    return _trunk(figure, layout, name)


def _trunk(figure: HumanoidGeometry, layout: SegmentLayout, name: str) -> list[CapsuleTable]:
    arm = first_arm(figure).centres
    shoulders = layout.inside(name, find_mid_shoulders(figure))
    half_width, girth = abs(float(arm.shoulder[1])), UPPER_ARM_GIRTH * arm.lengths[0]
    capsules = make_trunk_capsules(np.zeros(3), shoulders, half_width, girth)
    if not figure.neck:
        low, high, radius = (ratio * figure.arm_length for ratio in FIXED_HEAD)
        up = np.array([0.0, 0.0, 1.0])
        capsules.append(make_bone_capsule(shoulders + low * up, shoulders + high * up, radius))
    return capsules


def compute_hand_vector(figure: HumanoidGeometry, layout: SegmentLayout, side: Side) -> Floats:
    """Return the vector (3,) [m] from the wrist along the hand.

    Its length is that of the file's hand, or that of a human's hand if the file has no shapes for it.
    """
    arm, tree = figure.arms[side], figure.tree
    fore = arm.centres.lengths[1]
    points = list_surface_points(tree.merge_parts(tree.below(arm.joints[-1])))
    if not len(points):
        return sealed(arm.centres.fore * HAND_LENGTH_RATIO * fore)
    length = float(((points - arm.centres.wrist) @ arm.centres.fore).max())
    return sealed(arm.centres.fore * min(max(length, MIN_HAND_RATIO * fore), MAX_HAND_RATIO * fore))


def make_bone_capsule(start: Floats, end: Floats, radius: float, *, free_fraction: float = 0.0) -> CapsuleTable:
    """Return a capsule along a bone.

    A fraction of the bone is left free at its start.
    """
    begin = start + free_fraction * (end - start)
    return CapsuleTable(round_triple(begin), round_triple(end), round(max(radius, MIN_RADIUS), COORDINATE_DIGITS))


def convert_capsules(shapes: Sequence[Capsule], origin: Floats) -> list[CapsuleTable]:
    """Convert capsules from the world to tables in a segment's frame."""
    return [
        CapsuleTable(round_triple(s.start - origin), round_triple(s.end - origin), round(s.radius, COORDINATE_DIGITS))
        for s in shapes
    ]


def make_trunk_capsules(waist: Floats, shoulders: Floats, half_width: float, arm_radius: float) -> list[CapsuleTable]:
    """Create chest and belly capsules between the shoulders and the waist.

    A short trunk has no belly.

    Args:
        waist: (3,) [m] in the segment.
        shoulders: (3,) [m] midpoint of both shoulders, in the segment.
        half_width: [m] from the midline to a shoulder.
        arm_radius: [m] radius of an upper arm.
    """
    reach = max(half_width - arm_radius - ARM_TRUNK_GAP, MIN_RADIUS)
    radius = 0.62 * reach
    side = np.array([0.0, reach - radius, 0.0])
    chest = shoulders - np.array([0.0, 0.0, 0.8 * radius])
    belly = waist + np.array([0.0, 0.0, radius])
    if belly[2] > chest[2] - 0.5 * radius:
        return [make_bone_capsule(chest - side, chest + side, radius)]
    return [
        make_bone_capsule(chest - side, chest + side, radius),
        make_bone_capsule(belly, (belly + chest) / 2, 0.9 * radius),
    ]


def round_triple(point: Floats) -> Triple:
    """Round a point or direction (3,) to a robot file's precision."""
    x, y, z = (round(float(value), COORDINATE_DIGITS) + 0.0 for value in point)
    return x, y, z
