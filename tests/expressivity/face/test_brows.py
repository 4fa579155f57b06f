import numpy as np
import pytest

from kinesic.expressivity.face.brows import FALL_TIME, HOLD_TIME, RISE_TIME, brow_units
from kinesic.expressivity.prosody import Accent
from kinesic.expressivity.style.style import Expressivity

SAMPLE_TIMES = np.arange(0.0, 6.0, 0.005)


def test_brows_peak_on_the_accent_and_sink_after_it():
    raised = brow_units([Accent(1.0, brow=0.4)], SAMPLE_TIMES, start=1.5, amount=1.0)
    assert raised.keys() == {"L1", "R1", "L2", "R2"}
    outer = raised["L2"]
    assert SAMPLE_TIMES[outer.argmax()] == pytest.approx(2.5)
    assert outer.max() == pytest.approx(0.4)
    shown = SAMPLE_TIMES[outer > 0.0]
    assert shown.min() == pytest.approx(2.5 - RISE_TIME, abs=0.011)
    assert shown.max() == pytest.approx(2.5 + HOLD_TIME + FALL_TIME, abs=0.011)


def test_accent_without_a_brow_raise_activates_no_action_unit():
    assert brow_units([Accent(1.0, nod=1.0)], SAMPLE_TIMES, start=0.0, amount=1.0) == {}


def test_brow_raises_scale_with_amount_and_spatial_extent():
    once, twice = (
        brow_units([Accent(1.0, brow=0.3)], SAMPLE_TIMES, start=0.0, amount=amount)["L1"] for amount in (1.0, 2.0)
    )
    np.testing.assert_allclose(twice, 2.0 * once)
    wide, tight = (
        brow_units([Accent(1.0, brow=0.3)], SAMPLE_TIMES, start=0.0, amount=1.0, manner=Expressivity(spatial=spatial))
        for spatial in (0.7, -0.7)
    )
    assert wide["L1"].max() > 1.3 * once.max() > 1.3 * 1.3 * tight["L1"].max()
