"""Gives the page's player the motion: the robot's shapes, angles at a steady rate, and what happens when."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.controller.performance import Performance
from kinesic.planning.captions import captions
from kinesic.planning.face_track import faces, shown_units
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.report.figure.face_data import face_data
from kinesic.report.labels import label
from kinesic.report.report import Json
from kinesic.report.scene import pack_rows, scene_data

REPLAY_RATE = 50.0  # [Hz]
MOST_FRAMES = 6000  # of one motion; longer ones have a lower rate
MOST_MARKS = 300  # on the time line; with more there are only those of strokes
DUTY_STEP = 0.01  # of a byte


def replay_data(performance: Performance) -> dict[str, Json]:
    """Gathers what the player reads.

    Angles are 16-bit integers, duties bytes, both little-endian in base64, one row of hinges for each frame.

    Args:
        performance: what was planned and performed.
    """
    plan, measured = performance.plan, performance.measured
    desired = plan.desired
    robot, end = plan.setup.robot, float(measured.times[-1])
    moments = np.linspace(0.0, end, min(int(np.ceil(end * REPLAY_RATE)) + 1, MOST_FRAMES))
    motions = {
        "twin": np.column_stack([np.interp(moments, measured.times, column) for column in measured.angles.T]),
        "plan": plan.trajectory.sample(moments)[0],
        "asked": desired.sample(moments - plan.trajectory.zero + desired.zero)[0],
    }
    duties = np.column_stack([np.interp(moments, measured.times, np.abs(column)) for column in measured.duties.T])
    step = max(float(np.abs(angles).max()) for angles in motions.values()) / np.iinfo(np.int16).max or 1.0
    return {
        "end": end,
        "frames": len(moments),
        "step": step,
        "duty_step": DUTY_STEP,
        "hinges": list(robot.skeleton.names),
        **scene_data(robot),
        **({} if robot.skin is None else {"features": face_data(faces(plan, moments))}),
        "motions": {name: pack_rows(angles / step, "<i2") for name, angles in motions.items()},
        "face": _face(performance.plan, moments),
        "duties": pack_rows(duties / DUTY_STEP, "u1"),
        "marks": _marks(performance),
        "words": [[round(said.begin, 3), round(said.end, 3), said.text] for said in captions(plan)],
    }


def _face(plan: Plan, moments: Floats) -> dict[str, Json]:
    """Action units that are seen at all, and their intensities in bytes, a row for each frame."""
    shown = shown_units(plan, moments)
    seen = {unit: np.broadcast_to(rows, len(moments)) for unit, rows in shown.items() if np.any(rows)}
    rows = np.stack([*seen.values()], axis=1) if seen else np.zeros((len(moments), 0))
    return {"units": list(seen), "rows": pack_rows(255 * rows, "u1")}


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
