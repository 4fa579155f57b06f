import msgspec
import pytest

from kinesic.bench.naturalness.whole_body import stored
from kinesic.bench.naturalness.whole_body.comparison import TUNED_SETS
from kinesic.bench.naturalness.whole_body.features import measure_sets
from kinesic.bench.naturalness.whole_body.stored import CapturedBodyTable, format_sets, read_captured_sets

from .bodies import make_body


def test_body_measures_read_from_a_table_equal_the_measured_ones(monkeypatch, tmp_path):
    clips = [
        make_body(trunk=5.0, swing=(0.02, 0.3), set_name="One set", performance="x"),
        make_body(trunk=2.0, swing=(0.02, 0.3), set_name="Two", syncs={"start": 0.0, "end": 2.5}),
    ]
    measured = measure_sets(clips)
    monkeypatch.setattr(stored, "TABLE_FILE", tmp_path / "table.toml")
    (tmp_path / "table.toml").write_text(format_sets(measured))
    read = read_captured_sets.__wrapped__()
    assert [one.name for one in read] == ["One set", "Two"]
    for one, other in zip(read, measured, strict=True):
        assert (one.performances, one.rests) == (other.performances, other.rests)
        for name in ("trunk", "free_arm", "stroke_speed", "flow"):
            assert one.values(name) == pytest.approx(other.values(name), rel=1e-3)
        assert one.posture_values("forward") == pytest.approx(other.posture_values("forward"), rel=1e-3)
    assert read[0].gestures[0].flow is not None
    assert read[1].gestures[0].flow is None


def test_supplied_table_of_captured_bodies_has_tuned_and_unseen_sets():
    names = [measured.name for measured in read_captured_sets()]
    assert set(names) >= TUNED_SETS
    assert set(names) - TUNED_SETS == {"PNGestures", "bvh gestures", "bvh other"}


def test_unknown_keys_in_the_table_of_captured_bodies_are_rejected():
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert({"sets": {}, "other": 1}, CapturedBodyTable)
