"""Words for body parts in the joint names of imported robots."""

import re
from collections.abc import Iterable
from typing import Literal

Part = Literal["leg", "arm", "shoulder", "elbow", "wrist", "neck", "trunk", "sensor"]

PART_WORDS: dict[Part, tuple[str, ...]] = {  # body part -> words of joint names
    "leg": ("hip", "thigh", "knee", "calf", "shin", "ankle", "foot", "leg", "toe", "haa", "hfe", "kfe", "wheel"),
    "arm": ("arm", "upperarm", "humerus", "clavicle", "collar", "gripper", "finger"),
    "shoulder": ("shoulder", "shld", "shoulders"),
    "elbow": ("elbow", "elb"),
    "wrist": ("wrist", "hand", "forearm", "lowerarm", "wr"),
    "neck": ("neck", "head", "skull"),
    "trunk": ("waist", "torso", "trunk", "chest", "spine", "abdomen", "pelvis"),
    "sensor": (
        "lidar",
        "laser",
        "velodyne",
        "kinect",
        "spindle",
        "antenna",
        "radar",
        "scanner",
        "sensor",
        "rotor",
        "jaw",
        "mouth",
        "ear",
    ),
}
ARM_PARTS = ("arm", "shoulder", "elbow", "wrist")  # parts that only arms have
_PART_OF_WORD = {word: part for part, words in PART_WORDS.items() for word in words}
WORD_PATTERN = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")  # words in names such as left_hipPitch or LElbowYaw


def list_words(name: str) -> list[str]:
    """Split a joint name into lower-case words."""
    return [word.lower() for word in WORD_PATTERN.findall(name)]


def list_parts(name: str) -> list[Part]:
    """Return the body parts that a joint name mentions.

    A letter for the side may be joined to the word, such as in `lleg`.
    """
    words = list_words(name)
    joined = [word[1:] for word in words if word[:1] in ("l", "r") and word not in _PART_OF_WORD]
    return [_PART_OF_WORD[word] for word in (*words, *joined) if word in _PART_OF_WORD]


def count_leg_words(names: Iterable[str]) -> int:
    """Count names with leg words, minus names with arm words."""
    parts = [set(list_parts(name)) for name in names]
    return sum("leg" in found for found in parts) - sum(bool(found & set(ARM_PARTS)) for found in parts)


def is_contradiction(hinge: str, joint: str) -> bool:
    """Return whether a joint's name contradicts its hinge.

    The last word of a name that mentions a part counts. Twists of the upper arm are often called after the elbow, and
    those of the forearm after the wrist.
    """
    part, kind = hinge.removeprefix("l_").removeprefix("r_"), list_parts(joint)[-1:]
    if not kind or kind == ["arm"]:
        return False
    if part.startswith(("skullbase", "vc")):
        return kind[0] != "neck"
    if part.startswith(("vl", "vt")):
        return kind[0] != "trunk"
    fitting = {"sterno": ("shoulder",), "should": ("shoulder", "elbow"), "elbow_": ("elbow", "wrist")}
    return kind[0] not in fitting.get(part[:6], ("wrist", "elbow"))
