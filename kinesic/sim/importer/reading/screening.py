"""Bound the number and size of elements in a foreign robot file.

What only a simulation or a picture needs is left out, so that MuJoCo makes nothing of it: sensors, key frames, height
fields, textures, and sizes of memory. What remains is bounded.
"""

import re
from collections.abc import Iterable

MAX_ELEMENTS = 100_000  # of all files together, copies included
MAX_DEPTH = 200  # elements inside one another, includes expanded
MAX_COPIES = 200  # that <replicate> may make
MAX_NAME_LENGTH = 200  # characters of a name or of a prefix, which every copy repeats
MAX_VALUE_LENGTH = 10_000  # characters of another attribute
MAX_ACTIVATIONS = 100  # states of an actuator
COPY_COUNT = re.compile(r"\s*\+?([0-9]{1,18})\s*")

REFUSED_TAGS = ("flexcomp", "composite")  # elements that grow into meshes of bodies
UNUSED_SECTIONS = ("size", "sensor", "keyframe", "custom", "deformable")  # children of <mujoco>
UNUSED_ASSETS = ("hfield", "texture", "skin")
UNUSED_CHILDREN = ("lengthrange",)  # MuJoCo would simulate muscles
UNUSED_ATTRIBUTES = ("user", "nsample", "delay", "interp", "content_type", "meshdir", "texturedir", "assetdir")
MESH_ATTRIBUTES = ("name", "class", "scale", "refpos", "refquat")  # the others describe how MuJoCo makes a mesh
REPEATED_NAMES = ("name", "prefix", "sep", "class", "childclass", "model")


class UnfitError(Exception):
    """An element beyond the bounds, with the reason and a remedy."""


def is_unused(tag: str, parents: Iterable[str]) -> bool:
    """Return whether the importer needs nothing of an element of MJCF.

    Args:
        tag: of the element.
        parents: tags of the elements around it, the outermost first.
    """
    match tuple(parents)[1:]:  # the first is <mujoco>
        case ():
            return tag in UNUSED_SECTIONS
        case ("asset",):
            return tag in UNUSED_ASSETS
        case _:
            return tag in UNUSED_CHILDREN


def screen_element(tag: str, attributes: dict[str, str]) -> dict[str, str]:
    """Return the attributes of an element that MuJoCo may see, bounded.

    Raises:
        UnfitError: a value is longer or larger than that of any robot.
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


def copies_of(attributes: dict[str, str]) -> int:
    """Return the number of copies that a <replicate> makes.

    Raises:
        UnfitError: the count is missing or not a whole number.
    """
    count = COPY_COUNT.fullmatch(attributes.get("count", ""))
    if count is None:
        raise UnfitError(f'count="{attributes.get("count", "")[:20]}" of <replicate> must be a whole number')
    return max(int(count[1]), 1)
