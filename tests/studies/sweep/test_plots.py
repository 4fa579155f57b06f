from PIL import Image

from kinesic.studies.sweep.plots import draw
from kinesic.studies.sweep.series import sweep


def test_a_series_becomes_the_same_picture_twice(known, tmp_path):
    series = sweep("beat", "power", known, values=[0.0, 0.5])
    first, again = draw(series, tmp_path / "a.png"), draw(series, tmp_path / "b.png")
    with Image.open(first) as picture:
        assert picture.size == (1100, 620)
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 20
    assert first.read_bytes() == again.read_bytes()
    assert first.stat().st_size < 300_000
