"""Key postures, and the same as arrays: what each hinge passes, how, and what it costs to move a key in time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.easing import Easing
from kinesic.motion.passage import PLAIN, Passage

Choices = NDArray[np.intp]
Sync = tuple[str, str]  # behaviour id, sync point
Pair = tuple[int, int]  # two keys, the earlier first

EASINGS: tuple[Easing, ...] = get_args(Easing)
SMOOTHEST = EASINGS.index(PLAIN.easing)

LEAST_GAP = 0.02  # [s] between keys
TURNING_ROOM = 1e-3  # [rad] so that control points may lie beyond a key at the end of a range
HOLD = 1e-9  # [rad] keys nearer than this are a hold
SAME = 1e-6  # [s]
WEIGHTS = {"strokeStart": 5.0, "stroke": 5.0, "strokeEnd": 0.5, "ready": 0.3, "relax": 0.3}
WEIGHT_AGAIN = 0.3  # of strokes after the first, which keeps its time before all others
WEIGHT_ELSE = 0.05


@dataclass(frozen=True, eq=False)
class KeyPosture:
    """Joint angles at one key time; only `keyed` hinges have a key here, the others pass through."""

    time: float  # [s] block time
    angles: Floats  # (n,) [rad]
    keyed: tuple[bool, ...]  # (n,)
    syncs: tuple[tuple[str, str], ...] = ()  # (behaviour id, sync point)
    passages: tuple[Passage, ...] = ()  # (n,) how each hinge passes, and comes to, this key; all plainly where empty
    firm: bool = True  # passed exactly; else on a path, which the motion only follows as far as it can

    @classmethod
    def whole(cls, time: float, angles: Sequence[float] | Floats) -> "KeyPosture":
        """A key of all hinges: (n,) [rad] at a time [s]."""
        return cls(time, sealed(np.array(angles, dtype=np.float64)), (True,) * len(angles))


@dataclass(frozen=True)
class Bond:
    """One sync point comes at least a while after another."""

    earlier: Sync
    later: Sync
    least: float  # [s]


@dataclass(frozen=True, eq=False)
class Waypoints:
    """Keys of all hinges, without their times."""

    angles: Floats  # (m, n) [rad]
    keyed: Flags  # (m, n) which hinges have a key where
    tension: Floats  # (m, n) -1..1
    continuity: Floats  # (m, n) -1..0
    bias: Floats  # (m, n) -1..1
    easing: Choices  # (m, n) of `EASINGS`, on the way to the key
    steepness: Floats  # (m, n) 1..8
    limits: Limits  # of the hinges

    @classmethod
    def of(cls, postures: Sequence[KeyPosture], limits: Limits, *, room: Floats | float = 0.0) -> "Waypoints":
        """Keys of postures, those at the ends of the ranges moved in by some room (n,) [rad]."""
        angles = np.clip([posture.angles for posture in postures], limits.lower + room, limits.upper - room)
        keyed = np.array([posture.keyed for posture in postures], dtype=np.bool_)
        manners = np.array([_manners(posture.passages, keyed.shape[1]) for posture in postures])
        tension, continuity, bias, steepness, easing = manners.transpose(1, 0, 2)
        return cls(sealed(angles), keyed, tension, continuity, bias, easing.astype(np.intp), steepness, limits)

    def part(self, rows: Choices, hinges: Choices) -> "Waypoints":
        """Some keys of some hinges."""
        part = rows[:, None], hinges
        return Waypoints(
            self.angles[part],
            self.keyed[part],
            self.tension[part],
            self.continuity[part],
            self.bias[part],
            self.easing[part],
            self.steepness[part],
            self.limits.part(hinges),
        )

    @classmethod
    def plain(cls, angles: Floats, keyed: Flags, limits: Limits, *, tension: float = 0.0) -> "Waypoints":
        """Keys that are all passed in one way."""
        none = np.zeros(angles.shape)
        easing = np.full(angles.shape, SMOOTHEST)
        return cls(angles, keyed, none + tension, none, none, easing, none + PLAIN.steepness, limits)


@lru_cache(maxsize=256)
def _manners(passages: tuple[Passage, ...], count: int) -> Floats:
    """(5, count) tension, continuity, bias, steepness and easing of each hinge; plain where none are told."""
    told = passages or (PLAIN,) * count
    rows = [[p.tension, p.continuity, p.bias, p.steepness, EASINGS.index(p.easing)] for p in told]
    return sealed(np.transpose(rows))


@dataclass(frozen=True, eq=False)
class Keys:
    """Postures as arrays."""

    asked: Floats  # (m,) [s] block time
    waypoints: Waypoints  # what is passed, and how
    firm: Flags  # (m,) which are passed exactly; the others lie between them in time
    weights: Floats  # (m,) of moving a key, per second
    gaps: Mapping[Pair, float]  # [s] least time between keys that follow one another in a hinge or a behaviour
    bonds: Mapping[Pair, float]  # [s] least time from one key to another, either order, that BML asks for

    @classmethod
    def of(cls, postures: tuple[KeyPosture, ...], limits: Limits, bonds: tuple[Bond, ...] = ()) -> "Keys":
        """Keys weigh as their heaviest sync point, and keep room to turn back at the ends of a hinge's range."""
        room = np.minimum(TURNING_ROOM, (limits.upper - limits.lower) / 2)
        waypoints = Waypoints.of(postures, limits, room=room)
        firm = np.array([posture.firm for posture in postures], dtype=np.bool_)
        row_of = {sync: row for row, posture in enumerate(postures) for sync in posture.syncs}
        ties = {
            (row_of[bond.earlier], row_of[bond.later]): bond.least
            for bond in bonds
            if bond.earlier in row_of and bond.later in row_of and row_of[bond.earlier] != row_of[bond.later]
        }
        return cls(
            sealed([posture.time for posture in postures]),
            waypoints,
            firm,
            sealed([_weight(posture) for posture in postures]),
            dict.fromkeys(_followers(postures, waypoints.keyed, firm), LEAST_GAP),
            ties,
        )

    @property
    def angles(self) -> Floats:
        """(m, n) [rad]."""
        return self.waypoints.angles

    @property
    def keyed(self) -> Flags:
        """(m, n)."""
        return self.waypoints.keyed

    @property
    def spaced(self) -> bool:
        """Whether the asked times leave a gap between keys of the same hinge or behaviour."""
        return all(self.asked[j] - self.asked[i] >= gap - SAME for (i, j), gap in self.gaps.items())

    @cached_property
    def own(self) -> tuple[list[int], ...]:
        """Firm keys of each hinge, in order."""
        return tuple(np.flatnonzero(column & self.firm).tolist() for column in self.keyed.T)

    def led(self, hinge: int) -> Flags:
        """(k - 1,) whether a path leads a hinge from one of its k firm keys to the next."""
        return np.diff(np.flatnonzero(self.firm[self.keyed[:, hinge]])) > 1

    def spread(self, times: Floats) -> Floats:
        """(m,) [s] times with those of keys on a path in between the firm ones, as evenly as asked."""
        return np.where(self.firm, times, np.interp(self.asked, self.asked[self.firm], times[self.firm]))

    def holds(self, pair: Pair, hinge: int) -> bool:
        """Whether a hinge stays where it is between two keys, or the two are one."""
        return bool(abs(self.angles[pair[0], hinge] - self.angles[pair[1], hinge]) < HOLD)


