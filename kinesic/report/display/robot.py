"""HTML of robots: a rotatable rest posture, and a table of hinges."""

import numpy as np

from kinesic.body.robot import Robot
from kinesic.report.display.frame import FrameContent, make_frame
from kinesic.report.display.tables import folded_table, line
from kinesic.report.figure.face_data import face_data
from kinesic.report.report import Json
from kinesic.report.scene import drawable, pack_rows, scene_data

STILL_FRAMES = 2  # number of frames of a replay in which nothing moves


def robot_html(robot: Robot) -> str:
    """Return the HTML of a robot: summary, rest posture, hinges."""
    frame = FrameContent(title=str(robot), replay=_still_replay(robot), still=True)
    rows = [
        (
            hinge.name,
            hinge.segment,
            f"{np.degrees(hinge.lower):.0f} to {np.degrees(hinge.upper):.0f}",
            f"{np.degrees(hinge.rest):.0f}",
            mount.drive.servo.name + (f" x {mount.drive.count}" if mount.drive.count > 1 else ""),
            f"{np.degrees(speed):.0f}",
        )
        for hinge, mount, speed in zip(robot.skeleton.hinges, robot.mounts, robot.velocity_limits, strict=True)
    ]
    headings = ("hinge", "segment", "range [deg]", "rest [deg]", "drive", "velocity limit [deg/s]")
    return line(str(robot)) + make_frame(frame) + folded_table(f"{len(rows)} hinges", headings, rows)


def _still_replay(robot: Robot) -> dict[str, Json]:
    """Return replay data of a robot that stands still at rest."""
    robot = drawable(robot)
    rest = np.tile(robot.skeleton.rest, (STILL_FRAMES, 1))
    step = float(np.abs(rest).max()) / np.iinfo(np.int16).max or 1.0
    return {
        "end": 1.0,
        "frames": STILL_FRAMES,
        "step": step,
        "duty_step": 1.0,
        "hinges": list(robot.skeleton.names),
        **scene_data(robot),
        **({} if robot.skin is None else {"features": face_data([{}] * STILL_FRAMES)}),
        "motions": {"twin": pack_rows(rest / step, "<i2")},
        "face": {"units": [], "rows": ""},
        "duties": pack_rows(np.zeros_like(rest), "u1"),
        "words": [],
        "marks": [],
    }
