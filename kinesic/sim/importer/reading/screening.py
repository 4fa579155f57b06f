"""Limits on the elements of an untrusted robot file.

Elements needed only for simulation or pictures are removed, so that MuJoCo does not build them: sensors, key frames,
height fields, textures and memory sizes. The remaining elements are bounded in number and size.
"""

import re
from collections.abc import Iterable

MAX_ELEMENTS = 100_000  # largest number of XML elements in all files, copies included
MAX_DEPTH = 200  # deepest nesting of XML elements, with includes expanded
MAX_INCLUDE_DEPTH = 50  # deepest nesting of included files
MAX_COPIES = 200  # largest number of copies of an element by nested <replicate> elements
MAX_NAME_LENGTH = 200  # [characters] longest name or prefix, which every copy repeats
MAX_VALUE_LENGTH = 10_000  # [characters] longest value of any other attribute
MAX_ACTIVATIONS = 100  # largest number of internal states of an actuator
COPY_COUNT = re.compile(r"\s*\+?([0-9]{1,18})\s*")  # pattern of a valid count of a <replicate> element

REFUSED_TAGS = ("flexcomp", "composite")  # refused elements, which MuJoCo expands into grids of bodies
UNUSED_SECTIONS = ("size", "sensor", "keyframe", "custom", "deformable")  # children of <mujoco> that the importer drops
UNUSED_ASSETS = ("hfield", "texture", "skin")  # assets that the importer ignores
UNUSED_CHILDREN = ("lengthrange",)  # actuator elements that are dropped, as MuJoCo would simulate muscles
UNUSED_ATTRIBUTES = ("user", "nsample", "delay", "interp", "content_type", "meshdir", "texturedir", "assetdir")
MESH_ATTRIBUTES = ("name", "class", "scale", "refpos", "refquat")  # attributes of a mesh that the importer keeps
REPEATED_NAMES = ("name", "prefix", "sep", "class", "childclass", "model")  # attributes limited by MAX_NAME_LENGTH


class UnfitError(Exception):
    """Error about a refused element of a robot file, with the reason."""


def is_unused(tag: str, parents: Iterable[str]) -> bool:
    """Return whether the importer can ignore an MJCF element.

    Args:
        tag: Tag of the element.
        parents: Tags of the enclosing elements, outermost first.
    """
    match tuple(parents)[1:]:  # the first is <mujoco>
        case ():
            return tag in UNUSED_SECTIONS
        case ("asset",):
            return tag in UNUSED_ASSETS
        case _:
            return tag in UNUSED_CHILDREN


def screen_element(tag: str, attributes: dict[str, str]) -> dict[str, str]:
    """Return the attributes of an element that are passed to MuJoCo.

    Raises:
        UnfitError: the element is refused, or a value exceeds the limits.
    """
    if tag.startswith("xacro:"):
        raise UnfitError(f"<{tag}> is a macro; expand the file first: xacro FILE > robot.urdf")
    if tag in REFUSED_TAGS:
        raise UnfitError(f"holds a <{tag}>, which no robot's limb is; leave it out")
    kept = {name: value for name, value in attributes.items() if name not in UNUSED_ATTRIBUTES}
    if tag == "mesh":
        kept = {name: value for name, value in kept.items() if name in MESH_ATTRIBUTES}
    for name, value in kept.items():
        longest = MAX_NAME_LENGTH if name in REPEATED_NAMES else MAX_VALUE_LENGTH
        if len(value) > longest:
            raise UnfitError(f"{name} of <{tag}> has {len(value)} characters, at most {longest} are taken")
    states = kept.get("actdim", "1").strip()
    if states.removeprefix("-").isdecimal() and int(states[:9]) > MAX_ACTIVATIONS:
        raise UnfitError(f'actdim="{states[:20]}" of <{tag}>: at most {MAX_ACTIVATIONS} are taken')
    return kept


def count_copies(attributes: dict[str, str]) -> int:
    """Return the copy count of a <replicate> element, at least 1.

    Raises:
        UnfitError: the count is missing or not a whole number.
    """
    count = COPY_COUNT.fullmatch(attributes.get("count", ""))
    if count is None:
        raise UnfitError(f'count="{attributes.get("count", "")[:20]}" of <replicate> must be a whole number')
    return max(int(count[1]), 1)