def _followers(postures: tuple[KeyPosture, ...], keyed: Flags, firm: Flags) -> set[Pair]:
    """Firm keys that follow one another in some hinge or in some behaviour; and all in whose time a hinge is on a path.

    So the times of keys on paths can lie in between.
    """
    columns = np.unique(keyed, axis=1).T
    chains = [np.flatnonzero(column & firm).tolist() for column in columns]
    chains += [_with_paths(column, firm) for column in columns]
    behaviours: dict[str, list[int]] = {}
    for row, posture in enumerate(postures):
        for behaviour in sorted({behaviour for behaviour, _ in posture.syncs}):
            behaviours.setdefault(behaviour, []).append(row)
    return {pair for chain in [*chains, *behaviours.values()] for pair in pairwise(chain)}


def _with_paths(column: Flags, firm: Flags) -> list[int]:
    """The firm keys of a hinge with those of others that fall on its paths."""
    own, others = np.flatnonzero(column & firm), np.flatnonzero(firm)
    chain = own.tolist()
    for k in np.flatnonzero(np.diff(np.flatnonzero(firm[column])) > 1):
        chain += others[(others > own[k]) & (others < own[k + 1])].tolist()
    return sorted(chain)


def _weight(posture: KeyPosture) -> float:
    if not posture.firm:
        return 0.0
    again = {sync: WEIGHT_AGAIN for _, sync in posture.syncs if sync.startswith("stroke:")}
    return max([WEIGHT_ELSE, *((WEIGHTS | again).get(sync, WEIGHT_ELSE) for _, sync in posture.syncs)])
