"""The rig of a skinned figure: frames that move its skin, and how each follows from the hinges of a skeleton.

A segment of the skeleton has one frame, or several. Where skin spans a joint, a frame stands half-way between the two
segments; along an arm, frames take shares of the twist from the shoulder to the elbow, and from there to the wrist; the
trunk and the neck bend in parts about one centre. All are driven by the angles of hinges, never by the rotation that
they add up to, which would jump where it passes half a turn.

At bind, the figure stands as its mesh was made, in an A: `BIND` says at which angles.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

FINGERS = ("thumb", "index", "middle", "ring", "pinky")
UPPER_ARM = (0.10, 0.90)  # of the bone: where its twist begins and ends
FOREARM = (0.05, 0.97)


@dataclass(frozen=True)
class SkinningFrame:
    """One frame that moves skin."""

    name: str
    segment: str  # whose hinges turn it, about whose origin
    share: float = 1.0  # of the rotation that the segment's hinges make, but for the twist
    twist: float = 1.0  # share of the twist about the bone; a segment without a twist ignores it


def _arm(side: str) -> tuple[SkinningFrame, ...]:
    shoulder, elbow, wrist = (f"{side}_{name}" for name in ("shoulder", "elbow", "wrist"))
    return (
        SkinningFrame(f"{side}_sternoclavicular", f"{side}_sternoclavicular"),
        SkinningFrame(f"{shoulder}_half", shoulder, 0.5, 0.0),
        *(SkinningFrame(f"{shoulder}_{k}", shoulder, 1.0, k / 2) for k in range(3)),
        SkinningFrame(f"{elbow}_half", elbow, 0.5, 0.0),
        *(SkinningFrame(f"{elbow}_{k}", elbow, 1.0, k / 3) for k in range(4)),
        SkinningFrame(f"{wrist}_half", wrist, 0.5),
        SkinningFrame(wrist, wrist),
        *(SkinningFrame(f"{side}_{finger}{k}", f"{side}_{finger}{k}") for finger in FINGERS for k in (1, 2, 3)),
    )


FRAMES: tuple[SkinningFrame, ...] = (
    SkinningFrame("humanoid_root", "humanoid_root"),
    *(SkinningFrame(f"vl5_{k}", "vl5", k / 3, k / 3) for k in (1, 2)),
    SkinningFrame("vl5", "vl5"),
    *(SkinningFrame(f"skullbase_{k}", "skullbase", k / 4, k / 4) for k in (1, 2, 3)),
    SkinningFrame("skullbase", "skullbase"),
    *_arm("l"),
    *_arm("r"),
)
PLACE: Mapping[str, int] = MappingProxyType({frame.name: k for k, frame in enumerate(FRAMES)})
