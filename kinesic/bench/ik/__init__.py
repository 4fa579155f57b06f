"""Measures inverse kinematics: reach, tracking, other libraries, and the thesis's table."""

from collections.abc import Sequence
from pathlib import Path

from kinesic.bench.figure import Figure
from kinesic.bench.ik import ablation, peers, protocol, reach, table71, tasks, tracking
from kinesic.bench.ik.peer_solvers import PEERS

PARTS = (reach, protocol, tracking, tasks, ablation, table71, peers)


def bench() -> list[Figure]:
    """Measures every figure of the part."""
    return [figure for part in PARTS for figure in part.bench()]


def draw(figures: Sequence[Figure], folder: Path) -> list[Path]:
    """Draws what was measured.

    Args:
        figures: of `bench`, in any order, others among them.
        folder: for the pictures.

    Returns:
        The pictures of those figures that are there; none of table 7.1 without the kernel, none of peers without any.
    """
    values = {figure.name: figure.value for figure in figures if figure.value is not None}
    pictures = []
    if table71.table_name(table71.REFERENCE, table71.SIZES[0], "ratio") in values:
        pictures.append(table71.draw(values, folder / "ik-table71.png"))
    if ablation.ablation_name("whole", "mm") in values:
        pictures.append(ablation.draw(values, folder / "ik-solver.png"))
    if any(f"ik.peer_{peer.name}_us" in values for peer in PEERS):
        pictures.append(peers.draw(values, folder / "ik-peers.png"))
    if "ik.success_mm" in values:
        pictures.append(protocol.draw(folder / "ik-protocol.png"))
    return pictures
