from pathlib import Path

import pytest

from kinesic.bench import bus

pytestmark = pytest.mark.realtime


@pytest.mark.parametrize(("count", "baud"), [(7, 4_000_000), (26, 1_000_000)])
def test_bus_cycle_is_measured_in_wire_time_and_cpu_time(count: int, baud: int):
    wire, host = bus.cycle_times(count, baud)
    octets = 14 + 5 * count + 14 + count + 8 + 22 * count
    assert wire == pytest.approx(octets * 10 / baud + 0.001, rel=0.03)
    assert host > 0.0


@pytest.mark.soak
def test_bus_benchmark_measures_cpu_load_with_14_servos(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(bus, "REAL_SECONDS", 0.3)
    metrics = bus.cpu_load(tmp_path / "port")
    assert [metric.name for metric in metrics] == ["bus.cpu_14_servos", "bus.cpu_supervisor_14_servos"]
    for metric in metrics:
        assert (metric.unit, metric.goal, metric.better) == ("% of a core", 10.0, "lower")
        assert metric.value is not None, metric.why
        assert metric.value > 0.0


def test_bus_metric_names_contain_servo_count_and_baud_rate(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(bus, "cycle_times", lambda count, baud: (0.009, 0.001))
    monkeypatch.setattr(bus, "cpu_load", lambda link: [bus.Metric("bus.cpu_14_servos", 1.0, "%", 10.0, "lower")])
    metrics = {metric.name: metric for metric in bus.bench()}
    assert len(metrics) == 4 * 4 + 2
    assert metrics["bus.rate_26_servos_4000000_baud"].value == pytest.approx(90.0)
    assert metrics["bus.rate_26_servos_4000000_baud"].ok is False
    assert metrics["bus.rate_full_health"].value == pytest.approx(100.0)
