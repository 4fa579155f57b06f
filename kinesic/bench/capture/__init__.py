"""Benchmark of captured motion: clips of the corpus, certified for several robots."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from time import process_time

import numpy as np

from kinesic.bench.blocks import find_corpus
from kinesic.bench.capture.elbow_errors import measure_elbow_errors
from kinesic.bench.capture.imported_robots import ROBOT_FILES, load_imported
from kinesic.bench.capture.independent_checks import find_largest_ratio, has_penetration
from kinesic.bench.capture.marker_shift import measure_stroke_shift
from kinesic.bench.capture.path_distribution import frechet_distance, sample_features
from kinesic.bench.capture.peer_metrics import PeerMotion, measure_peer, peer_metrics
from kinesic.bench.metric import Metric
from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.capture.certification import Certification, certify_clip
from kinesic.capture.read import read_clip
from kinesic.capture.reading.text import CaptureError
from kinesic.capture.robot_motion import arm_paths
from kinesic.capture.violations import MAX_RATIO
from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up

CAPTURE_FOLDER = "capture"  # corpus folder of captured motion
CLIP_SUFFIXES = (".skm", ".bvh")  # suffixes of clips in the corpus
COMPARED_ROBOTS = ("upper22", "upper36", "human")  # kinesic's robots for which clips are certified
KEPT_STRETCH = 1.001  # certified / original duration up to which a motion counts as unstretched
SMALL_STRETCH = 1.3  # certified / original duration up to which the stretch of a motion counts as small
MIN_CORRELATION = 0.95  # goal of the 5th percentile of the clips' wrist-path correlations
MEDIAN_CORRELATION = 0.98  # goal of the median correlation of wrist paths
MAX_STROKE_SHIFT = 30.0  # [ms] goal: median shift of the strokes in motions with little stretch
SHIFT_STRETCH = 1.5  # certified / original duration up to which shifts of strokes count
MAX_UPPER_ARM_ERROR = 15.0  # [deg] goal: largest 95th percentile of upper-arm direction errors


@dataclass(frozen=True, eq=False)
class MeasuredClip:
    """Certified motion of one clip, with independent checks and mink's motion."""

    result: Certification
    cpu_time: float  # [s] CPU time of reading and certification
    largest_ratio: float  # largest value / limit at 10 kHz by SciPy
    has_penetration: bool  # whether bodies touch, by MuJoCo
    captured: Floats  # (k, f) features of the clip
    certified: Floats  # (k, f) features of the certified motion
    least_elbow_error: float  # [deg] 95th percentile of upper-arm errors due to arm proportions alone
    elbow_excess: float  # [deg] 95th percentile of upper-arm errors beyond those due to arm proportions
    stroke_shift: float | None  # [s] time shift of the stroke; None: no marker, or no motion near the marker
    peer: PeerMotion | None  # motion retargeted by mink; None: mink is not installed


def bench() -> list[Metric]:
    """Certify the captured clips of the corpus for each compared robot."""
    corpus = find_corpus()
    if corpus is None or not (corpus / CAPTURE_FOLDER).is_dir():
        return [Metric("capture.clips", None, "clips", None, "higher", "no captured clips (KINESIC_CORPUS)")]
    return bench_robots(list_clips(corpus / CAPTURE_FOLDER))


def bench_robots(paths: Sequence[Path]) -> list[Metric]:
    """Certify clips for kinesic's own and for imported robots."""
    metrics = [metric for robot in COMPARED_ROBOTS for metric in robot_metrics(robot, paths, set_up(robot))]
    for robot in ROBOT_FILES:
        try:
            setup = set_up(load_imported(robot))
        except ConfigError as error:
            metrics.append(Metric(f"capture.{robot}.clips", None, "clips", None, "higher", str(error)))
            continue
        metrics += robot_metrics(robot, paths, setup)
    return metrics


def list_clips(folder: Path) -> list[Path]:
    """Return the paths of all clips below a folder."""
    return sorted(path for path in folder.rglob("*") if path.suffix in CLIP_SUFFIXES)


