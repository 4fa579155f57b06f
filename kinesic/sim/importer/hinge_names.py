"""Hinge names of imported robots without fingers."""

SPINE_TURNS = ("roll", "tilt", "torsion")  # name suffixes of trunk and head hinges, by their nearest axis x, y, z
VERTEBRA_NAMES = {  # segment -> vertebrae that its hinges may have, best first
    "vl5": ("vl5", "vt10", "vt6", "vt1"),
    "skullbase": ("skullbase", "vc4", "vc7", "vc2"),
}
VERTEBRAE_UPWARDS = ("vl5", "vt10", "vt6", "vt1", "vc7", "vc4", "vc2", "skullbase")  # from the pelvis to the head
ARM_TURNS = {  # part of an arm -> name suffixes of its hinges
    "sternoclavicular": ("abduct", "rotate", "twisting"),
    "shoulder": ("flexion", "abduct", "twisting"),
    "elbow": ("flexion", "twisting"),
    "wrist": ("flexion", "pivot", "twisting"),
}


def list_hinge_names() -> list[str]:
    """List the hinge names of trunk, neck and both arms."""
    spine = [f"{name}_{turn}" for names in VERTEBRA_NAMES.values() for name in names for turn in SPINE_TURNS]
    arms = [f"{side}_{part}_{turn}" for side in "lr" for part, turns in ARM_TURNS.items() for turn in turns]
    return [*spine, *arms]


def find_segment(hinge: str) -> str:
    """Return the segment of an imported robot that a hinge moves."""
    first = hinge.rpartition("_")[0]
    spine = [segment for segment, names in VERTEBRA_NAMES.items() if first in names]
    return spine[0] if spine else first
