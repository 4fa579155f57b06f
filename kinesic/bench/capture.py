"""Benchmark of captured motion: clips of the corpus, certified for several robots."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from time import process_time

import numpy as np

from kinesic.bench.blocks import find_corpus
from kinesic.bench.metric import Metric
from kinesic.capture.certification import Certification, certify_clip
from kinesic.capture.read import read_clip
from kinesic.capture.reading.text import CaptureError
from kinesic.session.setup import set_up

CAPTURE_FOLDER = "capture"  # corpus folder of captured motion
CLIP_SUFFIXES = (".skm", ".bvh")  # suffixes of clips in the corpus
COMPARED_ROBOTS = ("upper22", "upper36", "human")  # robots for which clips are certified
KEPT_STRETCH = 1.001  # certified / original duration up to which a motion counts as unstretched
SMALL_STRETCH = 1.3  # certified / original duration up to which the stretch of a motion counts as small
MIN_CORRELATION = 0.95  # goal of the 5th percentile of the clips' wrist-path correlations
MEDIAN_CORRELATION = 0.98  # goal of the median correlation of wrist paths
MAX_UPPER_ARM_ERROR = 15.0  # [deg] goal: largest 95th percentile of upper-arm direction errors


def bench() -> list[Metric]:
    """Certify the captured clips of the corpus for each compared robot."""
    corpus = find_corpus()
    if corpus is None or not (corpus / CAPTURE_FOLDER).is_dir():
        return [Metric("capture.clips", None, "clips", None, "higher", "no captured clips (KINESIC_CORPUS)")]
    paths = list_clips(corpus / CAPTURE_FOLDER)
    return [metric for robot in COMPARED_ROBOTS for metric in robot_metrics(robot, paths)]


def list_clips(folder: Path) -> list[Path]:
    """Return the paths of all clips below a folder."""
    return sorted(path for path in folder.rglob("*") if path.suffix in CLIP_SUFFIXES)


def robot_metrics(robot: str, paths: Sequence[Path]) -> list[Metric]:
    """Certify clips for a robot and measure the results."""
    setup = set_up(robot)
    unread: list[str] = []

    def certify_all() -> Iterator[Certification]:
        for path in paths:
            try:
                yield certify_clip(read_clip(path), setup, path.name)
            except CaptureError as error:
                unread.append(str(error))

    began = process_time()
    results = list(certify_all())
    elapsed = process_time() - began
    prefix = f"capture.{robot}"
    if not results:
        return [Metric(f"{prefix}.clips", None, "clips", None, "higher", "; ".join(unread[:3]))]
    failed = [result.source for result in results if not result.is_certified]
    correlations = [result.distance.correlation for result in results]
    elbows = [result.distance.elbow_direction for result in results]
    stretches = np.array([result.nearest.total_stretch for result in results])
    violating = [result for result in results if result.violations]
    seconds = sum(result.desired.duration for result in results)
    return [
        Metric(f"{prefix}.clips", float(len(results)), "clips", None, "higher"),
        Metric(f"{prefix}.unread", float(len(unread)), "clips", 0.0, "lower", "; ".join(unread[:3])),
        Metric(f"{prefix}.violating_before", len(violating) / len(results), "fraction", None, "lower"),
        Metric(f"{prefix}.not_certified", float(len(failed)), "clips", 0.0, "lower", "; ".join(failed[:3])),
        Metric(f"{prefix}.correlation_p50", float(np.median(correlations)), "", MEDIAN_CORRELATION, "higher"),
        Metric(f"{prefix}.correlation_p5", float(np.percentile(correlations, 5.0)), "", MIN_CORRELATION, "higher"),
        Metric(f"{prefix}.elbow_p95", float(np.percentile(elbows, 95.0)), "deg", MAX_UPPER_ARM_ERROR, "lower"),
        Metric(f"{prefix}.wrist_p50", _median_distance(results), "arm lengths", None, "lower"),
        Metric(f"{prefix}.unstretched", float(np.mean(stretches <= KEPT_STRETCH)), "fraction", 0.8, "higher"),
        Metric(f"{prefix}.small_stretch", float(np.mean(stretches <= SMALL_STRETCH)), "fraction", 0.95, "higher"),
        Metric(f"{prefix}.real_time", seconds / elapsed, "times", 50.0, "higher", "on one core, by CPU time"),
    ]


def _median_distance(results: Sequence[Certification]) -> float:
    """Return the median over clips of the largest wrist deviation [arm lengths]."""
    return float(np.median([result.distance.wrist_max for result in results]))
