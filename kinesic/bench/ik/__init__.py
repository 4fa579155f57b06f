"""Benchmark of inverse kinematics: reach, tracking, other libraries, and thesis Table 7.1."""

from collections.abc import Sequence
from pathlib import Path

from kinesic.bench.ik import ablation, peers, protocol, reach, table71, tasks, tracking
from kinesic.bench.ik.peer_solvers import PEER_LIBRARIES
from kinesic.bench.metric import Metric

IK_PARTS = (reach, protocol, tracking, tasks, ablation, table71, peers)


def bench() -> list[Metric]:
    """Measure all metrics of inverse kinematics."""
    return [metric for part in IK_PARTS for metric in part.bench()]


def draw(metrics: Sequence[Metric], folder: Path) -> list[Path]:
    """Draw one picture per part of the IK benchmark.

    Args:
        metrics: metrics of `bench`, in any order, possibly among others.
        folder: folder of the pictures.

    Returns:
        Paths of the pictures for available metrics; no Table 7.1 without the kernel, no peers without other libraries.
    """
    values = {metric.name: metric.value for metric in metrics if metric.value is not None}
    pictures = []
    if table71.table_name(table71.REFERENCE_METHOD, table71.CHAIN_SIZES[0], "ratio") in values:
        pictures.append(table71.draw(values, folder / "ik-table71.png"))
    if ablation.ablation_name("whole", "mm") in values:
        pictures.append(ablation.draw(values, folder / "ik-solver.png"))
    if any(f"ik.peer_{peer.name}_us" in values for peer in PEER_LIBRARIES):
        pictures.append(peers.draw(values, folder / "ik-peers.png"))
    if "ik.success_mm" in values:
        pictures.append(protocol.draw(folder / "ik-protocol.png"))
    return pictures
