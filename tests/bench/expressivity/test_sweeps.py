from dataclasses import replace

import pytest

from kinesic.bench.expressivity import sweeps
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.studies.sweep import series
from kinesic.studies.sweep.series import MEASURE_OF, Series


def test_ten_gestures_of_many_categories():
    forms = {form.id: form for form in Lexicon.load().forms}
    assert len(set(sweeps.GESTURES)) == 10
    assert len({forms[id].category for id in sweeps.GESTURES}) >= 6
    assert {len(forms[id].sides) for id in sweeps.GESTURES} == {1, 2}


@pytest.fixture(scope="module")
def brief():
    """One gesture at both ends and in the middle is enough to see that the figures are there."""
    sweeps.swept.cache_clear()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweeps, "GESTURES", ("flat_surface",))
        patch.setattr(series, "COUNT", 3)
        yield
    sweeps.swept.cache_clear()


def test_each_parameter_has_its_figures(brief):
    figures = {figure.name: figure for figure in sweeps.bench()}
    for parameter in MEASURE_OF:
        assert 0.0 <= figures[f"expressivity.{parameter}_monotone"].value <= 1.0
        assert figures[f"expressivity.{parameter}_stroke"].value >= 0.0
    assert figures["expressivity.spatial_ratio"].value > 1.0
    assert figures["expressivity.openness_shift"].value > 0.0
    assert figures["expressivity.power_ratio"].goal == 2.0


def test_doubling_counts_where_limits_allow_it(brief):
    power = next(each for each in sweeps.swept() if each.parameter == "power")
    tight = _with(power, allowed_speed=0.1)
    figure = sweeps.strength("power", [tight])[0]
    assert figure.value is None
    assert "0 of 1" in figure.why
    wide = _with(power, allowed_speed=9.0)
    assert sweeps.strength("power", [wide, tight])[0].value == pytest.approx(
        wide.played[-1].measures.stroke_speed / wide.played[1].measures.stroke_speed
    )


def test_a_stroke_that_never_comes_is_far_off(brief):
    power = next(each for each in sweeps.swept() if each.parameter == "power")
    figures = {f.name: f for f in sweeps.sweep_figures("power", [_with(power, stroke_error=None)])}
    assert figures["expressivity.power_stroke"].value == pytest.approx(300.0)
    assert figures["expressivity.power_stroke"].ok is False
    assert figures["expressivity.power_stroke"].why == "flat_surface"


def _with(found: Series, **changes: object) -> Series:
    return replace(found, played=tuple(replace(one, measures=replace(one.measures, **changes)) for one in found.played))
