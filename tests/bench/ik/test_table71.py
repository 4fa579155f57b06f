import numpy as np
import pytest
from PIL import Image

from kinesic.bench import ik
from kinesic.bench.ik import table71
from kinesic.bench.ik.baselines import IK_METHODS
from kinesic.bench.ik.table71 import CHAIN_SIZES, QUANTITY_UNITS, table_name, thesis_value


@pytest.fixture
def few_targets(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table71, "REACHABLE_TARGETS", 40)
    monkeypatch.setattr(table71, "UNREACHABLE_TARGETS", 16)


@pytest.mark.soak
@pytest.mark.usefixtures("few_targets")
def test_every_ik_method_has_all_table_7_1_metrics_and_a_plot(tmp_path) -> None:
    metrics = table71.bench()
    values = {metric.name: metric.value for metric in metrics}
    assert len(values) == len(metrics) == len(IK_METHODS) * len(CHAIN_SIZES) * len(QUANTITY_UNITS)
    assert all(value is not None and np.isfinite(value) for value in values.values())
    assert values["ik.table71_pinned_verlet_n6_ratio"] == 1.0
    assert values["ik.table71_triangulation_n10_iterations"] == 1.0
    notes = {metric.name: metric.why for metric in metrics}
    assert notes["ik.table71_ccd_n6_iterations"] == "thesis 33.2"
    assert notes["ik.table71_dls_dense_n10_ratio"] == "thesis 8.58"
    (path,) = ik.draw(metrics, tmp_path)
    with Image.open(path) as picture:
        shades = np.asarray(picture.convert("L"))
    assert shades.shape[0] > 500
    assert 0.02 < (shades < 200).mean() < 0.5


def test_thesis_time_ratio_is_relative_to_pinned_verlet_and_missing_without_a_thesis_value() -> None:
    assert thesis_value("pinv_svd", 6, "ratio") == pytest.approx(1.095 / 0.132)
    assert thesis_value("fabrik", 6, "ratio") is None
    assert thesis_value("ccd", 6, "us") is None
    assert table_name("ccd", 6, "us") == "ik.table71_ccd_n6_us"
