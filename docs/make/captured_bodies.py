"""Measure folders of captured clips and write kinesic/configs/captured_bodies.toml: statistics, no motion.

Usage: captured_bodies.py FOLDER ... (sets of SmartBody's clips, and a folder of BVH files)
"""

import sys
from pathlib import Path

from kinesic.bench.naturalness.whole_body.clips import read_clips
from kinesic.bench.naturalness.whole_body.features import measure_sets
from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.bench.naturalness.whole_body.stored import TABLE_FILE, format_sets

HEAD = """\
# Whole-body measures of captured clips: statistics of motion capture, no motion itself. The clips are by others:
# SmartBody (data/behaviorsets of github.com/worldforge/smartbody) and Greta (bin/Examples/BvhMocap of
# github.com/isir/greta). Constants were fitted on Gestures, Gestures2, MaleGestures and FemaleGestures only.
# Definitions and units: kinesic/bench/naturalness/whole_body. `docs/make/captured_bodies.py` writes this file.

"""

if __name__ == "__main__":
    clips = [clip for folder in sys.argv[1:] for clip in read_clips(Path(folder)) if isinstance(clip, BodyMotion)]
    TABLE_FILE.write_text(HEAD + format_sets(measure_sets(clips)), encoding="utf-8")
