"""Keeps a motion clear of the body: detours first, then the name of the behaviour that must go."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import Robot
from kinesic.controller.condition import Conditioned, condition
from kinesic.controller.detour import detour, scan
from kinesic.controller.facts import Facts
from kinesic.controller.postures import Posture, Postures
from kinesic.controller.syncs import on_keys
from kinesic.controller.trajectory import held
from kinesic.expressivity.keyframes import KeyFrames

LAG_RESERVE = 0.004  # [m] kept in the plan for what the servos lag behind it
DETOURS = 6  # tried before a behaviour is dropped


def cleared(solved: Postures, facts: Facts) -> tuple[Postures, Conditioned, Floats, Clearance]:
    """Conditions the postures, and leads the motion around the body where it comes too near."""
    keys = solved.postures
    motion = _condition(keys, facts)
    times, clearance = scan(motion.trajectory, facts.distances)
    for _ in range(DETOURS):
        worst = clearance.worst
        if clearance.distances[worst] >= facts.robot.least_clearance + LAG_RESERVE:
            break
        at = float(times[worst] - motion.trajectory.zero)
        around = detour(keys, motion, at, clearance.pairs[worst], facts.robot, facts.distances)
        if around is None:
            break
        keys = around
        motion = _condition(keys, facts)
        times, clearance = scan(motion.trajectory, facts.distances)
    return Postures(keys, solved.misses), motion, times, clearance


def _condition(keys: tuple[Posture, ...], facts: Facts) -> Conditioned:
    if len(keys) < 2:
        still = held(facts.robot.skeleton.rest)
        return Conditioned(still, np.zeros(0), np.zeros(0), {})
    return condition(keys, facts.limits, facts.manner)


def culprits(
    frames: KeyFrames, motion: Conditioned, times: Floats, clearance: Clearance, robot: Robot
) -> dict[str, str]:
    """The behaviour that brings two segments too near, and why; empty when the motion is clear."""
    worst = clearance.worst
    distance = float(clearance.distances[worst])
    if distance >= robot.least_clearance + LAG_RESERVE or not frames.frames:
        return {}
    at = float(times[worst] - motion.trajectory.zero)
    pair = clearance.pairs[worst]
    parts = {f"{side}_hand" for side in ("l", "r") if set(pair) & set(robot.chains[f"{side}_arm"])} or {"torso", "head"}
    why = f"brings {pair[0]} within {1000 * distance:.0f} mm of {pair[1]} at {at:.2f} s"
    spans_of = _planned_spans(frames, motion)
    near = {
        name: max(start - at, at - end, 0.0)
        for name, (start, end) in spans_of.items()
        if frames.uses.get(name, frozenset()) & parts
    }
    return {min(near, key=lambda name: near[name]): why} if near else {min(spans_of): why}


def _planned_spans(frames: KeyFrames, motion: Conditioned) -> dict[str, tuple[float, float]]:
    """First and last planned time of each moving behaviour."""
    found: dict[str, tuple[float, float]] = {}
    for name, _, _, time in on_keys(frames, motion):
        low, high = found.get(name, (time, time))
        found[name] = (min(low, time), max(high, time))
    return found
