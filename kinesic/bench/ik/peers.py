"""Comparison of other IK libraries with kinesic on upper22's left arm.

All solve the same targets, alternating in one process.

A call starts from three numbers and returns the angles. One library's use of the processor's caches slows the next
library's call, so there are three measurements: each peer with kinesic alone, call by call; all in one round, each with
a block of successive targets; and all call by call, where every call finds cold caches. Success is judged by the body's
own forward kinematics: the hand within a millimetre and every joint within its limits. The plots show the time of one
reach and the percentage of reached targets.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.random import default_rng

from kinesic.bench.ik.arms import draw_targets
from kinesic.bench.ik.peer_solvers import PEER_LIBRARIES, Peer, Solver
from kinesic.bench.metric import INK_COLOUR, LABEL_SIZE, MAIN_COLOUR, OTHER_COLOUR, Metric, label_axes, picture
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.extras import install_extra
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.solve import solve

TARGET_COUNT = 200  # hand targets per library
BLOCK_SIZE = 25  # successive targets that one library solves before the next library's turn
MAX_ERROR = 1e-3  # [m] largest hand error of a reached target
LIMIT_SLACK = 1e-6  # [rad] excess over a joint limit that counts as rounding
SOLVE_ENTRY = "kinesic_solve"  # metric name of kinesic's `solve`
REACH_ENTRY = "kinesic_reach"  # metric name of kinesic's `Arm.reach`
MIN_RATIOS = {  # (library, kind of metric, kinesic's function) -> goal for library time / kinesic's time
    ("roboticstoolbox", "ratio", SOLVE_ENTRY): 5.0,
    ("roboticstoolbox", "ratio", REACH_ENTRY): 7.0,
    ("roboticstoolbox", "one_round", SOLVE_ENTRY): 10.0,
    ("roboticstoolbox", "one_round", REACH_ENTRY): 7.0,
}
ENTRY_LABELS = {"kinesic_reach": "kinesic, Arm.reach", "kinesic_solve": "kinesic, solve"}


@dataclass(frozen=True, eq=False)
class Calls:
    """Durations and successes of one IK solver's calls with all targets."""

    seconds: Floats  # (n,)
    reached: Floats  # (n,) 1 if the hand reaches the target within the limits

    @property
    def microseconds(self) -> float:
        """Median time [us] of one IK call."""
        return 1e6 * float(np.median(self.seconds))


def bench() -> list[Metric]:
    """Measure times and successes of other IK libraries relative to kinesic's."""
    chain = Robot.load().arms["l"]
    arm_targets = draw_targets(default_rng(33), chain, TARGET_COUNT)
    metrics = _own_metrics(interleave(chain, own_solvers(chain), arm_targets), "without peers")
    peer_solvers = {peer.name: peer.build(chain) for peer in PEER_LIBRARIES if is_installed(peer)}
    for peer in PEER_LIBRARIES:
        pair = own_solvers(chain) | {peer.name: peer_solvers[peer.name]} if is_installed(peer) else {}
        metrics += _metrics(peer, interleave(chain, pair, arm_targets), _describe_version(peer))
    all_solvers = own_solvers(chain) | peer_solvers
    rounds, cold = take_turns(chain, all_solvers, arm_targets), interleave(chain, all_solvers, arm_targets)
    for peer in PEER_LIBRARIES:
        why = (
            f"alternating with {len(peer_solvers) - 1} other libraries"
            if is_installed(peer)
            else _describe_version(peer)
        )
        metrics += _compute_all_ratios(peer, rounds, cold, why)
    return metrics


def is_installed(peer: Peer) -> bool:
    """Return whether all modules of a library are installed."""
    return all(find_spec(module) is not None for module in peer.needs)


def own_solvers(chain: Chain) -> dict[str, Solver]:
    """Return kinesic's solvers: `solve`, and `reach` that writes into a buffer."""
    arm = arm_of(chain)

    def reach(target: Floats) -> Floats:
        angles = chain.rest.copy()
        arm.reach(target, angles)
        return angles

    return {SOLVE_ENTRY: lambda target: solve(chain, Reach(target), start=chain.rest).angles, REACH_ENTRY: reach}


def interleave(chain: Chain, solvers: Mapping[str, Solver], goals: Floats) -> dict[str, Calls]:
    """Solve each target with every solver before the next target.

    Other load then affects all solvers alike.

    Args:
        chain: arm to solve for.
        solvers: solvers by name.
        goals: (n, 3) [m] targets in the chain's base; the first is solved once before, unmeasured.
    """
    return _time_turns(chain, solvers, goals, ((name, range(k, k + 1)) for k in range(len(goals)) for name in solvers))


def take_turns(chain: Chain, solvers: Mapping[str, Solver], goals: Floats) -> dict[str, Calls]:
    """Solve blocks of targets with one solver after the other.

    Each block starts with another solver.

    A solver gets the successive targets of a block; its first call finds the caches as the previous solver left them,
    which is the same for all. Other load affects all solvers alike.

    Args:
        chain: arm to solve for.
        solvers: solvers by name.
        goals: (n, 3) [m] targets in the chain's base; the first is solved once before, unmeasured.
    """
    return _time_turns(chain, solvers, goals, _list_turns(list(solvers), len(goals)))


