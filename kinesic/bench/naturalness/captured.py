"""Captured gestures of a folder, and how the hand that goes farther moves in each."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.bench.naturalness.measures import GestureMeasures, measure_hand
from kinesic.bench.naturalness.rows import row_figures
from kinesic.bench.naturalness.smartbody_files import CapturedJoint, joint_positions, read_motion, read_skeleton
from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError

PART = "naturalness.captured"
CHEST = "JtSpineC"
ARMS = tuple(tuple(f"Jt{name}{side}" for name in ("Shoulder", "Elbow", "Wrist")) for side in ("Lf", "Rt"))
SMOOTH = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16.0  # over neighbouring frames, against the noise of capture
BETWEEN = re.compile(r"@Idle[A-Za-z]*\d*$|_ToIdle|_WeightShift")  # names of clips in which nothing is said


@dataclass(frozen=True)
class CapturedGesture:
    """One clip."""

    name: str
    hand: GestureMeasures | None
    why: str = ""  # it is not measured


def measure_clips(folder: Path) -> list[CapturedGesture]:
    """Measures all clips below a folder that are gestures.

    A clip `ACTOR@NAME.skm` moves the skeleton `ACTOR.sk`, which stands below the folder or in one beside it.

    Raises:
        ConfigError: there is no such folder.
    """
    if not folder.is_dir():
        raise ConfigError(f"{folder}: no such folder")
    clips = sorted(path for path in folder.rglob("*.skm") if not BETWEEN.search(path.stem))
    skeletons = {path.stem: path for place in (folder.parent / "skeletons", folder) for path in place.rglob("*.sk")}
    return [_measure(path, skeletons) for path in clips]


def captured_figures(clips: Sequence[CapturedGesture]) -> list[Figure]:
    """Sums up clips: each row beside the percentiles that come with kinesic."""
    hands = [clip.hand for clip in clips if clip.hand]
    unread = [f"{clip.name}: {clip.why}" for clip in clips if clip.hand is None]
    return [
        Figure(f"{PART}.clips", float(len(hands)), "clips", None, "higher"),
        Figure(f"{PART}.unread", float(len(unread)), "clips", None, "lower", "; ".join(unread[:3])),
        *(row_figures(PART, hands, {}) if hands else ()),
    ]


def _measure(path: Path, skeletons: Mapping[str, Path]) -> CapturedGesture:
    actor = path.stem.partition("@")[0]
    if actor not in skeletons:
        return CapturedGesture(path.stem, None, f"no skeleton {actor}.sk")
    try:
        return CapturedGesture(path.stem, measure_clip(_actor(skeletons[actor]), path))
    except ConfigError as error:
        return CapturedGesture(path.stem, None, str(error))


@cache
def _actor(path: Path) -> tuple[CapturedJoint, ...]:
    return read_skeleton(path)


def measure_clip(skeleton: Sequence[CapturedJoint], path: Path) -> GestureMeasures:
    """Measures the hand that goes farther in one clip, from its first frame to its last.

    Raises:
        ConfigError: it cannot be read, or its actor has no arms.
    """
    motion = read_motion(path)
    places = joint_positions(skeleton, motion)
    missing = [name for name in (CHEST, *ARMS[0], *ARMS[1]) if name not in places]
    if missing:
        raise ConfigError(f"{path}: its skeleton lacks {', '.join(missing)}")
    syncs = {**motion.syncs, "start": float(motion.times[0]), "end": float(motion.times[-1])}
    found = []
    for names in ARMS:
        shoulder, elbow, wrist = (places[name] for name in names)
        arm = float(np.linalg.norm(elbow[0] - shoulder[0]) + np.linalg.norm(wrist[0] - elbow[0]))
        found.append(measure_hand(motion.times, smoothed(wrist - places[CHEST]), syncs, arm))
    return max(found, key=lambda hand: hand.path)


def smoothed(path: Floats) -> Floats:
    """Smooths (m, 3) frames by their neighbours; before the first and after the last it stands still."""
    beyond = len(SMOOTH) // 2
    padded = np.pad(path, ((beyond, beyond), (0, 0)), mode="edge")
    return np.stack([np.convolve(column, SMOOTH, mode="valid") for column in padded.T], axis=1)
