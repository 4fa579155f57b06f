from dataclasses import replace

import pytest

from kinesic.bench.expressivity import sweeps
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.session.setup import set_up
from kinesic.studies.sweep import series
from kinesic.studies.sweep.series import MEASURE_OF, Series, sweep_parameter


def test_expressivity_benchmark_covers_ten_gestures_of_at_least_six_categories():
    forms = {form.id: form for form in Lexicon.load().forms}
    assert len(set(sweeps.SWEPT_GESTURES)) == 10
    assert len({forms[id].category for id in sweeps.SWEPT_GESTURES}) >= 6
    assert {len(forms[id].sides) for id in sweeps.SWEPT_GESTURES} == {1, 2}


@pytest.fixture(scope="module")
def short_sweep():
    """Sweep one gesture over three values, which suffices for all metrics."""
    sweeps.sweep_all.cache_clear()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweeps, "SWEPT_GESTURES", ("flat_surface",))
        patch.setattr(series, "VALUE_COUNT", 3)
        yield
    sweeps.sweep_all.cache_clear()


@pytest.fixture
def short_power_sweep(short_sweep):
    """Sweep one gesture over three values of power alone."""
    return sweep_parameter("flat_surface", "power", set_up())


@pytest.mark.soak
def test_each_expressivity_parameter_has_monotonicity_and_stroke_metrics(short_sweep):
    metrics = {metric.name: metric for metric in sweeps.bench()}
    for parameter in MEASURE_OF:
        assert 0.0 <= metrics[f"expressivity.{parameter}_monotone"].value <= 1.0
        assert metrics[f"expressivity.{parameter}_stroke"].value >= 0.0
    assert metrics["expressivity.spatial_ratio"].value > 1.0
    assert metrics["expressivity.openness_shift"].value > 0.0
    assert metrics["expressivity.power_ratio"].goal == 2.0


@pytest.mark.soak
def test_effect_of_power_is_measured_only_for_gestures_whose_velocity_limits_allow_faster_strokes(short_sweep):
    power = next(series for series in sweeps.sweep_all() if series.parameter == "power")
    tight = _with(power, allowed_speed=0.1)
    metric = sweeps.effect_metrics("power", [tight])[0]
    assert metric.value is None
    assert "0 of 1" in metric.why
    wide = _with(power, allowed_speed=9.0)
    assert sweeps.effect_metrics("power", [wide, tight])[0].value == pytest.approx(
        wide.played[-1].measures.stroke_speed / wide.played[1].measures.stroke_speed
    )


def test_stroke_missing_from_a_performance_counts_as_an_error_of_300_ms(short_power_sweep):
    missed = _with(short_power_sweep, stroke_error=None)
    metrics = {metric.name: metric for metric in sweeps.sweep_metrics("power", [missed])}
    assert metrics["expressivity.power_stroke"].value == pytest.approx(300.0)
    assert metrics["expressivity.power_stroke"].ok is False
    assert metrics["expressivity.power_stroke"].why == "flat_surface"


def _with(series: Series, **changes: object) -> Series:
    return replace(
        series, played=tuple(replace(one, measures=replace(one.measures, **changes)) for one in series.played)
    )
