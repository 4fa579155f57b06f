"""Reader of Acclaim skeletons (.asf) and motions (.amc)."""

from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats, sealed
from kinesic.capture.reading.text import (
    MAX_FRAMES,
    MAX_JOINTS,
    CaptureError,
    check_times,
    parse_numbers,
    split_lines,
)
from kinesic.capture.skeleton_motion import ROTATION_CHANNEL, CapturedJoint, CapturedMotion

FRAME_RATE = 120.0  # [Hz] assumed frame rate, as .amc files do not state one
ROOT_JOINT = "root"  # name of the first joint in both files
NO_TURN = sealed(np.zeros(3))  # (3,) [rad] rotation of a joint in the zero pose, or zero offset
ROTATION_AXES: Mapping[str, str] = {"rx": "x", "ry": "y", "rz": "z"}  # rotation axis by degree of freedom
TRANSLATION_CHANNELS: Mapping[str, str] = {"tx": "XPos", "ty": "YPos", "tz": "ZPos"}  # channel by degree of freedom
LENGTH_FREEDOM = "l"  # degree of freedom that stretches a bone; ignored
BONE_NUMBERS: Mapping[str, int] = {"direction": 3, "length": 1, "axis": 3}  # count of numbers after a bone's keyword


@dataclass
class _Bone:
    """Bone of a skeleton: axes, far end and degrees of freedom."""

    direction: Floats = field(default_factory=lambda: NO_TURN)
    length: float = 0.0  # length of the bone in the file's unit
    axes: Floats = field(default_factory=lambda: NO_TURN)  # (3,) rotation angles of the bone's axes about x, y and z
    order: str = "xyz"  # order of the axes' rotations, the first applied first
    freedoms: tuple[str, ...] = ()  # degrees of freedom, in the order of the motion's numbers

    @property
    def end(self) -> Floats:
        """Place of the far end (3,) relative to the near end."""
        end: Floats = self.direction * self.length
        return end


@dataclass(frozen=True, eq=False)
class AcclaimSkeleton:
    """Acclaim skeleton: joints, with axes and degrees of freedom of the bones."""

    joints: tuple[CapturedJoint, ...]
    axes: Mapping[str, Rotation]  # rotation from the bone's axes to the skeleton's axes
    freedoms: Mapping[str, tuple[str, ...]]  # degrees of freedom in the order of the motion's numbers


def read_acclaim_skeleton(data: bytes, source: str) -> AcclaimSkeleton:
    """Read an Acclaim skeleton (.asf), parents first.

    Raises:
        CaptureError: the data is not such a skeleton.
    """
    lines = [(number, line.split("#")[0].split()) for number, line in enumerate(split_lines(data, source), start=1)]
    bones: dict[str, _Bone] = {ROOT_JOINT: _Bone()}
    parents: dict[str, str] = {}
    in_degrees, section, name = True, "", ROOT_JOINT
    for number, words in lines:
        if not words:
            continue
        place, keyword = f"{source}:{number}", words[0].lower()
        if keyword.startswith(":"):
            section, name = keyword, ROOT_JOINT
        elif section == ":units" and keyword == "angle":
            in_degrees = words[1:2] != ["rad"]
        elif section == ":root":
            _set_root(bones[ROOT_JOINT], words, place)
        elif section == ":bonedata" and keyword == "name":
            name = words[1] if len(words) == 2 else ""
            if not name or name in bones or len(bones) == MAX_JOINTS:
                raise CaptureError(f"{place}: bone {name[:40]!r} occurs twice, or is one of more than {MAX_JOINTS}")
            bones[name] = _Bone()
        elif section == ":bonedata" and name != ROOT_JOINT:
            _set_bone(bones[name], words, place)
        elif section == ":hierarchy" and keyword not in ("begin", "end"):
            _add_children(parents, words, bones, place)
    if not bones[ROOT_JOINT].freedoms:
        raise CaptureError(f"{source}: not an .asf skeleton: it has no order in :root")
    if len(parents) != len(bones) - 1:
        lost = next((bone for bone in bones if bone != ROOT_JOINT and bone not in parents), ROOT_JOINT)
        raise CaptureError(f"{source}: not an .asf skeleton: bone {lost[:40]!r} has no parent in :hierarchy")
    ordered = list(_parents_first(parents))
    if len(ordered) != len(bones):
        raise CaptureError(f"{source}: bones of :hierarchy are not connected to {ROOT_JOINT}")
    joints = tuple(
        CapturedJoint(
            bone, parents.get(bone), sealed(bones[parents[bone]].end) if bone in parents else NO_TURN, NO_TURN
        )
        for bone in ordered
    )
    axes = {bone: Rotation.from_euler(bones[bone].order, bones[bone].axes, degrees=in_degrees) for bone in ordered}
    return AcclaimSkeleton(joints, axes, {bone: bones[bone].freedoms for bone in ordered})


def _set_root(root: _Bone, words: Sequence[str], place: str) -> None:
    """Set the root's axes and degrees of freedom from a line."""
    match words[0].lower():
        case "order":
            root.freedoms = _parse_freedoms(words[1:], place)
        case "axis":
            root.order = _parse_order(words[1:], place)
        case "orientation":
            root.axes = _parse(words[1:], 3, place)
        case "position":
            _parse(words[1:], 3, place)
        case keyword:
            raise CaptureError(f"{place}: {keyword[:40]!r}; the root has order, axis, position and orientation")


