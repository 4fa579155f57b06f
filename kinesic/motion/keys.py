"""Key postures, how each is passed, and the same as arrays, with what it costs to move a key in time."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import TypeVar, get_args

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.easing import Easing

Choices = NDArray[np.intp]
Sync = tuple[str, str]  # behaviour id, sync point
Pair = tuple[int, int]  # two keys, the earlier first
Amount = TypeVar("Amount", float, Floats)
Found = TypeVar("Found")

EASINGS: tuple[Easing, ...] = get_args(Easing)
SMOOTHEST = EASINGS.index("minimum_jerk")
ACCENT: Easing = "out_power"  # of a way with an accent: most of the speed at its beginning
LATE_ACCENT: Easing = "late"  # likewise, at its end
OVERSHOOTING: tuple[Easing, ...] = ("out_back", "out_bounce")
FORCED = 2.5  # steepness of a way that power alone forces
SOFTEST, STEEPEST = 1.0, 8.0
RANGES: Mapping[str, tuple[float, float]] = {
    "tension": (-1.0, 1.0),
    "continuity": (-1.0, 0.0),
    "bias": (-1.0, 1.0),
    "steepness": (SOFTEST, STEEPEST),
    "swing": (0.0, 1.0),
}
SWUNG = 1.5  # of the usual speed at a key, what a full swing adds to it
EVEN = 3.3  # steepness with which the linear easing has the peak speed of minimum jerk

LEAST_GAP = 0.02  # [s] between keys
LEAST_APART = 0.002  # [s] between keys that have only the path of another hinge in common
TURNING_ROOM = 1e-3  # [rad] so that control points may lie beyond a key at the end of a range
HOLD = 1e-9  # [rad] keys nearer than this are a hold
SAME = 1e-6  # [s]
WEIGHTS = {"strokeStart": 5.0, "stroke": 5.0, "strokeEnd": 0.5, "ready": 0.3, "relax": 0.3}
WEIGHT_AGAIN = 0.3  # of strokes after the first, which keeps its time before all others
WEIGHT_ELSE = 0.05


def flow(tension: Amount, continuity: Amount, swing: Amount) -> Amount:
    """How much of its speed is kept at a key: 0 stops, 1 runs through; a swing adds to it, full tension takes all."""
    stiff = tension * (tension > 0.0)
    return (1.0 - tension) * (1.0 + continuity) + SWUNG * (1.0 - stiff) * swing


@dataclass(frozen=True)
class KeyPassage:
    """How one key is passed (Kochanek and Bartels 1984), and how the way to it is moved.

    Raises:
        ValueError: a number outside its range, which is named.
    """

    tension: float = 0.0  # -1 swings out .. 1 stops at the key
    continuity: float = 0.0  # -1 stops at the key .. 0 runs through; above 0 speeds would jump, which no servo can
    bias: float = 0.0  # -1 turns to the next key already .. 1 follows the way it came
    easing: Easing = "minimum_jerk"  # of the way to the key
    steepness: float = 4.0  # of that easing: 1 begins as softly as minimum jerk .. 8 nearly at once
    swing: float = 0.0  # 0 stays between the keys .. 1 swings on through the key as far as the range goes

    def __post_init__(self) -> None:
        for name, (least, most) in RANGES.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise ValueError(f"{name} is {value:g}, outside [{least:g}, {most:g}]")

    @property
    def calm(self) -> "KeyPassage":
        """The same without swing and accent; what overshoots does so no more steeply than full power makes it.

        An accent at the end of the way, which a word needs, stays: it leaves the way as it is.
        """
        return _calm(self)

    @property
    def flow(self) -> float:
        """How much of its speed is kept at the key: 0 stops, 1 runs through, a swing gives more."""
        return flow(self.tension, self.continuity, self.swing)


PLAIN_PASSAGE = KeyPassage()


@lru_cache(maxsize=1024)
def _calm(passage: KeyPassage) -> KeyPassage:
    if passage.easing in OVERSHOOTING:
        return replace(passage, swing=0.0, steepness=min(passage.steepness, FORCED))
    return replace(passage, swing=0.0, easing="minimum_jerk" if passage.easing == ACCENT else passage.easing)


@dataclass(frozen=True, eq=False)
class KeyPosture:
    """Joint angles at one key time; only `keyed` hinges have a key here, the others pass through."""

    time: float  # [s] block time
    angles: Floats  # (n,) [rad]
    keyed: tuple[bool, ...]  # (n,)
    syncs: tuple[Sync, ...] = ()
    passages: tuple[KeyPassage, ...] = ()  # (n,) how each hinge passes, and comes to, this key; all plainly where empty
    firm: bool = True  # passed exactly; else on a path, which the motion only follows as far as it can

    @cached_property
    def manner(self) -> Floats:
        """(6, n) `passages` as numbers, one row for each of `Keys.manner`; the plain ones where there are none."""
        return _manner(self.passages, len(self.angles))

    @classmethod
    def whole(cls, time: float, angles: Sequence[float] | Floats) -> "KeyPosture":
        """Makes a key of all hinges: (n,) [rad] at a time [s]."""
        return cls(time, sealed(np.array(angles, dtype=np.float64)), (True,) * len(angles))


@dataclass(frozen=True)
class Bond:
    """One sync point comes at least a while after another."""

    earlier: Sync
    later: Sync
    least: float  # [s]


@dataclass(frozen=True, eq=False)
class Keys:
    """Key postures as arrays, in their order."""

    asked: Floats  # (m,) [s] block time
    angles: Floats  # (m, n) [rad]
    keyed: Flags  # (m, n) which hinges have a key where
    manner: Floats  # (6, m, n) tension, continuity, bias, steepness, place in `EASINGS` and swing: of each `Passage`
    firm: Flags  # (m,) which are passed exactly; the others lie between them in time
    syncs: tuple[tuple[Sync, ...], ...]  # (m,) sync points that fall on each
    limits: Limits  # of the hinges
    bonds: Mapping[Pair, float] = field(default_factory=dict)  # [s] least time between two keys, that BML asks for

    @classmethod
    def of(
        cls,
        postures: Sequence[KeyPosture],
        limits: Limits,
        bonds: Sequence[Bond] = (),
        *,
        room: float = TURNING_ROOM,
    ) -> "Keys":
        """Puts postures together as arrays.

        Args:
            postures: in the order of their times.
            limits: of the hinges, into whose ranges the postures are clipped.
            bonds: between sync points; those without a key are left out.
            room: [rad] that keys keep from the ends of a range.
        """
        return _join_postures(tuple(postures), limits, tuple(bonds), room)

    def part(self, rows: Choices, hinges: Choices) -> "Keys":
        """Takes some keys of some hinges, without bonds."""
        here = rows[:, None], hinges
        return Keys(
            self.asked[rows],
            self.angles[here],
            self.keyed[here],
            self.manner[:, *here],
            self.firm[rows],
            tuple(self.syncs[row] for row in rows),
            self.limits.part(hinges),
        )

    def passed(self, passage: KeyPassage) -> "Keys":
        """Takes the firm keys alone, all of them passed in one way."""
        manner = np.broadcast_to(_manner((passage,), 1)[:, :, None], self.manner.shape)
        return replace(self, keyed=self.keyed & self.firm[:, None], manner=manner)

    @cached_property
    def weights(self) -> Floats:
        """(m,) what it costs to move each key, per second: that of its heaviest sync point, none on a path."""
        return sealed([_weight(syncs) if firm else 0.0 for syncs, firm in zip(self.syncs, self.firm, strict=True)])

    @cached_property
    def again(self) -> Flags:
        """(m,) whether a stroke is done once more at each key."""
        return np.array([any(sync.startswith("stroke:") for _, sync in syncs) for syncs in self.syncs], dtype=np.bool_)

    @cached_property
    def gaps(self) -> Mapping[Pair, float]:
        """[s] least time between keys that follow one another in a hinge or a behaviour.

        Keys of different hinges that only lie on the path of a third may stay as near as they are asked.
        """
        own, beside = _followers(self)
        asked = {(i, j): float(self.asked[j] - self.asked[i]) for i, j in beside - own}
        return dict.fromkeys(own, LEAST_GAP) | {
            pair: min(LEAST_GAP, max(gap, LEAST_APART)) for pair, gap in asked.items()
        }

    @property
    def spaced(self) -> bool:
        """Whether the asked times leave a gap between keys of the same hinge or behaviour."""
        return all(self.asked[j] - self.asked[i] >= gap - SAME for (i, j), gap in self.gaps.items())

    @cached_property
    def own(self) -> tuple[list[int], ...]:
        """(n,) rows of the firm keys of each hinge, in order."""
        return _of_columns(self.keyed, lambda column: np.flatnonzero(column & self.firm).tolist())

    def led(self, hinge: int) -> Flags:
        """(k - 1,) whether there are path keys between a hinge's k successive firm keys."""
        return self._led[hinge]

    @cached_property
    def _led(self) -> tuple[Flags, ...]:
        return _of_columns(self.keyed, lambda column: np.diff(np.flatnonzero(self.firm[column])) > 1)

    def spread(self, times: Floats) -> Floats:
        """Moves the times (m,) [s] of keys on a path in between those of the firm ones, as evenly as asked."""
        return np.where(self.firm, times, np.interp(self.asked, self.asked[self.firm], times[self.firm]))


