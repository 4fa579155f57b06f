"""Plan a document, print requested and planned stroke times, and save the motion."""

from pathlib import Path
from tempfile import TemporaryDirectory

import kinesic
from kinesic.body.config import CONFIGS

performer = kinesic.Performer("upper22", style="calm")
plan = performer.plan(CONFIGS / "bml" / "welcome.bml")
print(plan)
for sync in plan.syncs:
    if sync.sync == "stroke":
        print(f"{sync.behaviour:8} requested {sync.requested:6.3f} s, planned {sync.planned:6.3f} s")
elbow = performer.robot.skeleton.joint("r_elbow_flexion")
print(f"right elbow during the nod: {plan.at('nod:stroke').angles[elbow]:.2f} rad")
with TemporaryDirectory() as folder:
    path = plan.save(Path(folder) / "welcome.csv")
    print(f"{plan.trajectory.duration:.2f} s of motion in {path.stat().st_size} bytes")
