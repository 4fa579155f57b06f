"""Key postures with their tension and easing, as planning input."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import TypeVar, get_args

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.motion.easing import Easing

Sync = tuple[str, str]  # behaviour id, sync point
Pair = tuple[int, int]  # indices of two keys, the earlier first
Amount = TypeVar("Amount", float, Floats)
Result = TypeVar("Result")

EASING_NAMES: tuple[Easing, ...] = get_args(Easing)  # names of all easings, in the order of their indices
SMOOTHEST_EASING = EASING_NAMES.index("minimum_jerk")  # index of the default easing
ACCENT_EASING: Easing = "out_power"  # easing with the highest velocity at the beginning of the interval
LATE_ACCENT_EASING: Easing = "late"  # easing with the highest velocity at the end of the interval
OVERSHOOTING_EASINGS: tuple[Easing, ...] = ("out_back", "out_bounce")  # easings that pass the key and return to it
POWER_STEEPNESS = 2.5  # easing steepness of a gesture with full power, without an accent
MIN_STEEPNESS = 1.0  # easing steepness of a movement as soft as minimum jerk
MAX_STEEPNESS = 8.0  # easing steepness of a movement that starts almost at full velocity
PASSAGE_RANGES: Mapping[str, tuple[float, float]] = {  # smallest and largest value of each parameter of `KeyPassage`
    "tension": (-1.0, 1.0),
    "continuity": (-1.0, 0.0),
    "bias": (-1.0, 1.0),
    "steepness": (MIN_STEEPNESS, MAX_STEEPNESS),
    "swing": (0.0, 1.0),
}
SWING_GAIN = 2.0  # extra key velocity at swing 1, relative to the usual key velocity
LINEAR_STEEPNESS = 3.3  # easing steepness at which the linear easing peaks as fast as minimum jerk

MIN_GAP = 0.02  # [s] smallest time between successive keys of a hinge or behaviour
MIN_PATH_GAP = 0.002  # [s] smallest time between keys of different hinges on the path of a third hinge
RANGE_MARGIN = 1e-3  # [rad] margin between keys and joint limits, because control points may lie beyond the keys
HOLD_TOLERANCE = 1e-9  # [rad] successive keys that differ by less form a hold
TIME_TOLERANCE = 1e-6  # [s] rounding tolerance of key times
# Cost weights [1/s] of shifting keys, by sync point.
SYNC_WEIGHTS = {"strokeStart": 5.0, "stroke": 5.0, "strokeEnd": 0.5, "ready": 0.3, "relax": 0.3}
REPEAT_WEIGHT = 0.3  # cost weight [1/s] of shifting a repeated stroke; the first stroke has priority
DEFAULT_WEIGHT = 0.05  # cost weight [1/s] of shifting keys without a weight in SYNC_WEIGHTS


def flow(tension: Amount, continuity: Amount, swing: Amount) -> Amount:
    """Return the fraction of velocity that a hinge keeps at a key.

    0 stops, 1 runs through; a swing adds to it, full tension removes all.
    """
    positive_tension = tension * (tension > 0.0)
    return (1.0 - tension) * (1.0 + continuity) + SWING_GAIN * (1.0 - positive_tension) * swing


@dataclass(frozen=True)
class KeyPassage:
    """Tension, continuity, bias, easing and swing at a key (Kochanek-Bartels).

    Raises:
        ValueError: a number outside its range, which is named.
    """

    tension: float = 0.0  # -1 overshoots .. 1 stops at the key
    continuity: float = 0.0  # -1 stops at the key .. 0 runs through; above 0, velocities would jump
    bias: float = 0.0  # -1 follows the next interval .. 1 follows the previous one
    easing: Easing = "minimum_jerk"  # of the interval before the key
    steepness: float = 4.0  # of that easing: 1 begins as softly as minimum jerk .. 8 nearly at once
    swing: float = 0.0  # 0 stays between the keys .. 1 overshoots the key as far as the joint range allows

    def __post_init__(self) -> None:
        for name, (least, most) in PASSAGE_RANGES.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise ValueError(f"{name} is {value:g}, outside [{least:g}, {most:g}]")

    @property
    def without_accent(self) -> "KeyPassage":
        """The same passage without overshoot and accent.

        Overshooting easings become no steeper than full power makes them. An accent at the end of the interval, which
        a word needs, stays: it leaves the path as it is.
        """
        return _without_accent(self)

    @property
    def flow(self) -> float:
        """Fraction of velocity kept at the key, above 1 with overshoot."""
        return flow(self.tension, self.continuity, self.swing)


PLAIN_PASSAGE = KeyPassage()  # passage through a key with default tension and easing


@lru_cache(maxsize=1024)
def _without_accent(passage: KeyPassage) -> KeyPassage:
    if passage.easing in OVERSHOOTING_EASINGS:
        return replace(passage, swing=0.0, steepness=min(passage.steepness, POWER_STEEPNESS))
    return replace(passage, swing=0.0, easing="minimum_jerk" if passage.easing == ACCENT_EASING else passage.easing)


@dataclass(frozen=True, eq=False)
class KeyPosture:
    """Joint angles at one key time, for a subset of hinges."""

    time: float  # [s] block time
    angles: Floats  # (n,) [rad]
    keyed: tuple[bool, ...]  # (n,)
    syncs: tuple[Sync, ...] = ()
    passages: tuple[KeyPassage, ...] = ()  # (n,) passage of each hinge; `PLAIN_PASSAGE` if empty
    is_exact: bool = True  # passed exactly; otherwise on a path, which the motion follows only within the limits

    @cached_property
    def passage_values(self) -> Floats:
        """Tension and easing parameters of each hinge, (6, n).

        Without passages, those of `PLAIN_PASSAGE`.
        """
        return _to_values(self.passages, len(self.angles))

    @classmethod
    def whole(cls, time: float, angles: Sequence[float] | Floats) -> "KeyPosture":
        """Make a key of all hinges from angles (n,) [rad]."""
        return cls(time, sealed(np.array(angles, dtype=np.float64)), (True,) * len(angles))


@dataclass(frozen=True)
class Bond:
    """Minimum time from one sync point to another."""

    earlier: Sync
    later: Sync
    least: float  # [s] minimum time from `earlier` to `later`


@dataclass(frozen=True, eq=False)
class Keys:
    """Key postures as arrays in time order."""

    requested_times: Floats  # (m,) [s] block time
    angles: Floats  # (m, n) [rad]
    keyed: Flags  # (m, n) whether a hinge has a key in this row
    passage_values: Floats  # (6, m, n) tension, continuity, bias, steepness, index in `EASING_NAMES` and swing
    is_exact: Flags  # (m,) whether a key is passed exactly; the others lie between them in time
    syncs: tuple[tuple[Sync, ...], ...]  # (m,) sync points at each key
    limits: Limits  # limits of all hinges
    bonds: Mapping[Pair, float] = field(default_factory=dict)  # [s] minimum time between two keys required by BML

    @classmethod
    def of(
        cls,
        postures: Sequence[KeyPosture],
        limits: Limits,
        bonds: Sequence[Bond] = (),
        *,
        margin: float = RANGE_MARGIN,
    ) -> "Keys":
        """Collect key postures in arrays.

        Args:
            postures: in the order of their times.
            limits: of the hinges, into whose ranges the postures are clipped.
            bonds: between sync points; those without a key are left out.
            margin: [rad] distance of keys from the ends of a range.
        """
        return _join_postures(tuple(postures), limits, tuple(bonds), margin)

    def part(self, rows: Indices, hinges: Indices) -> "Keys":
        """Return a subset of keys and hinges, without precedence constraints."""
        here = rows[:, None], hinges
        return Keys(
            self.requested_times[rows],
            self.angles[here],
            self.keyed[here],
            self.passage_values[:, *here],
            self.is_exact[rows],
            tuple(self.syncs[row] for row in rows),
            self.limits.part(hinges),
        )

    def with_passage(self, passage: KeyPassage) -> "Keys":
        """Return only keys passed exactly, all with the same tension and easing."""
        passage_values = np.broadcast_to(_to_values((passage,), 1)[:, :, None], self.passage_values.shape)
        return replace(self, keyed=self.keyed & self.is_exact[:, None], passage_values=passage_values)

    @cached_property
    def weights(self) -> Floats:
        """Cost of shifting each key [1/s], shape (m,).

        That of its heaviest sync point; 0 on a path.
        """
        return sealed(
            [_weight(syncs) if is_exact else 0.0 for syncs, is_exact in zip(self.syncs, self.is_exact, strict=True)]
        )

    @cached_property
    def is_repeat(self) -> Flags:
        """Whether each key belongs to a repeated stroke, shape (m,)."""
        return np.array([any(sync.startswith("stroke:") for _, sync in syncs) for syncs in self.syncs], dtype=np.bool_)

    @cached_property
    def gaps(self) -> Mapping[Pair, float]:
        """Minimum times between successive keys of a hinge or behaviour [s].

        Keys of different hinges that only lie on the path of a third hinge may keep a smaller requested gap.
        """
        exact_pairs, path_pairs = _find_successive_keys(self)
        times = self.requested_times
        path_gaps = {(i, j): float(times[j] - times[i]) for i, j in path_pairs - exact_pairs}
        small_gaps = {pair: min(MIN_GAP, max(gap, MIN_PATH_GAP)) for pair, gap in path_gaps.items()}
        return dict.fromkeys(exact_pairs, MIN_GAP) | small_gaps

    @property
    def is_spaced(self) -> bool:
        """Whether the requested times respect all minimum gaps."""
        return all(
            self.requested_times[j] - self.requested_times[i] >= gap - TIME_TOLERANCE
            for (i, j), gap in self.gaps.items()
        )

    @cached_property
    def exact_rows(self) -> tuple[list[int], ...]:
        """Indices of the keys passed exactly, one list per hinge."""
        return _map_columns(self.keyed, lambda column: np.flatnonzero(column & self.is_exact).tolist())

    def has_path(self, hinge: int) -> Flags:
        """Return whether the hinge follows a path within each exact key interval."""
        return self._path_flags[hinge]

    @cached_property
    def _path_flags(self) -> tuple[Flags, ...]:
        return _map_columns(self.keyed, lambda column: np.diff(np.flatnonzero(self.is_exact[column])) > 1)

    def interpolate_path_times(self, times: Floats) -> Floats:
        """Interpolate the times (m,) [s] of the keys not passed exactly."""
        return np.where(
            self.is_exact,
            times,
            np.interp(self.requested_times, self.requested_times[self.is_exact], times[self.is_exact]),
        )


@lru_cache(maxsize=8)  # each stage of planning asks for the same ones
def _join_postures(postures: tuple[KeyPosture, ...], limits: Limits, bonds: tuple[Bond, ...], margin: float) -> Keys:
    inward = np.minimum(margin, (limits.upper - limits.lower) / 2)
    angles = np.clip([posture.angles for posture in postures], limits.lower + inward, limits.upper - inward)
    row_of = {sync: row for row, posture in enumerate(postures) for sync in posture.syncs}
    return Keys(
        requested_times=sealed([posture.time for posture in postures]),
        angles=sealed(angles),
        keyed=np.array([posture.keyed for posture in postures], dtype=np.bool_),
        passage_values=np.stack([posture.passage_values for posture in postures], axis=1),
        is_exact=np.array([posture.is_exact for posture in postures], dtype=np.bool_),
        syncs=tuple(posture.syncs for posture in postures),
        limits=limits,
        bonds={
            (row_of[bond.earlier], row_of[bond.later]): bond.least
            for bond in bonds
            if bond.earlier in row_of and bond.later in row_of and row_of[bond.earlier] != row_of[bond.later]
        },
    )


@lru_cache(maxsize=128)
def _to_values(passages: tuple[KeyPassage, ...], count: int) -> Floats:
    """Return tension and easing parameters of all hinges, (6, count)."""
    rows = [
        (key.tension, key.continuity, key.bias, key.steepness, EASING_NAMES.index(key.easing), key.swing)
        for key in passages or (PLAIN_PASSAGE,) * count
    ]
    return sealed(np.transpose(rows))


def _map_columns(keyed: Flags, find: Callable[[Flags], Result]) -> tuple[Result, ...]:
    """Apply a function to each column of flags, once per distinct column."""
    column_bytes = [column.tobytes() for column in keyed.T]
    results = {key: find(column) for key, column in dict(zip(column_bytes, keyed.T, strict=True)).items()}
    return tuple(results[key] for key in column_bytes)


def _find_successive_keys(keys: Keys) -> tuple[set[Pair], set[Pair]]:
    """Return pairs of successive exact keys, and pairs along paths.

    The second set keeps the order of keys within paths.
    """
    columns = np.unique(keys.keyed, axis=1).T
    chains = [np.flatnonzero(column & keys.is_exact).tolist() for column in columns]
    paths = [_with_paths(column, keys.is_exact) for column in columns]
    behaviours: dict[str, list[int]] = {}
    for row, syncs in enumerate(keys.syncs):
        for behaviour in sorted({behaviour for behaviour, _ in syncs}):
            behaviours.setdefault(behaviour, []).append(row)
    exact_pairs = {pair for chain in [*chains, *behaviours.values()] for pair in pairwise(chain)}
    return exact_pairs, {pair for chain in paths for pair in pairwise(chain)}


def _with_paths(column: Flags, is_exact: Flags) -> list[int]:
    """Return rows of exact keys of a hinge, and within its paths.

    Where it passes keys approximately in between, the exact keys of other hinges are included.

    Args:
        column: (m,) keys of the hinge.
        is_exact: (m,) keys that are passed exactly.
    """
    rows, others = np.flatnonzero(column & is_exact), np.flatnonzero(is_exact)
    chain = rows.tolist()
    for k in np.flatnonzero(np.diff(np.flatnonzero(is_exact[column])) > 1):
        chain += others[(others > rows[k]) & (others < rows[k + 1])].tolist()
    return sorted(chain)


def _weight(syncs: tuple[Sync, ...]) -> float:
    repeat_weights = {sync: REPEAT_WEIGHT for _, sync in syncs if sync.startswith("stroke:")}
    return max([DEFAULT_WEIGHT, *((SYNC_WEIGHTS | repeat_weights).get(sync, DEFAULT_WEIGHT) for _, sync in syncs)])