def robot_metrics(robot: str, paths: Sequence[Path], setup: Setup) -> list[Metric]:
    """Certify clips for a robot and measure the results.

    Args:
        robot: name in the metrics.
        paths: of the clips.
        setup: robot with its limits.
    """
    unread: list[str] = []
    clips: list[MeasuredClip] = []
    for path in paths:
        try:
            clips.append(_measure(path, setup))
        except CaptureError as error:
            unread.append(str(error))
    prefix = f"capture.{robot}"
    if not clips:
        return [Metric(f"{prefix}.clips", None, "clips", None, "higher", "; ".join(unread[:3]))]
    results = [clip.result for clip in clips]
    failed = [result.source for result in results if not result.is_certified]
    correlations = [result.distance.correlation for result in results]
    elbows = [result.distance.elbow_direction for result in results]
    stretches = np.array([result.nearest.total_stretch for result in results])
    violating = [result for result in results if result.violations]
    seconds, cpu_time = (sum(values) for values in ([r.desired.duration for r in results], [c.cpu_time for c in clips]))
    beyond = [clip.result.source for clip in clips if clip.largest_ratio > MAX_RATIO]
    touching = [clip.result.source for clip in clips if clip.has_penetration]
    captured = [clip.captured for clip in clips]
    return [
        Metric(f"{prefix}.clips", float(len(results)), "clips", None, "higher"),
        Metric(f"{prefix}.unread", float(len(unread)), "clips", 0.0, "lower", "; ".join(unread[:3])),
        Metric(f"{prefix}.violating_before", len(violating) / len(results), "fraction", None, "lower"),
        Metric(f"{prefix}.not_certified", float(len(failed)), "clips", 0.0, "lower", "; ".join(failed[:3])),
        Metric(f"{prefix}.violating_after", float(len(beyond)), "clips", 0.0, "lower", "; ".join(beyond[:3])),
        Metric(f"{prefix}.penetrating", float(len(touching)), "clips", 0.0, "lower", "; ".join(touching[:3])),
        Metric(f"{prefix}.correlation_p50", float(np.median(correlations)), "", MEDIAN_CORRELATION, "higher"),
        Metric(f"{prefix}.correlation_p5", float(np.percentile(correlations, 5.0)), "", MIN_CORRELATION, "higher"),
        Metric(f"{prefix}.elbow_p95", _high(elbows), "deg", MAX_UPPER_ARM_ERROR, "lower"),
        Metric(f"{prefix}.elbow_least_p95", _high([clip.least_elbow_error for clip in clips]), "deg", None, "lower"),
        Metric(f"{prefix}.elbow_excess_p95", _high([clip.elbow_excess for clip in clips]), "deg", None, "lower"),
        Metric(f"{prefix}.wrist_p50", _median_distance(results), "arm lengths", None, "lower"),
        _shift_metric(f"{prefix}.stroke_shift_p50", clips),
        Metric(f"{prefix}.unstretched", float(np.mean(stretches <= KEPT_STRETCH)), "fraction", 0.8, "higher"),
        Metric(f"{prefix}.small_stretch", float(np.mean(stretches <= SMALL_STRETCH)), "fraction", 0.95, "higher"),
        Metric(f"{prefix}.real_time", seconds / cpu_time, "times", 50.0, "higher", "on one core, by CPU time"),
        _frechet_metric(f"{prefix}.frechet", captured, [clip.certified for clip in clips]),
        _frechet_metric(f"{prefix}.frechet_halves", captured[::2], captured[1::2]),
        *peer_metrics(f"{prefix}.peer", [clip.peer for clip in clips if clip.peer is not None]),
    ]


def _measure(path: Path, setup: Setup) -> MeasuredClip:
    """Certify a clip, and check the certified motion.

    Raises:
        CaptureError: the clip cannot be read.
    """
    began = process_time()
    result = certify_clip(read_clip(path), setup, path.name)
    cpu_time = process_time() - began
    reached = arm_paths(setup.robot, result.nearest.angles)
    pairs = [measure_elbow_errors(arm, reached[side]) for side, arm in result.desired.arms.items()]
    errors, least = (np.concatenate(values) for values in zip(*pairs, strict=True))
    return MeasuredClip(
        result=result,
        cpu_time=cpu_time,
        largest_ratio=find_largest_ratio(result.trajectory, setup.limits),
        has_penetration=has_penetration(result.trajectory, setup.robot),
        captured=sample_features(result.desired.arms),
        certified=sample_features(reached),
        least_elbow_error=float(np.percentile(least, 95.0)),
        elbow_excess=float(np.percentile(np.maximum(errors - least, 0.0), 95.0)),
        stroke_shift=None
        if (stroke := result.desired.syncs.get("stroke")) is None
        else measure_stroke_shift(stroke, result.desired.arms, reached, result.nearest.clip_times),
        peer=measure_peer(result) if find_spec("mink") else None,
    )


def _shift_metric(name: str, clips: Sequence[MeasuredClip]) -> Metric:
    """Return the median size of stroke shifts [ms], null without markers."""
    few = (clip for clip in clips if clip.result.nearest.total_stretch <= SHIFT_STRETCH)
    shifts = [abs(clip.stroke_shift) for clip in few if clip.stroke_shift is not None]
    where = f"{len(shifts)} clips with a marker"
    return Metric(name, 1000.0 * float(np.median(shifts)) if shifts else None, "ms", MAX_STROKE_SHIFT, "lower", where)


def _frechet_metric(name: str, first: Sequence[Floats], second: Sequence[Floats]) -> Metric:
    """Return the Frechet distance of two sets of clips, null without clips."""
    if not first or not second:
        return Metric(name, None, "", None, "lower", "it needs two clips")
    return Metric(name, frechet_distance(first, second), "", None, "lower")


def _high(values: Sequence[float]) -> float:
    """Return the 95th percentile of values."""
    return float(np.percentile(values, 95.0))


def _median_distance(results: Sequence[Certification]) -> float:
    """Return the median over clips of the largest wrist deviation [arm lengths]."""
    return float(np.median([result.distance.wrist_max for result in results]))
