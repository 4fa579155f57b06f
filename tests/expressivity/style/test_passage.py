import numpy as np
import pytest
from scipy.interpolate import BPoly

from kinesic.expressivity.style.passage import passage_of
from kinesic.expressivity.style.style import Expressivity
from kinesic.motion.easing import PARTS, soften_easing
from kinesic.motion.keys import PLAIN, Passage

PHASES = ("preparation", "stroke", "hold", "retraction")


def peak(passed: Passage) -> float:
    """The greatest speed on a way of 1 in a time of 1."""
    curve = BPoly.from_derivatives(np.linspace(0.0, 1.0, PARTS + 1), soften_easing(passed.easing, passed.steepness).T)
    return float(curve(np.linspace(0.0, 1.0, 2001), nu=1).max())


@pytest.mark.parametrize("phase", PHASES)
def test_fluidity_is_continuity_and_tension_tension(phase):
    for fluidity in (-1.0, 0.0, 1.0):
        found = passage_of(Expressivity(fluidity=fluidity, tension=-0.4), phase)
        assert found.continuity == pytest.approx((fluidity - 1.0) / 2.0)
        assert found.tension == -0.4
    assert passage_of(Expressivity(fluidity=1.0), phase) == PLAIN


def test_power_raises_the_peak_speed_of_a_way_all_along_its_range():
    peaks = [peak(passage_of(Expressivity(power=float(power)), "stroke")) for power in np.linspace(-1.0, 1.0, 21)]
    assert np.all(np.diff(peaks) > 0.0)
    assert peaks[-1] > 1.6 * peaks[10]


@pytest.mark.parametrize("phase", ["hold", "retraction"])
def test_power_leaves_what_is_no_way_to_a_stroke(phase):
    assert passage_of(Expressivity(power=1.0), phase) == passage_of(Expressivity(), phase)


def test_a_forceful_way_overshoots_a_weak_one_is_even_a_tense_forceful_one_bounces():
    assert passage_of(Expressivity(power=0.8), "stroke").easing == "out_back"
    assert passage_of(Expressivity(tension=0.8), "stroke").easing == "out_back"
    assert passage_of(Expressivity(power=-0.8), "stroke").easing == "linear"
    assert passage_of(Expressivity(power=0.8, tension=0.8), "stroke").easing == "out_bounce"
