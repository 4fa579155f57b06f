"""Fit the standing postures of captured people and write kinesic/configs/standing.toml: statistics, no motion.

Usage: standing.py FOLDER ... (sets of SmartBody's clips on which constants may be fitted)
"""

import sys
from collections.abc import Mapping
from pathlib import Path

from kinesic.bench.naturalness.whole_body.arm_poses import fit_poses, group_poses, weigh_poses
from kinesic.bench.naturalness.whole_body.clips import read_clips
from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.bench.naturalness.whole_body.stances import fit_stances, group_hanging
from kinesic.planning.stance import STANCE_FILE, ArmPoseTable, StanceTable

TUNED_SETS = ("Gestures", "Gestures2", "MaleGestures", "FemaleGestures")  # sets on which constants are fitted
HEAD = """\
# How people stand: a mixture of distributions, fitted to resting frames of captured clips that differ from the first
# pose of their clip. `weight` is the probability of a part: its fraction of all resting frames, as the mean over sets.
# Angles in degrees. Trunk and head: tilt + forward or down, roll + right, turn + left, of the trunk from the hips and
# of the head from the line of the shoulders. `shoulder_rise`: line of the shoulders over the rolled trunk, + left
# shoulder up. Links of an arm: direction from straight down, forward and outward.
# [hanging]: multivariate t distributions. `symmetric` and `asymmetric` are the principal components of the scale
# matrices; the second are added to the left arm and subtracted from the right, as is `handedness`, the mean asymmetry.
# `persons` vary about the mean, and `rests` about the mean of their person.
# [[poses]]: other postures of the arms, normal distributions with their largest principal components, of frames and
# their mirror images. A drawn posture is mirrored in half of the cases.
# Sources, in data/behaviorsets of github.com/worldforge/smartbody; statistics, no motion. `docs/make/standing.py`
# writes this file. Hanging arms: {groups}. Resting frames of poses: {counts}.

"""


def format_row(values: Mapping[str, float]) -> str:
    """Return the TOML text of the non-zero features of a row."""
    return "{ " + ", ".join(f"{feature} = {value!r}" for feature, value in values.items() if value) + " }"


def format_table(name: str, table: StanceTable) -> str:
    """Return the TOML text of a distribution."""
    lines = [f"[{name}]", f"weight = {table.weight!r}", f"mean = {format_row(table.mean)}"]
    lines += [f"handedness = {format_row(table.handedness)}"]
    for part, components in (("persons", table.persons), ("rests", table.rests)):
        lines += ["", f"[{name}.{part}]"]
        lines += [f"degrees_of_freedom = {components.degrees_of_freedom!r}"]
        for kind, rows in (("symmetric", components.symmetric), ("asymmetric", components.asymmetric)):
            lines += [f"{kind} = [", *(f"  {format_row(values)}," for values in rows), "]"]
    return "\n".join(lines) + "\n"


def format_pose(pose: ArmPoseTable) -> str:
    """Return the TOML text of one posture of the arms."""
    lines = ["", "[[poses]]", f'name = "{pose.name}"', f"weight = {pose.weight!r}", f"mean = {format_row(pose.mean)}"]
    lines += ["components = [", *(f"  {format_row(values)}," for values in pose.components), "]"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    clips = [clip for folder in sys.argv[1:] for clip in read_clips(Path(folder)) if isinstance(clip, BodyMotion)]
    tuned = [clip for clip in clips if clip.set_name in TUNED_SETS]
    people, poses = group_hanging(tuned), group_poses(tuned)
    weights = weigh_poses(tuned)
    counts = ", ".join(f"{name} {sum(map(len, groups.values()))}" for name, groups in poses.items())
    hanging = fit_stances(people, round(weights["hanging"], 2))
    text = HEAD.format(groups=", ".join(people), counts=counts) + format_table("hanging", hanging)
    STANCE_FILE.write_text(text + "".join(map(format_pose, fit_poses(poses, weights))), encoding="utf-8")