@lru_cache(maxsize=8)  # each stage of planning asks for the same ones
def _join_postures(postures: tuple[KeyPosture, ...], limits: Limits, bonds: tuple[Bond, ...], room: float) -> Keys:
    inward = np.minimum(room, (limits.upper - limits.lower) / 2)
    angles = np.clip([posture.angles for posture in postures], limits.lower + inward, limits.upper - inward)
    row_of = {sync: row for row, posture in enumerate(postures) for sync in posture.syncs}
    return Keys(
        asked=sealed([posture.time for posture in postures]),
        angles=sealed(angles),
        keyed=np.array([posture.keyed for posture in postures], dtype=np.bool_),
        manner=np.stack([posture.manner for posture in postures], axis=1),
        firm=np.array([posture.firm for posture in postures], dtype=np.bool_),
        syncs=tuple(posture.syncs for posture in postures),
        limits=limits,
        bonds={
            (row_of[bond.earlier], row_of[bond.later]): bond.least
            for bond in bonds
            if bond.earlier in row_of and bond.later in row_of and row_of[bond.earlier] != row_of[bond.later]
        },
    )


@lru_cache(maxsize=256)
def _manner(passages: tuple[KeyPassage, ...], count: int) -> Floats:
    """(6, count) the manner in which each hinge passes one key."""
    rows = [
        (each.tension, each.continuity, each.bias, each.steepness, EASINGS.index(each.easing), each.swing)
        for each in passages or (PLAIN_PASSAGE,) * count
    ]
    return sealed(np.transpose(rows))