def _set_bone(bone: _Bone, words: Sequence[str], place: str) -> None:
    """Set a bone's property from a line, ignoring limits, masses and ids."""
    match words[0].lower():
        case "direction":
            bone.direction = _parse(words[1:], 3, place)
        case "length":
            bone.length = float(_parse(words[1:], 1, place)[0])
        case "axis":
            bone.axes = _parse(words[1:4], 3, place)
            bone.order = _parse_order(words[4:], place)
        case "dof":
            bone.freedoms = _parse_freedoms(words[1:], place)


def _parse(words: Sequence[str], count: int, place: str) -> Floats:
    if len(words) != count:
        raise CaptureError(f"{place}: {len(words)} numbers; it needs {count}")
    return parse_numbers(words, place)


def _parse_order(words: Sequence[str], place: str) -> str:
    order = words[0].lower() if len(words) == 1 else ""
    if sorted(order) != ["x", "y", "z"]:
        raise CaptureError(f"{place}: order of axes {' '.join(words)[:40]!r}; it must be XYZ in any order")
    return order


def _parse_freedoms(words: Sequence[str], place: str) -> tuple[str, ...]:
    freedoms = tuple(word.lower() for word in words)
    known = {*ROTATION_AXES, *TRANSLATION_CHANNELS, LENGTH_FREEDOM}
    unknown = next((word for word in freedoms if word not in known), None)
    if unknown is not None or len(set(freedoms)) < len(freedoms):
        raise CaptureError(
            f"{place}: degrees of freedom {' '.join(words)[:40]!r}; each of {' '.join(sorted(known))} at most once"
        )
    return freedoms


def _add_children(parents: dict[str, str], words: Sequence[str], bones: Mapping[str, _Bone], place: str) -> None:
    parent, *children = words
    for name in words:
        if name not in bones:
            raise CaptureError(f"{place}: {name[:40]!r} is no bone of :bonedata")
    for child in children:
        if child in parents or child == ROOT_JOINT:
            raise CaptureError(f"{place}: bone {child[:40]!r} has two parents")
        parents[child] = parent


def _parents_first(parents: Mapping[str, str]) -> Iterator[str]:
    """Yield the root and all connected bones, parents first."""
    children: dict[str, list[str]] = {}
    for child, parent in parents.items():
        children.setdefault(parent, []).append(child)
    waiting = [ROOT_JOINT]
    while waiting:
        bone = waiting.pop()
        yield bone
        waiting += reversed(children.get(bone, []))


def read_acclaim_motion(data: bytes, source: str, skeleton: AcclaimSkeleton) -> tuple[CapturedMotion, str]:
    """Read an Acclaim motion (.amc) of a skeleton.

    Returns:
        The motion, and a guess about its frame rate.

    Raises:
        CaptureError: the data is not such a motion, or names other bones.
    """
    values, in_degrees = _parse_frames(split_lines(data, source), source, skeleton)
    count = len(values[ROOT_JOINT]) // len(skeleton.freedoms[ROOT_JOINT])
    check_times(np.arange(count) / FRAME_RATE, source)
    columns: dict[tuple[str, str], slice] = {}
    blocks: list[Floats] = []
    width = 0
    for bone, flat in values.items():
        if len(flat) != count * len(skeleton.freedoms[bone]):
            raise CaptureError(f"{source}: bone {bone[:40]!r} is missing in a frame")
        numbers = np.array(flat).reshape(count, -1)
        rotation = Rotation.identity(count)
        for k, freedom in enumerate(skeleton.freedoms[bone]):
            if freedom in ROTATION_AXES:  # the first listed rotation is applied first
                rotation = Rotation.from_euler(ROTATION_AXES[freedom], numbers[:, [k]], degrees=in_degrees) * rotation
            elif freedom in TRANSLATION_CHANNELS and bone == ROOT_JOINT:
                blocks.append(numbers[:, [k]])
                columns[bone, TRANSLATION_CHANNELS[freedom]] = slice(width, width := width + 1)
        blocks.append(skeleton.axes[bone].apply(rotation.as_rotvec()))
        columns[bone, ROTATION_CHANNEL] = slice(width, width := width + 3)
    times = sealed(np.arange(count) / FRAME_RATE)
    motion = CapturedMotion(times, columns, sealed(np.concatenate(blocks, axis=1)), {})
    return motion, f"frame rate taken as {FRAME_RATE:g} Hz"


def _parse_frames(
    lines: Sequence[str], source: str, skeleton: AcclaimSkeleton
) -> tuple[Mapping[str, "array[float]"], bool]:
    """Parse each bone's numbers of all frames, and the unit of angles.

    Bones without degrees of freedom are left out.
    """
    values = {bone: array("d") for bone, freedoms in skeleton.freedoms.items() if freedoms}
    in_degrees, has_begun = True, False
    for number, line in enumerate(lines, start=1):
        words = line.split("#")[0].split()
        if not words:
            continue
        if words[0].startswith(":"):
            in_degrees = in_degrees and words[0].lower() != ":radians"
        elif len(words) == 1 and words[0].isdecimal():
            has_begun = True
        else:
            place = f"{source}:{number}"
            bone = words[0]
            if not has_begun or bone not in values:
                raise CaptureError(f"{place}: not an .amc motion of this skeleton: {bone[:40]!r} is no bone that moves")
            width = len(skeleton.freedoms[bone])
            if len(values[bone]) >= MAX_FRAMES * width:
                raise CaptureError(f"{place}: it has more than {MAX_FRAMES} frames")
            values[bone].extend(_parse(words[1:], width, f"{place}: {bone[:40]}").tolist())
    return values, in_degrees
