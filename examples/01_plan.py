"""Plans without moving: when each stroke was asked for, when it will be, and the motion as a file."""

from pathlib import Path
from tempfile import TemporaryDirectory

from kinesic.body.config import CONFIGS
from kinesic.controller.perform import facts, plan
from kinesic.planning.motion_files import write_motion

known = facts("upper22", style="calm")
planned = plan((CONFIGS / "bml" / "welcome.bml").read_bytes(), known)
for sync in planned.syncs:
    if sync.sync == "stroke":
        print(f"{sync.behaviour:8} asked {sync.asked:6.3f} s, planned {sync.planned:6.3f} s")
with TemporaryDirectory() as folder:
    path = Path(folder) / "welcome.csv"
    write_motion(planned.trajectory, known.robot, path)
    print(f"{planned.trajectory.duration:.2f} s of motion in {path.stat().st_size} bytes")