def _of_columns(keyed: Flags, find: Callable[[Flags], Found]) -> tuple[Found, ...]:
    """Finds something for each column (m,), once for columns that are alike, as those of most hinges of a part are."""
    every = [column.tobytes() for column in keyed.T]
    known = {told: find(column) for told, column in dict(zip(every, keyed.T, strict=True)).items()}
    return tuple(known[told] for told in every)


def _followers(keys: Keys) -> tuple[set[Pair], set[Pair]]:
    """Pairs of firm keys that follow one another in a hinge or in a behaviour, and those within a path of a hinge.

    So the times of keys on paths can lie in between.
    """
    columns = np.unique(keys.keyed, axis=1).T
    chains = [np.flatnonzero(column & keys.firm).tolist() for column in columns]
    paths = [_with_paths(column, keys.firm) for column in columns]
    behaviours: dict[str, list[int]] = {}
    for row, syncs in enumerate(keys.syncs):
        for behaviour in sorted({behaviour for behaviour, _ in syncs}):
            behaviours.setdefault(behaviour, []).append(row)
    own = {pair for chain in [*chains, *behaviours.values()] for pair in pairwise(chain)}
    return own, {pair for chain in paths for pair in pairwise(chain)}


def _with_paths(column: Flags, firm: Flags) -> list[int]:
    """Firm keys of a hinge, with those of others that fall on its paths."""
    own, others = np.flatnonzero(column & firm), np.flatnonzero(firm)
    chain = own.tolist()
    for k in np.flatnonzero(np.diff(np.flatnonzero(firm[column])) > 1):
        chain += others[(others > own[k]) & (others < own[k + 1])].tolist()
    return sorted(chain)


def _weight(syncs: tuple[Sync, ...]) -> float:
    again = {sync: WEIGHT_AGAIN for _, sync in syncs if sync.startswith("stroke:")}
    return max([WEIGHT_ELSE, *((WEIGHTS | again).get(sync, WEIGHT_ELSE) for _, sync in syncs)])
