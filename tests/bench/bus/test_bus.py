from pathlib import Path

import pytest

from kinesic.bench import bus

pytestmark = pytest.mark.realtime


@pytest.mark.parametrize(("count", "baud"), [(7, 4_000_000), (26, 1_000_000)])
def test_the_wire_is_measured_in_its_own_time_and_the_driver_in_the_hosts(count: int, baud: int):
    wire, host = bus.cycle_times(count, baud)
    octets = 14 + 5 * count + 14 + count + 8 + 22 * count
    assert wire == pytest.approx(octets * 10 / baud + 0.001, rel=0.03)
    assert host > 0.0


def test_the_load_is_measured_in_real_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(bus, "REAL_SECONDS", 0.3)
    figures = bus.cpu_load(tmp_path / "port")
    assert [figure.name for figure in figures] == ["bus.cpu_14_servos", "bus.cpu_supervisor_14_servos"]
    for figure in figures:
        assert (figure.unit, figure.goal, figure.better) == ("% of a core", 10.0, "lower")
        assert figure.value is not None, figure.why
        assert figure.value > 0.0


def test_figures_are_named_by_what_they_measure(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(bus, "cycle_times", lambda count, baud: (0.009, 0.001))
    monkeypatch.setattr(bus, "cpu_load", lambda link: [bus.Figure("bus.cpu_14_servos", 1.0, "%", 10.0, "lower")])
    figures = {figure.name: figure for figure in bus.bench()}
    assert len(figures) == 4 * 4 + 2
    assert figures["bus.rate_26_servos_4000000_baud"].value == pytest.approx(90.0)
    assert figures["bus.rate_26_servos_4000000_baud"].ok is False
    assert figures["bus.rate_full_health"].value == pytest.approx(100.0)