def _list_turns(names: list[str], count: int) -> Iterator[tuple[str, range]]:
    """Yield solver names and blocks of targets, alternating between solvers.

    Each block starts with another solver.
    """
    for turn, first in enumerate(range(0, count, BLOCK_SIZE)):
        start = turn % len(names)
        for name in names[start:] + names[:start]:
            yield name, range(first, min(first + BLOCK_SIZE, count))


def _time_turns(
    chain: Chain, solvers: Mapping[str, Solver], goals: Floats, turns: Iterable[tuple[str, range]]
) -> dict[str, Calls]:
    """Return durations and successes of all IK calls, by solver."""
    seconds, reached = ({name: np.empty(len(goals)) for name in solvers} for _ in range(2))
    for solver in solvers.values():
        solver(goals[0])
    for name, block in turns:
        solver, solutions = solvers[name], []
        for k in block:
            target = goals[k]
            began = perf_counter()
            solutions.append(solver(target))
            seconds[name][k] = perf_counter() - began
        reached[name][block] = [
            _is_reached(chain, angles, goals[k]) for k, angles in zip(block, solutions, strict=True)
        ]
    return {name: Calls(seconds[name], reached[name]) for name in solvers}


def _is_reached(chain: Chain, angles: Floats, target: Floats) -> bool:
    inside = np.all(angles >= chain.lower - LIMIT_SLACK) and np.all(angles <= chain.upper + LIMIT_SLACK)
    return bool(inside and np.linalg.norm(chain.hand(angles) - target) < MAX_ERROR)


def _describe_version(peer: Peer) -> str:
    """Return the IK library's version, or how to install it."""
    if is_installed(peer):
        return f"{peer.package} {version(peer.package)}"
    return f"{peer.package} is not installed: {install_extra('bench')}"


def _own_metrics(calls: Mapping[str, Calls], why: str) -> list[Metric]:
    return [metric for name in (SOLVE_ENTRY, REACH_ENTRY) for metric in _call_metrics(name, calls.get(name), why)]


def _metrics(peer: Peer, calls: Mapping[str, Calls], why: str) -> list[Metric]:
    ratios = [_ratio(peer, "ratio", entry, calls, why) for entry in (SOLVE_ENTRY, REACH_ENTRY)]
    return [*_call_metrics(peer.name, calls.get(peer.name), why), *ratios]


def _compute_all_ratios(peer: Peer, rounds: Mapping[str, Calls], cold: Mapping[str, Calls], why: str) -> list[Metric]:
    """Return time ratios measured with all IK libraries in one process.

    Call by call, every call finds cold caches.
    """
    return [
        _ratio(peer, kind, entry, calls, why)
        for kind, calls in (("one_round", rounds), ("cold_caches", cold))
        for entry in (SOLVE_ENTRY, REACH_ENTRY)
    ]


def _ratio(peer: Peer, kind: str, entry: str, calls: Mapping[str, Calls], why: str) -> Metric:
    name, peer_calls = f"ik.peer_{peer.name}_{kind}_{entry.removeprefix('kinesic_')}", calls.get(peer.name)
    ratio = peer_calls.microseconds / calls[entry].microseconds if peer_calls else None
    return Metric(name, ratio, "x ours", MIN_RATIOS.get((peer.name, kind, entry)), "higher", why)


def _call_metrics(name: str, calls: Calls | None, why: str) -> list[Metric]:
    return [
        Metric(f"ik.peer_{name}_us", calls.microseconds if calls else None, "us", None, "lower", why),
        Metric(f"ik.peer_{name}_success", float(calls.reached.mean()) if calls else None, "share", None, "higher", why),
    ]


def draw(values: Mapping[str, float], path: Path) -> Path:
    """Draw the solve times and success rates of all measured libraries.

    Args:
        values: metric values by name, as listed by `kinesic bench ik --json`; others are ignored.
        path: path of the PNG file.

    Returns:
        The path.
    """
    candidates = (*ENTRY_LABELS, *(peer.name for peer in PEER_LIBRARIES))
    names = [name for name in candidates if f"ik.peer_{name}_us" in values]
    labels = [ENTRY_LABELS.get(name, name) for name in names]
    colours = [MAIN_COLOUR if name in ENTRY_LABELS else OTHER_COLOUR for name in names]
    medians = [values[f"ik.peer_{name}_us"] for name in names]
    percents = [100 * values[f"ik.peer_{name}_success"] for name in names]
    with picture(path, 11.0, 1.2 + 0.34 * len(names)) as drawn:
        time, success = drawn.subplots(1, 2, sharey=True)
        time.barh(labels, medians, color=colours)
        time.set_xscale("log")
        label_axes(time, "median of one call [µs]")
        success.barh(labels, percents, color=colours)
        success.set_xlim(90, 100.5)
        label_axes(success, "targets below 1 mm [%]")
        for row, (median, reached) in enumerate(zip(medians, percents, strict=True)):
            time.text(median, row, f" {median:.3g}", va="center", fontsize=LABEL_SIZE, color=INK_COLOUR)
            success.text(reached, row, f" {reached:.1f}", va="center", fontsize=LABEL_SIZE, color=INK_COLOUR)
        time.invert_yaxis()
        time.margins(x=0.15)
    return path
