"""Data for the page's motion player: shapes, joint angles and events."""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.captions import make_captions
from kinesic.planning.face_track import compute_action_units, compute_faces
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.report.figure.face_data import face_data
from kinesic.report.labels import label
from kinesic.report.report import Json
from kinesic.report.scene import drawable, pack_rows, scene_data

REPLAY_RATE = 50.0  # [Hz] frame rate of the page's player
MAX_FRAMES = 6000  # largest number of frames; longer motions have a lower rate
MAX_MARKS = 300  # largest number of sync points marked on the time line; if there are more, only strokes are marked
DUTY_STEP = 0.01  # duty cycle per count of a byte in the packed data


def replay_data(performance: DryRun, *, max_frames: int = MAX_FRAMES) -> dict[str, Json]:
    """Pack the motion of plan and twin for the page's player.

    Angles are 16-bit integers, duties bytes, both little-endian in base64, one row of hinges for each frame.

    Args:
        performance: planned and performed motion.
        max_frames: largest number of frames; longer motions have a lower rate.
    """
    plan, measured = performance.plan, performance.measured
    desired = plan.desired
    frame_times = _frame_times(performance.duration, max_frames)
    motions = {
        "twin": np.column_stack([np.interp(frame_times, measured.times, column) for column in measured.angles.T]),
        "plan": plan.trajectory.sample(frame_times)[0],
        "asked": desired.sample(frame_times - plan.trajectory.zero + desired.zero)[0],
    }
    duties = np.column_stack([np.interp(frame_times, measured.times, np.abs(column)) for column in measured.duties.T])
    return _pack(plan, frame_times, motions, duties) | {"marks": _marks(plan, performance.lags)}


def planned_replay_data(plan: Plan, *, max_frames: int = MAX_FRAMES) -> dict[str, Json]:
    """Pack the planned motion for the page's player, without servo loads.

    Args:
        plan: planned motion.
        max_frames: largest number of frames; longer motions have a lower rate.
    """
    frame_times = _frame_times(plan.duration, max_frames)
    angles = plan.trajectory.sample(frame_times)[0]
    return _pack(plan, frame_times, {"twin": angles}, np.zeros_like(angles)) | {"marks": _marks(plan)}


def _frame_times(end: float, max_frames: int) -> Floats:
    """Return the times of the player's frames, (m,) [s]."""
    return np.linspace(0.0, end, min(int(np.ceil(end * REPLAY_RATE)) + 1, max_frames))


def _pack(plan: Plan, frame_times: Floats, motions: Mapping[str, Floats], duties: Floats) -> dict[str, Json]:
    """Pack motions, loads, face and words, with one row per frame."""
    robot = drawable(plan.setup.robot)
    step = max(float(np.abs(angles).max()) for angles in motions.values()) / np.iinfo(np.int16).max or 1.0
    return {
        "end": float(frame_times[-1]),
        "frames": len(frame_times),
        "step": step,
        "duty_step": DUTY_STEP,
        "hinges": list(robot.skeleton.names),
        **scene_data(robot),
        **({} if robot.skin is None else {"features": face_data(compute_faces(plan, frame_times))}),
        "motions": {name: pack_rows(angles / step, "<i2") for name, angles in motions.items()},
        "face": _face(plan, frame_times),
        "duties": pack_rows(duties / DUTY_STEP, "u1"),
        "words": [[round(caption.begin, 3), round(caption.end, 3), caption.text] for caption in make_captions(plan)],
    }


def _face(plan: Plan, frame_times: Floats) -> dict[str, Json]:
    """Pack the intensities per frame of all facial action units that occur."""
    shown = compute_action_units(plan, frame_times)
    seen = {unit: np.broadcast_to(rows, len(frame_times)) for unit, rows in shown.items() if np.any(rows)}
    rows = np.stack([*seen.values()], axis=1) if seen else np.zeros((len(frame_times), 0))
    return {"units": list(seen), "rows": pack_rows(255 * rows, "u1")}


def _marks(plan: Plan, lags: Mapping[SyncTime, float | None] | None = None) -> list[Json]:
    """Return the sync points to mark on the player's time line.

    With the delays [s] of a performance, their texts have the performed times.
    """
    syncs = list(plan.syncs)
    if len(syncs) > MAX_MARKS:
        syncs = [sync for sync in syncs if sync.is_stroke][:MAX_MARKS]
    names = {behaviour.id: label(behaviour) for behaviour in plan.timeline.block.behaviours}
    return [_mark(sync, names[sync.behaviour], plan.trajectory.zero, lags) for sync in syncs]


def _mark(sync: SyncTime, name: str, zero: float, lags: Mapping[SyncTime, float | None] | None) -> dict[str, Json]:
    moved = abs(sync.planned - sync.requested) > SHIFT_TO_WARN
    times = f"requested {sync.requested:.3f} s, planned {sync.planned:.3f} s"
    if lags is not None:
        lag = lags.get(sync, 0.0)
        times += ", never reached" if lag is None else f", in the twin {sync.planned + lag:.3f} s"
    return {
        "at": round(zero + sync.planned, 4),
        "behaviour": sync.behaviour,
        "name": name,
        "sync": sync.sync,
        "kind": " ".join(name for name, yes in (("stroke", sync.is_stroke), ("moved", moved)) if yes),
        "words": f"{name} ({sync.behaviour}:{sync.sync}) {times}",
    }
