from PIL import Image

from kinesic.studies.sweep.plots import draw_series
from kinesic.studies.sweep.series import sweep_parameter


def test_a_series_becomes_the_same_picture_twice(known, tmp_path):
    series = sweep_parameter("beat", "power", known, values=[0.0, 0.5])
    first, again = draw_series(series, tmp_path / "a.png"), draw_series(series, tmp_path / "b.png")
    with Image.open(first) as picture:
        assert picture.size == (1100, 620)
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 20
    assert first.read_bytes() == again.read_bytes()
    assert first.stat().st_size < 300_000
