"""Gives the page's player the motion: the robot's shapes, angles at a steady rate, and what happens when."""

from base64 import b64encode

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Capsule, Hinge
from kinesic.controller.performance import Performance
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.report.labels import label
from kinesic.report.plots.score import captions
from kinesic.report.report import Json
from kinesic.sim.scene_layout import VIEW_FROM, rods, view_of
from kinesic.sim.scene_style import eyeballs, parts

RATE = 50.0  # [Hz]
MOST_FRAMES = 6000  # of one motion; longer ones have a lower rate
MOST_MARKS = 300  # on the time line; with more there are only those of strokes
DUTY_STEP = 0.01  # of a byte
DIGITS = 4  # of lengths [m]


def replay_data(performance: Performance) -> dict[str, Json]:
    """Gathers what the player reads.

    Angles are 16-bit integers, duties bytes, both little-endian in base64, one row of hinges for each frame.

    Args:
        performance: what was planned and performed.
    """
    plan, measured = performance.plan, performance.measured
    robot, end = plan.setup.robot, float(measured.times[-1])
    moments = np.linspace(0.0, end, min(int(np.ceil(end * RATE)) + 1, MOST_FRAMES))
    motions = {
        "twin": np.column_stack([np.interp(moments, measured.times, column) for column in measured.angles.T]),
        "plan": plan.trajectory.sample(moments)[0],
        "asked": plan.desired.sample(moments - plan.trajectory.zero + plan.desired.zero)[0],
    }
    duties = np.column_stack([np.interp(moments, measured.times, np.abs(column)) for column in measured.duties.T])
    step = max(float(np.abs(angles).max()) for angles in motions.values()) / np.iinfo(np.int16).max or 1.0
    return {
        "end": end,
        "frames": len(moments),
        "step": step,
        "duty_step": DUTY_STEP,
        "hinges": list(robot.skeleton.names),
        "segments": _segments(robot),
        "servos": _servos(robot),
        "details": [*_eyes(robot), *_rods(robot)],
        "view": _view(robot),
        "motions": {name: _packed(angles / step, "<i2") for name, angles in motions.items()},
        "duties": _packed(duties / DUTY_STEP, "u1"),
        "marks": _marks(performance),
        "words": [[round(said.begin, 3), round(said.end, 3), said.text] for said in captions(plan)],
    }


def _packed(values: Floats, kind: str) -> str:
    limits = np.iinfo(kind)
    return b64encode(np.clip(np.rint(values), limits.min, limits.max).astype(kind).tobytes()).decode()


def _rounded(values: Floats) -> list[Json]:
    return [round(float(value), DIGITS) + 0.0 for value in values]


def _segments(robot: Robot) -> list[Json]:
    skeleton = robot.skeleton
    painted = parts(robot)
    return [
        {
            "parent": -1 if segment.parent is None else skeleton.segment(segment.parent),
            "origin": _rounded(segment.origin_in_parent),
            "hinges": [_hinge(joint, skeleton.hinges[joint]) for joint in skeleton.joints_of((segment.name,))],
            "capsules": [_capsule(capsule) for capsule in segment.capsules],
            "colour": painted[segment.name],
        }
        for segment in skeleton.segments
    ]


def _hinge(joint: int, hinge: Hinge) -> dict[str, Json]:
    return {"hinge": joint, "axis": [float(value) for value in hinge.axis], "at": _rounded(hinge.at)}


def _capsule(capsule: Capsule) -> list[Json]:
    return [*_rounded(capsule.start), *_rounded(capsule.end), round(capsule.radius, DIGITS)]


def _servos(robot: Robot) -> list[Json]:
    """Boxes, as their mounts say, one for each hinge."""
    found: list[Json] = []
    for joint, mount in enumerate(robot.mounts):
        width, length, height = mount.drive.servo.size
        half = np.array([mount.drive.count * width, length, height]) / 2
        segment = robot.skeleton.segment(mount.segment)
        found.append({"hinge": joint, "segment": segment, "at": _rounded(mount.position), "half": _rounded(half)})
    return found


def _eyes(robot: Robot) -> list[Json]:
    """Balls: segment, centre, radius, colour."""
    return [
        {
            "segment": robot.skeleton.segment(robot.sites["eyes"].segment),
            "capsule": [*_rounded(ball.centre), *_rounded(ball.centre), ball.radius],
            "colour": "pupil" if ball.dark else "white",
        }
        for ball in eyeballs(robot)
    ]


def _rods(robot: Robot) -> list[Json]:
    """What holds the parts together: segment, capsule, colour."""
    painted = parts(robot)
    return [
        {"segment": robot.skeleton.segment(rod.segment), "capsule": _capsule(rod.shape), "colour": painted[rod.segment]}
        for rod in rods(robot)
    ]


def _view(robot: Robot) -> dict[str, Json]:
    """As the film's camera: what is looked at, from where, how much of it, and where the floor is."""
    view = view_of(robot)
    return {
        "middle": _rounded(view.middle),
        "from": list(VIEW_FROM),
        "height": round(view.height, DIGITS),
        "floor": round(view.floor, DIGITS),
    }


def _marks(performance: Performance) -> list[Json]:
    """Sync points of moving behaviours in performance time."""
    syncs = list(performance.plan.syncs)
    if len(syncs) > MOST_MARKS:
        syncs = [sync for sync in syncs if sync.is_stroke][:MOST_MARKS]
    names = {behaviour.id: label(behaviour) for behaviour in performance.plan.timeline.block.behaviours}
    return [_mark(sync, names[sync.behaviour], performance) for sync in syncs]


def _mark(sync: SyncTime, name: str, performance: Performance) -> dict[str, Json]:
    zero, lag = performance.plan.trajectory.zero, performance.lags.get(sync, 0.0)
    moved = abs(sync.planned - sync.asked) > SHIFT_TO_WARN
    twin = "never reached" if lag is None else f"in the twin {sync.planned + lag:.3f} s"
    times = f"asked {sync.asked:.3f} s, planned {sync.planned:.3f} s, {twin}"
    return {
        "at": round(zero + sync.planned, 4),
        "behaviour": sync.behaviour,
        "name": name,
        "sync": sync.sync,
        "kind": " ".join(name for name, yes in (("stroke", sync.is_stroke), ("moved", moved)) if yes),
        "words": f"{name} ({sync.behaviour}:{sync.sync}) {times}",
    }
