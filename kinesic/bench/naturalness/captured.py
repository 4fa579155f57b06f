"""Measurement of captured gestures in a folder.

The hand with the longer path counts.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.bench.naturalness.measures import GestureMeasures, measure_hand
from kinesic.bench.naturalness.rows import row_metrics
from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.capture.reading.smartbody import read_motion, read_skeleton
from kinesic.capture.reading.text import read_file
from kinesic.capture.skeleton_motion import CapturedJoint, joint_positions

METRIC_PREFIX = "naturalness.captured"  # prefix of the metric names
CHEST_JOINT = "JtSpineC"  # name of the chest joint in captured skeletons
ARM_JOINTS = tuple(tuple(f"Jt{name}{side}" for name in ("Shoulder", "Elbow", "Wrist")) for side in ("Lf", "Rt"))
SMOOTHING_WEIGHTS = (
    np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16.0
)  # smoothing weights of neighbouring frames, against the noise of capture
IDLE_CLIPS = re.compile(r"@Idle[A-Za-z]*\d*$|_ToIdle|_WeightShift")  # names of clips without gestures


@dataclass(frozen=True)
class CapturedGesture:
    """Hand-motion measures of one captured gesture clip."""

    name: str
    hand: GestureMeasures | None
    why: str = ""  # reason if the clip is not measured


def measure_clips(folder: Path) -> list[CapturedGesture]:
    """Measure all gesture clips below a folder.

    A clip `ACTOR@NAME.skm` moves the skeleton `ACTOR.sk`, which lies below the folder or in `skeletons` next to it.

    Raises:
        ConfigError: the folder does not exist.
    """
    if not folder.is_dir():
        raise ConfigError(f"{folder}: no such folder")
    clips = sorted(path for path in folder.rglob("*.skm") if not IDLE_CLIPS.search(path.stem))
    skeletons = {path.stem: path for root in (folder.parent / "skeletons", folder) for path in root.rglob("*.sk")}
    return [_measure(path, skeletons) for path in clips]


def captured_metrics(clips: Sequence[CapturedGesture]) -> list[Metric]:
    """Return the hand-motion metrics of captured clips."""
    hands = [clip.hand for clip in clips if clip.hand]
    unread = [f"{clip.name}: {clip.why}" for clip in clips if clip.hand is None]
    return [
        Metric(f"{METRIC_PREFIX}.clips", float(len(hands)), "clips", None, "higher"),
        Metric(f"{METRIC_PREFIX}.unread", float(len(unread)), "clips", None, "lower", "; ".join(unread[:3])),
        *(row_metrics(METRIC_PREFIX, hands, {}) if hands else ()),
    ]


def _measure(path: Path, skeletons: Mapping[str, Path]) -> CapturedGesture:
    actor = path.stem.partition("@")[0]
    if actor not in skeletons:
        return CapturedGesture(path.stem, None, f"no skeleton {actor}.sk")
    try:
        return CapturedGesture(path.stem, measure_clip(_load_actor(skeletons[actor]), path))
    except ConfigError as error:
        return CapturedGesture(path.stem, None, str(error))


@cache
def _load_actor(path: Path) -> tuple[CapturedJoint, ...]:
    return read_skeleton(read_file(path), str(path))


def measure_clip(skeleton: Sequence[CapturedJoint], path: Path) -> GestureMeasures:
    """Measure the hand with the longer path in one captured clip.

    Raises:
        ConfigError: the clip cannot be read, or its actor has no arms.
    """
    motion = read_motion(read_file(path), str(path))
    positions = joint_positions(skeleton, motion)
    missing = [name for name in (CHEST_JOINT, *ARM_JOINTS[0], *ARM_JOINTS[1]) if name not in positions]
    if missing:
        raise ConfigError(f"{path}: its skeleton lacks {', '.join(missing)}")
    syncs = {**motion.syncs, "start": float(motion.times[0]), "end": float(motion.times[-1])}
    hands = []
    for names in ARM_JOINTS:
        shoulder, elbow, wrist = (positions[name] for name in names)
        arm = float(np.linalg.norm(elbow[0] - shoulder[0]) + np.linalg.norm(wrist[0] - elbow[0]))
        hands.append(measure_hand(motion.times, smooth_path(wrist - positions[CHEST_JOINT]), syncs, arm))
    return max(hands, key=lambda hand: hand.path)


def smooth_path(path: Floats) -> Floats:
    """Smooth the positions (m, 3) of a path with a moving average.

    The ends are extended by constant positions.
    """
    margin = len(SMOOTHING_WEIGHTS) // 2
    padded = np.pad(path, ((margin, margin), (0, 0)), mode="edge")
    return np.stack([np.convolve(column, SMOOTHING_WEIGHTS, mode="valid") for column in padded.T], axis=1)
