"""Finds gestures so near to one another that their strokes would move far apart, and with them all that is about.

What a hand needs from one stroke to the next depends on its joint angles, so that it shows only after these are known.
An estimate says which neighbours may lack time: every hinge rests where it turns round. For these alone key times are
searched exactly, for the hinges of the hand alone, so that a quick plan and a better one come to the same verdict.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kinesic.bml.block import Gesture, Pointing
from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.engaged import Clashes
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.condition import condition
from kinesic.motion.double_s import least_rest_times
from kinesic.motion.key_time_lp import KeyTimeProblem, relax_key_times
from kinesic.motion.key_times import Gaps, full_speed
from kinesic.motion.keys import HOLD, Choices, KeyPosture, Keys, Pair
from kinesic.planning.setup import Setup

APART = 0.2  # [s] by which two strokes may move apart; more is seen beside a word


@dataclass(frozen=True, eq=False)
class _Neighbours:
    """Two gestures that follow one another on a hand."""

    behaviours: tuple[str, str]
    strokes: Pair  # their keys
    hinges: Choices  # of the hands that do both

    def moved_apart(self, keys: Keys, times: Floats) -> float:
        """By how much the strokes are farther apart than asked [s], at times (m,) [s] of the keys."""
        first, second = self.strokes
        return float((times - keys.asked)[second] - (times - keys.asked)[first])


def find_clashes(
    frames: KeyFrames, postures: Sequence[KeyPosture], setup: Setup, known: Collection[frozenset[str]] = ()
) -> Clashes:
    """Finds neighbours whose strokes would have to move apart by more than `APART`.

    Of neighbours that share a gesture only the worst counts: when one of these has given way, the others may have
    time.

    Args:
        frames: of a block.
        postures: that solve them.
        setup: robot and limits.
        known: pairs of behaviours that were found before.
    """
    coming = [each for each in _neighbours(frames, postures, setup) if frozenset(each.behaviours) not in known]
    if not coming:
        return {}
    keys = Keys.of(postures, setup.limits)
    times = relax_key_times(KeyTimeProblem(keys, _gaps(keys), lead_in=0.0))
    apart = {each.behaviours: each.moved_apart(keys, times) for each in coming}
    found: dict[frozenset[str], float] = {}
    for each in sorted(coming, key=lambda each: -apart[each.behaviours]):
        settled = any(id in pair for pair in found for id in each.behaviours)
        if apart[each.behaviours] > APART and not settled and (exactly := _search(each, postures, setup)) > APART:
            found[frozenset(each.behaviours)] = exactly
    return found


def least_times_between_turns(keys: Keys) -> Gaps:
    """Computes the time [s] in which each hinge can rest at both ends of each way that it goes in one direction.

    That is mostly more than it needs, as it may turn round while it brakes.
    """
    ways = [(hinge, pair) for hinge, own in enumerate(keys.own) for pair in _ways(keys.angles[own, hinge], own)]
    turns = np.zeros((len(ways), keys.angles.shape[1]))
    for row, (hinge, (i, j)) in enumerate(ways):
        turns[row, hinge] = keys.angles[j, hinge] - keys.angles[i, hinge]
    least = least_rest_times(turns, keys.limits)
    return {(hinge, pair): float(least[row, hinge]) for row, (hinge, pair) in enumerate(ways)}


def _gaps(keys: Keys) -> dict[Pair, float]:
    """Least times between keys [s]: rests where hinges turn round, full speed in between."""
    gaps = dict(keys.gaps)
    for found in (full_speed(keys, keys.limits), least_times_between_turns(keys)):
        for (_, pair), least in found.items():
            gaps[pair] = max(gaps.get(pair, 0.0), least)
    return gaps


def _ways(angles: Floats, rows: Sequence[int]) -> list[Pair]:
    """The keys between which a hinge goes on in one direction, or is held, from its angles (k,) [rad] at some rows."""
    steps = np.diff(angles)
    ways = np.where(np.abs(steps) < HOLD, 0.0, np.sign(steps))
    ends = [0, *(np.flatnonzero(np.diff(ways)) + 1).tolist(), len(steps)]
    return [(rows[i], rows[j]) for i, j in pairwise(ends) if i < j]


def _neighbours(frames: KeyFrames, postures: Sequence[KeyPosture], setup: Setup) -> list[_Neighbours]:
    """Gestures of each hand, two by two in the order of their strokes."""
    row_of = {sync: row for row, posture in enumerate(postures) for sync in posture.syncs}
    gestures = [one.behaviour for one in frames.timeline.timed if isinstance(one.behaviour.action, Gesture | Pointing)]
    moving = [gesture.id for gesture in gestures if (gesture.id, "stroke") in row_of]
    sides: dict[tuple[str, str], list[int]] = {}
    for side in SIDES:
        own = [id for id in moving if f"{side}_hand" in frames.uses[id]]
        for pair in pairwise(sorted(own, key=lambda id: row_of[id, "stroke"])):
            sides.setdefault(pair, []).extend(setup.robot.arm(side).joints)
    return [
        _Neighbours((a, b), (row_of[a, "stroke"], row_of[b, "stroke"]), np.array(hinges, dtype=np.intp))
        for (a, b), hinges in sides.items()
    ]


def _search(pair: _Neighbours, postures: Sequence[KeyPosture], setup: Setup) -> float:
    """By how much two strokes move apart [s] when nothing but their hands moves, from rest before to rest after."""
    keyed = np.array([any(posture.keyed[hinge] for hinge in pair.hinges) for posture in postures])
    begin, end = _around(pair, postures, keyed)
    rows = [row for row in range(begin, end + 1) if keyed[row]]
    part = tuple(_part(postures[row], pair.hinges, whole=row in (begin, end)) for row in rows)
    times = condition(part, setup.limits.part(pair.hinges)).planned
    first, second = (rows.index(row) for row in pair.strokes)
    asked = [posture.time for posture in part]
    return float(times[second] - times[first] - (asked[second] - asked[first]))


def _around(pair: _Neighbours, postures: Sequence[KeyPosture], keyed: Flags) -> Pair:
    """The keys of a hand at which the first of two gestures begins and the second has ended, or the nearest without."""
    rows = [
        row
        for row, posture in enumerate(postures)
        if any(behaviour in pair.behaviours for behaviour, _ in posture.syncs)
    ]
    own = np.flatnonzero(keyed & np.array([posture.firm for posture in postures]))
    before, after = own[own <= min(rows)], own[own >= max(rows)]
    return int(before[-1] if before.size else own[0]), int(after[0] if after.size else own[-1])


def _part(posture: KeyPosture, hinges: Choices, *, whole: bool) -> KeyPosture:
    """Some hinges of a key, all of them keyed if it is to be whole."""
    keyed = tuple(whole or posture.keyed[hinge] for hinge in hinges)
    passages = tuple(posture.passages[hinge] for hinge in hinges) if posture.passages else ()
    return KeyPosture(posture.time, sealed(posture.angles[hinges]), keyed, posture.syncs, passages, posture.firm)
