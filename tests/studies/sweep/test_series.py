from dataclasses import replace

import pytest
from PIL import Image

from kinesic.body.config import ConfigError
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES
from kinesic.studies.sweep.measures import Measures
from kinesic.studies.sweep.series import (
    MAX_STROKE_ERROR,
    MEASURE_OF,
    Played,
    Series,
    draw_series,
    play_task,
    preset_tasks,
    sweep_parameter,
)

NEUTRAL_MEASURES = Measures(
    peak_speed=1.0,
    stroke_speed=0.5,
    allowed_speed=1.0,
    path_length=1.0,
    swept_volume=0.01,
    curvature=3.0,
    torso_travel=0.1,
    shoulder_travel=0.1,
    jerk=50.0,
    overshoot=0.0,
    stroke_error=0.001,
    preparation=0.5,
    elbow_offset=0.1,
    strokes=1,
    energy=0.1,
)


def series(parameter: str, *values: object, name: str = "") -> Series:
    """Return a series with given values of one measure."""
    field = name or MEASURE_OF[parameter].name
    rows = [Played(k, replace(NEUTRAL_MEASURES, **{field: value}), {}, ()) for k, value in enumerate(values)]
    return Series("beat", parameter, tuple(rows))


def test_every_expressivity_parameter_has_a_main_measure():
    assert set(MEASURE_OF) == set(EXPRESSIVITY_RANGES)


@pytest.mark.parametrize(
    ("parameter", "values", "monotone"),
    [
        ("power", (0.4, 0.5, 0.9), True),
        ("power", (0.4, 0.4, 0.9), False),
        ("power", (0.4, 0.9, 0.8), False),
        ("tension", (9.0, 9.0, 9.0, 9.0, 9.0), False),
        ("temporal", (0.9, 0.5, 0.4), True),
        ("temporal", (0.4, 0.5, 0.9), False),
        ("repetition", (1, 1, 2, 3), True),
        ("repetition", (1, 1, 1), False),
        ("repetition", (1, 3, 2), False),
        ("openness", (0.1, None, 0.3), False),
        ("power", (0.4,), True),
    ],
)
def test_parameter_series_is_monotone_only_if_its_measure_changes_in_the_expected_direction(
    parameter, values, monotone
):
    assert series(parameter, *values).monotone is monotone


def test_parameter_series_reports_its_worst_stroke_error():
    assert series("power", -0.004, 0.009, name="stroke_error").in_time
    late = series("power", 0.0, -2 * MAX_STROKE_ERROR, name="stroke_error")
    assert late.worst_stroke == pytest.approx(2 * MAX_STROKE_ERROR)
    assert not late.in_time
    never = series("power", 0.0, None, name="stroke_error")
    assert never.worst_stroke is None
    assert not never.in_time


def test_hands_sweep_more_volume_at_larger_spatial_extent(known):
    result = sweep_parameter("flat_surface", "spatial", known, values=[0.8, -0.8])
    assert [one.value for one in result.played] == [-0.8, 0.8]
    assert result.monotone
    assert result.in_time
    narrow, wide = (one.measures for one in result.played)
    assert wide.swept_volume > 1.5 * narrow.swept_volume
    assert {len(path) for path in result.played[0].hands.values()} == {len(result.played[0].times)}
    assert result.played[0].times[0] < 0.0 < result.played[0].times[-1]


def test_parameter_sweep_is_reproducible(known):
    first, again = (sweep_parameter("beat", "power", known, values=[0.5]).played[0].measures for _ in range(2))
    assert first == again


def test_sweep_values_cover_the_whole_parameter_range_by_default(known, monkeypatch):
    monkeypatch.setattr("kinesic.studies.sweep.series.VALUE_COUNT", 2)
    assert [one.value for one in sweep_parameter("beat", "openness", known).played] == [0.0, 1.0]


def test_sweep_of_style_presets_performs_each_style_file_by_name(known, monkeypatch, tmp_path):
    (tmp_path / "styles").mkdir()
    (tmp_path / "styles" / "sad.toml").touch()
    monkeypatch.setattr("kinesic.studies.sweep.series.CONFIGS", tmp_path)
    results = {name: play_task(task, known) for name, task in preset_tasks("beat", known).items()}
    assert list(results) == ["sad"]
    assert results["sad"].measures.stroke_error is not None


def test_unknown_gesture_or_parameter_of_a_sweep_suggests_names(known):
    with pytest.raises(ConfigError, match=r"no gesture beet; did you mean beat\?"):
        sweep_parameter("beet", "power", known)
    with pytest.raises(ConfigError, match=r"a style has no powr; did you mean power\?"):
        sweep_parameter("beat", "powr", known)
    with pytest.raises(ConfigError, match=r"power is 2, outside \[-1, 1\]"):
        sweep_parameter("beat", "power", known, values=[0.0, 2.0])


@pytest.mark.soak
def test_parameter_series_plot_is_reproducible(known, tmp_path):
    series = sweep_parameter("beat", "power", known, values=[0.0, 0.5])
    first, again = draw_series(series, tmp_path / "a.png"), draw_series(series, tmp_path / "b.png")
    with Image.open(first) as picture:
        assert picture.size == (1100, 620)
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 20
    assert first.read_bytes() == again.read_bytes()
    assert first.stat().st_size < 300_000
