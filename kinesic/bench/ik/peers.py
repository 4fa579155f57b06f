"""Compares other IK libraries with ours on upper22's left arm: same targets, one process, in turn.

A call goes from three numbers to the angles. What one library leaves in the processor's caches slows the next one's
call, so it is measured three times: each peer with ours alone, call by call; all in one round, each with a block of
targets in a row; and all call by call, where every call finds the caches cold. Success is counted by the body's own
forward kinematics: the hand within a millimetre, every hinge within its limits. Drawn as bars: the time of one reach,
and how many targets are reached.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.random import default_rng

from kinesic.bench.figure import INK, OTHERS, OURS, SMALL, Figure, label_axes, picture
from kinesic.bench.ik.arms import targets
from kinesic.bench.ik.peer_solvers import PEERS, Peer, Solver
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik import KERNEL
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.solve import solve

TARGETS, BLOCK = 200, 25  # of these so many in a row go to one library in a round
MM = 1e-3  # [m] where the hand counts as there
SLACK = 1e-6  # [rad] outside a limit that is forgiven to a peer's rounding
SOLVE, REACH = "kinesic_solve", "kinesic_reach"  # our entries
GOALS = {
    ("roboticstoolbox", "ratio", SOLVE): 5.0,
    ("roboticstoolbox", "ratio", REACH): 7.0,
    ("roboticstoolbox", "one_round", SOLVE): 10.0,
    ("roboticstoolbox", "one_round", REACH): 7.0,
}
NAMES = {"kinesic_reach": "kinesic, Arm.reach", "kinesic_solve": "kinesic, solve"}


@dataclass(frozen=True, eq=False)
class Calls:
    """What one solver did with all targets."""

    seconds: Floats  # (n,)
    reached: Floats  # (n,) 1 where the hand is there and the limits hold

    @property
    def microseconds(self) -> float:
        """The median call."""
        return 1e6 * float(np.median(self.seconds))


def bench() -> list[Figure]:
    """Measures times, successes and how many times as long as ours each peer takes."""
    if KERNEL == "numpy":
        why = "the kernel is not compiled here"
        return [
            *_own({}, why),
            *(figure for peer in PEERS for figure in [*_figures(peer, {}, why), *_all(peer, {}, {}, why)]),
        ]
    chain = Robot.load().arms["l"]
    goals = targets(default_rng(33), chain, TARGETS)
    figures = _own(interleave(chain, ours(chain), goals), "beside no peer")
    theirs = {peer.name: peer.build(chain) for peer in PEERS if installed(peer)}
    for peer in PEERS:
        pair = ours(chain) | {peer.name: theirs[peer.name]} if installed(peer) else {}
        figures += _figures(peer, interleave(chain, pair, goals), _why(peer))
    everyone = ours(chain) | theirs
    rounds, cold = take_turns(chain, everyone, goals), interleave(chain, everyone, goals)
    for peer in PEERS:
        why = f"with {len(theirs) - 1} other libraries in turn" if installed(peer) else _why(peer)
        figures += _all(peer, rounds, cold, why)
    return figures


def installed(peer: Peer) -> bool:
    """Whether everything is there that it needs."""
    return all(find_spec(module) is not None for module in peer.needs)


def ours(chain: Chain) -> dict[str, Solver]:
    """Makes kinesic's two entries in the comparison: `solve`, and the arm's `reach` that writes into a buffer."""
    arm = arm_of(chain)

    def reach(target: Floats) -> Floats:
        angles = chain.rest.copy()
        arm.reach(target, angles)
        return angles

    return {SOLVE: lambda target: solve(chain, Reach(target), start=chain.rest).angles, REACH: reach}


def interleave(chain: Chain, solvers: Mapping[str, Solver], goals: Floats) -> dict[str, Calls]:
    """Gives each target to every solver before the next one, so that a busy moment falls on none alone.

    Args:
        chain: the arm.
        solvers: by name.
        goals: (n, 3) [m] in the chain's base; the first is solved once more before, unmeasured.
    """
    return _timed(chain, solvers, goals, ((name, range(k, k + 1)) for k in range(len(goals)) for name in solvers))


def take_turns(chain: Chain, solvers: Mapping[str, Solver], goals: Floats) -> dict[str, Calls]:
    """Gives a block of targets to one solver after the other, then the next block, each time another solver first.

    A solver has its calls of a block in a row, the first of them with what the solver before left in the caches: it is
    counted for all alike. A busy moment falls on none alone.

    Args:
        chain: the arm.
        solvers: by name.
        goals: (n, 3) [m] in the chain's base; the first is solved once more before, unmeasured.
    """
    return _timed(chain, solvers, goals, _turns(list(solvers), len(goals)))


def _turns(names: list[str], count: int) -> Iterator[tuple[str, range]]:
    """Lists whose turn it is with which of so many targets, beginning each time with another one."""
    for turn, first in enumerate(range(0, count, BLOCK)):
        start = turn % len(names)
        for name in names[start:] + names[:start]:
            yield name, range(first, min(first + BLOCK, count))


def _timed(
    chain: Chain, solvers: Mapping[str, Solver], goals: Floats, turns: Iterable[tuple[str, range]]
) -> dict[str, Calls]:
    """Times each call of a turn, and looks only after the turn at what was reached."""
    seconds, reached = ({name: np.empty(len(goals)) for name in solvers} for _ in range(2))
    for solver in solvers.values():
        solver(goals[0])
    for name, block in turns:
        solver, found = solvers[name], []
        for k in block:
            target = goals[k]
            began = perf_counter()
            found.append(solver(target))
            seconds[name][k] = perf_counter() - began
        reached[name][block] = [_reached(chain, angles, goals[k]) for k, angles in zip(block, found, strict=True)]
    return {name: Calls(seconds[name], reached[name]) for name in solvers}


def _reached(chain: Chain, angles: Floats, target: Floats) -> bool:
    inside = np.all(angles >= chain.lower - SLACK) and np.all(angles <= chain.upper + SLACK)
    return bool(inside and np.linalg.norm(chain.hand(angles) - target) < MM)


def _why(peer: Peer) -> str:
    """Its version, or how it would get one."""
    if installed(peer):
        return f"{peer.package} {version(peer.package)}"
    return f"{peer.package} is not installed: pip install kinesic[bench]"


def _own(calls: Mapping[str, Calls], why: str) -> list[Figure]:
    return [figure for name in (SOLVE, REACH) for figure in _measured(name, calls.get(name), why)]


def _figures(peer: Peer, calls: Mapping[str, Calls], why: str) -> list[Figure]:
    ratios = [_ratio(peer, "ratio", entry, calls, why) for entry in (SOLVE, REACH)]
    return [*_measured(peer.name, calls.get(peer.name), why), *ratios]


def _all(peer: Peer, rounds: Mapping[str, Calls], cold: Mapping[str, Calls], why: str) -> list[Figure]:
    """The ratios with all libraries in turn: by blocks of targets, and call by call, which finds the caches cold."""
    return [
        _ratio(peer, kind, entry, calls, why)
        for kind, calls in (("one_round", rounds), ("cold_caches", cold))
        for entry in (SOLVE, REACH)
    ]


def _ratio(peer: Peer, kind: str, entry: str, calls: Mapping[str, Calls], why: str) -> Figure:
    name, theirs = f"ik.peer_{peer.name}_{kind}_{entry.removeprefix('kinesic_')}", calls.get(peer.name)
    ratio = theirs.microseconds / calls[entry].microseconds if theirs else None
    return Figure(name, ratio, "x ours", GOALS.get((peer.name, kind, entry)), "higher", why)


def _measured(name: str, calls: Calls | None, why: str) -> list[Figure]:
    return [
        Figure(f"ik.peer_{name}_us", calls.microseconds if calls else None, "us", None, "lower", why),
        Figure(f"ik.peer_{name}_success", float(calls.reached.mean()) if calls else None, "share", None, "higher", why),
    ]


def draw(values: Mapping[str, float], path: Path) -> Path:
    """Draws the libraries that were measured.

    Args:
        values: figures by name, as `kinesic bench ik --json` lists them; others are ignored.
        path: of the picture, PNG.

    Returns:
        The path.
    """
    known = (*NAMES, *(peer.name for peer in PEERS))
    names = [name for name in known if f"ik.peer_{name}_us" in values]
    labels = [NAMES.get(name, name) for name in names]
    colours = [OURS if name in NAMES else OTHERS for name in names]
    medians = [values[f"ik.peer_{name}_us"] for name in names]
    shares = [100 * values[f"ik.peer_{name}_success"] for name in names]
    with picture(path, 11.0, 1.2 + 0.34 * len(names)) as drawn:
        time, share = drawn.subplots(1, 2, sharey=True)
        time.barh(labels, medians, color=colours)
        time.set_xscale("log")
        label_axes(time, "median of one call [µs]")
        share.barh(labels, shares, color=colours)
        share.set_xlim(90, 100.5)
        label_axes(share, "targets below 1 mm [%]")
        for row, (median, reached) in enumerate(zip(medians, shares, strict=True)):
            time.text(median, row, f" {median:.3g}", va="center", fontsize=SMALL, color=INK)
            share.text(reached, row, f" {reached:.1f}", va="center", fontsize=SMALL, color=INK)
        time.invert_yaxis()
        time.margins(x=0.15)
    return path
