import numpy as np
import pytest
from PIL import Image

from kinesic.bench import ik
from kinesic.bench.ik import table71
from kinesic.bench.ik.baselines import METHODS
from kinesic.bench.ik.table71 import SIZES, UNITS, printed, table_name
from kinesic.ik import KERNEL


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table71, "REACHABLE", 40)
    monkeypatch.setattr(table71, "UNREACHABLE", 16)


@pytest.mark.skipif(KERNEL != "compiled", reason="the baselines exist only in the compiled kernel")
@pytest.mark.usefixtures("few")
def test_every_method_has_every_figure_and_a_picture(tmp_path) -> None:
    figures = table71.bench()
    values = {figure.name: figure.value for figure in figures}
    assert len(values) == len(figures) == len(METHODS) * len(SIZES) * len(UNITS)
    assert all(value is not None and np.isfinite(value) for value in values.values())
    assert values["ik.table71_pinned_verlet_n6_ratio"] == 1.0
    assert values["ik.table71_triangulation_n10_iterations"] == 1.0
    notes = {figure.name: figure.why for figure in figures}
    assert notes["ik.table71_ccd_n6_iterations"] == "thesis 33.2"
    assert notes["ik.table71_dls_dense_n10_ratio"] == "thesis 8.58"
    (path,) = ik.draw(figures, tmp_path)
    with Image.open(path) as picture:
        shades = np.asarray(picture.convert("L"))
    assert shades.shape[0] > 500
    assert 0.02 < (shades < 200).mean() < 0.5


def test_without_the_kernel_each_figure_says_why(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    monkeypatch.setattr(table71, "KERNEL", "numpy")
    figures = table71.bench()
    assert {(figure.value, figure.why) for figure in figures} == {(None, "the kernel is not compiled")}
    assert ik.draw(figures, tmp_path) == []


def test_ratios_of_the_thesis_are_to_its_method_2() -> None:
    assert printed("pinv_svd", 6, "ratio") == pytest.approx(1.095 / 0.132)
    assert printed("fabrik", 6, "ratio") is None
    assert printed("ccd", 6, "us") is None
    assert table_name("ccd", 6, "us") == "ik.table71_ccd_n6_us"
