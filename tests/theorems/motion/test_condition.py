"""Conditioned motion keeps every limit, passes every key and reports every change."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.condition import LEAD_IN, condition
from kinesic.motion.keys import KeyPosture
from kinesic.motion.limit_check import check_limits
from kinesic.planning.syncs import SHIFT_TO_WARN

# Limits of trunk, shoulder, elbow and wrist with common servos
BOX_LIMITS = ([-0.26, -0.87, 0.0, -1.05], [0.61, 2.97, 2.36, 1.05], [1.26, 4.44, 6.45, 5.95], [17.5, 58.9, 80.6, 350.0])
# duty per acceleration, duty per velocity and duty limit of four hinges
DUTY_LIMITS = ([0.0323, 0.0103, 0.0081, 0.0021], [0.637, 0.18, 0.124, 0.1345], [0.615, 0.654, 0.703, 0.787])
JOINT_LIMITS = Limits(*(sealed(values) for values in (*BOX_LIMITS, [437.0, 1472.0, 2016.0, 8752.0], *DUTY_LIMITS)))


def out_back(x):
    return 1 + (x - 1) ** 2 * (2.70158 * (x - 1) + 1.70158)


def out_bounce(x):
    bounces = ((0.0, 1.0), (1.5, 2.0), (2.25, 2.5), (2.625, 2.75))
    tops = (0.0, 0.75, 0.9375, 0.984375)
    parts = [7.5625 * (x - centre / 2.75) ** 2 + top for (centre, _), top in zip(bounces, tops, strict=True)]
    return np.select([x < end / 2.75 for _, end in bounces], parts, 1.0)


def out_quart(x):
    return 1 - (1 - x) ** 4


@dataclass(frozen=True)
class Eased:
    """Interpolation by an easing between keys."""

    easing: object

    def __call__(self, times, keys):
        self_times, easing = times - times[0], self.easing

        def hinge(at, own, values):
            gap = np.clip(np.searchsorted(own, at, side="right") - 1, 0, len(own) - 2)
            share = np.clip((at - own[gap]) / (own[gap + 1] - own[gap]), 0.0, 1.0)
            return values[gap] + easing(share) * (values[gap + 1] - values[gap])

        return Sampled(self_times, keys.angles, keys.keyed, hinge)


@dataclass(frozen=True)
class Tcb:
    """Kochanek-Bartels spline, with discontinuous velocity if c is not 0."""

    t: float
    c: float
    b: float

    def __call__(self, times, keys):
        def hinge(at, own, values):
            h, d = np.diff(own), np.diff(values)
            leave, arrive = np.zeros(len(own)), np.zeros(len(own))
            for k in range(1, len(own) - 1):
                share = (1 - self.t) / (h[k - 1] + h[k])
                before, after = (1 + self.b) * d[k - 1], (1 - self.b) * d[k]
                arrive[k] = share * ((1 - self.c) * before + (1 + self.c) * after)
                leave[k] = share * ((1 + self.c) * before + (1 - self.c) * after)
            gap = np.clip(np.searchsorted(own, at, side="right") - 1, 0, len(own) - 2)
            s, m0, m1, w, e = at - own[gap], leave[gap], arrive[gap + 1], h[gap], d[gap]
            s = np.clip(s, 0.0, w)
            return values[gap] + m0 * s + ((3 * e / w - 2 * m0 - m1) / w) * s**2 + ((m0 + m1 - 2 * e / w) / w**2) * s**3

        return Sampled(times - times[0], keys.angles, keys.keyed, hinge)


@dataclass(frozen=True, eq=False)
class Sampled:
    times: np.ndarray
    places: np.ndarray
    keyed: np.ndarray
    hinge: object

    def angles(self, at):
        columns = [self.hinge(at, self.times[own], self.places[own, n]) for n, own in enumerate(self.keyed.T)]
        return np.stack(columns, axis=1)


extreme = st.sampled_from([-1.0, 0.0, 1.0])
wished = st.one_of(
    st.sampled_from([Eased(out_back), Eased(out_bounce), Eased(out_quart)]), st.builds(Tcb, extreme, extreme, extreme)
)
gaps = st.one_of(st.just(0.0), st.floats(0.0, 0.15), st.floats(0.1, 1.2))
shares = st.tuples(*[st.one_of(st.floats(0, 1), st.sampled_from([0.0, 0.5, 1.0]))] * 4)
syncs = st.sampled_from(["ready", "strokeStart", "stroke", "strokeEnd", "relax"])
rows = st.lists(st.tuples(gaps, shares, st.integers(0, 15), syncs), min_size=2, max_size=9)


def check(rows, wishes):
    times = np.cumsum([gap for gap, _, _, _ in rows])
    last = len(rows) - 1
    keys = tuple(
        KeyPosture(
            float(time),
            sealed(JOINT_LIMITS.lower + np.array(share) * (JOINT_LIMITS.upper - JOINT_LIMITS.lower)),
            tuple(k in (0, last) or bool(mask >> hinge & 1) for hinge in range(4)),
            ((f"b{k // 4}", sync),),
        )
        for k, (time, (_, share, mask, sync)) in enumerate(zip(times, rows, strict=True))
    )
    motion = condition(keys, JOINT_LIMITS, make_desired=wishes)
    for name, peak in check_limits(motion.trajectory, JOINT_LIMITS).by_quantity.items():
        assert peak.ratios.max() <= 1.001, name
    met = motion.trajectory.sample(motion.planned + motion.trajectory.zero)[0]
    for k, key in enumerate(keys):
        for hinge in np.flatnonzero(key.keyed):
            assert abs(met[k, hinge] - key.angles[hinge]) <= 1.01e-3  # Keys at a range end keep a margin to turn back
    for hinge in range(4):
        own = [k for k, key in enumerate(keys) if key.keyed[hinge]]
        assert np.all(np.diff(motion.planned[own]) > 0)
    assert motion.planned.min() >= times[0] - LEAD_IN - 1e-6
    shifted = np.abs(motion.planned - motion.requested_times).max()
    crowded = np.diff(times).min() < 0.02
    assert shifted <= SHIFT_TO_WARN or motion.bottlenecks or crowded
    assert not motion.bottlenecks or shifted > 0.0


@settings(max_examples=20, deadline=None)
@given(rows, wished)
def test_conditioned_motion_keeps_limits_passes_keys_and_reports_time_shifts(rows, wishes):
    check(rows, wishes)


@pytest.mark.soak
@settings(max_examples=1000, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(rows, wished)
def test_1000_conditioned_motions_keep_limits_pass_keys_and_report_time_shifts(rows, wishes):
    check(rows, wishes)
