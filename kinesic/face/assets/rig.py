"""Skinning frames of a figure, driven by the hinges of a skeleton.

A segment of the skeleton has one or more frames. Where skin spans a joint, a frame stands half-way between the two
segments; along an arm, frames take fractions of the twist from the shoulder to the elbow, and from there to the wrist;
trunk and neck bend in parts about one centre. All frames are driven by hinge angles, not by the total rotation, which
would jump beyond half a turn.

In the bind pose, the figure stands in an A pose, as its mesh was made.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

FINGER_NAMES = ("thumb", "index", "middle", "ring", "pinky")
UPPER_ARM_TWIST_RANGE = (0.10, 0.90)  # section of the upper arm that twists, as fractions of the bone's length
FOREARM_TWIST_RANGE = (0.05, 0.97)  # section of the forearm that twists, as fractions of the bone's length


@dataclass(frozen=True)
class SkinningFrame:
    """Coordinate frame that moves skin vertices."""

    name: str
    segment: str  # segment whose hinges turn the frame about its origin
    rotation_fraction: float = 1.0  # fraction of the segment's rotation without twist
    twist: float = 1.0  # fraction of the twist about the bone, if the segment twists


def _build_arm_frames(side: str) -> tuple[SkinningFrame, ...]:
    shoulder, elbow, wrist = (f"{side}_{name}" for name in ("shoulder", "elbow", "wrist"))
    return (
        SkinningFrame(f"{side}_sternoclavicular", f"{side}_sternoclavicular"),
        SkinningFrame(f"{shoulder}_half", shoulder, 0.5, 0.0),
        *(SkinningFrame(f"{shoulder}_{k}", shoulder, 1.0, k / 2) for k in range(3)),
        SkinningFrame(f"{elbow}_half", elbow, 0.5, 0.0),
        *(SkinningFrame(f"{elbow}_{k}", elbow, 1.0, k / 3) for k in range(4)),
        SkinningFrame(f"{wrist}_half", wrist, 0.5),
        SkinningFrame(wrist, wrist),
        *(SkinningFrame(f"{side}_{finger}{k}", f"{side}_{finger}{k}") for finger in FINGER_NAMES for k in (1, 2, 3)),
    )


SKINNING_FRAMES: tuple[SkinningFrame, ...] = (
    SkinningFrame("humanoid_root", "humanoid_root"),
    *(SkinningFrame(f"vl5_{k}", "vl5", k / 3, k / 3) for k in (1, 2)),
    SkinningFrame("vl5", "vl5"),
    *(SkinningFrame(f"skullbase_{k}", "skullbase", k / 4, k / 4) for k in (1, 2, 3)),
    SkinningFrame("skullbase", "skullbase"),
    *_build_arm_frames("l"),
    *_build_arm_frames("r"),
)
FRAME_INDICES: Mapping[str, int] = MappingProxyType({frame.name: k for k, frame in enumerate(SKINNING_FRAMES)})
