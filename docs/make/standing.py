"""Fit the standing postures of captured people and write kinesic/configs/standing.toml: statistics, no motion.

Usage: standing.py FOLDER ... (sets of SmartBody's clips on which constants may be fitted)
"""

import sys
from collections.abc import Mapping
from pathlib import Path

from kinesic.bench.naturalness.whole_body.clips import read_clips
from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.bench.naturalness.whole_body.stances import fit_stances, group_hanging
from kinesic.planning.stance import STANCE_FILE, StanceTable

TUNED_SETS = ("Gestures", "Gestures2", "MaleGestures", "FemaleGestures")  # sets on which constants are fitted
HEAD = """\
# How people stand with hanging arms: multivariate t distributions, fitted to resting frames of captured clips that
# differ from the first pose of their clip. Angles in degrees. Trunk and head: tilt + forward or down, roll + right,
# turn + left of the line of the shoulders. `shoulder_rise`: line of the shoulders over the rolled trunk, + left
# shoulder up. Links of an arm: direction from straight down, forward and outward. `symmetric` and `asymmetric` are the
# principal components of the scale matrices; the second are added to the left arm and subtracted from the right, as is
# `handedness`, the mean asymmetry. `persons` vary about the mean, and `rests` about the mean of their person.
# Sources, in data/behaviorsets of github.com/worldforge/smartbody; statistics, no motion. `docs/make/standing.py`
# writes this file. {groups}.

"""


def format_table(name: str, table: StanceTable) -> str:
    """Return the TOML text of a distribution."""

    def row(values: Mapping[str, float]) -> str:
        return "{ " + ", ".join(f"{feature} = {value!r}" for feature, value in values.items()) + " }"

    lines = [f"[{name}]", f"mean = {row(table.mean)}", f"handedness = {row(table.handedness)}"]
    for part, components in (("persons", table.persons), ("rests", table.rests)):
        lines += ["", f"[{name}.{part}]"]
        lines += [f"degrees_of_freedom = {components.degrees_of_freedom!r}"]
        for kind, rows in (("symmetric", components.symmetric), ("asymmetric", components.asymmetric)):
            lines += [f"{kind} = [", *(f"  {row(values)}," for values in rows), "]"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    clips = [clip for folder in sys.argv[1:] for clip in read_clips(Path(folder)) if isinstance(clip, BodyMotion)]
    people = group_hanging(clip for clip in clips if clip.set_name in TUNED_SETS)
    text = HEAD.format(groups=", ".join(people)) + format_table("hanging", fit_stances(people))
    STANCE_FILE.write_text(text, encoding="utf-8")
