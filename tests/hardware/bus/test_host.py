from pathlib import Path

import pytest

from kinesic.hardware.bus.host import AdapterLatency, Punctuality, find_stable_name, list_ports, read_latency


def links(folder: Path) -> tuple[Path, Path]:
    """Return a serial port and its persistent device name."""
    device, names = folder / "ttyUSB0", folder / "by-id"
    device.touch()
    names.mkdir()
    (names / "usb-FTDI_U2D2_FT1-if00-port0").symlink_to(device)
    return device, names


def test_serial_port_is_identified_by_its_stable_device_name(tmp_path: Path):
    device, names = links(tmp_path)
    name = names / "usb-FTDI_U2D2_FT1-if00-port0"
    assert find_stable_name(device, names=names) == name
    assert find_stable_name(name, names=names) == name
    assert list_ports(names=names) == (name,)


def test_serial_port_without_a_stable_device_name_keeps_its_path(tmp_path: Path):
    device, names = links(tmp_path)
    other = tmp_path / "ttyUSB1"
    other.touch()
    assert find_stable_name(other, names=names) == other
    assert find_stable_name(device, names=tmp_path / "none") == device
    assert find_stable_name(tmp_path / "gone", names=names) == tmp_path / "gone"
    assert list_ports(names=tmp_path / "none") == ()


def timer(folder: Path, value: str) -> Path:
    setting = folder / "bus/usb-serial/devices/ttyUSB0/latency_timer"
    setting.parent.mkdir(parents=True)
    setting.write_text(value)
    return setting


def test_long_usb_latency_timer_found_by_the_stable_port_name_is_reported_with_a_remedy(tmp_path: Path):
    _, names = links(tmp_path)
    setting = timer(tmp_path, "16\n")
    name = names / "usb-FTDI_U2D2_FT1-if00-port0"
    latency = read_latency(name, system=tmp_path)
    assert latency == AdapterLatency(name, 16, setting)
    assert not latency.is_good
    assert f"{name}: USB latency timer is 16 ms, which limits the bus to about 62 Hz" in latency.remedy
    assert f"echo 1 | sudo tee {setting}" in latency.remedy
    assert "udev" in latency.remedy


def test_latency_timer_of_one_millisecond_is_short_enough(tmp_path: Path):
    timer(tmp_path, "1\n")
    latency = read_latency(tmp_path / "ttyUSB0", system=tmp_path)
    assert latency is not None
    assert latency.is_good


def test_pseudo_terminal_and_invalid_latency_file_give_no_latency(tmp_path: Path):
    assert read_latency(tmp_path / "pts3", system=tmp_path) is None
    timer(tmp_path, "nonsense")
    assert read_latency(tmp_path / "ttyUSB0", system=tmp_path) is None


def beat(host: Punctuality, gaps: list[float], *, now: float = 100.0) -> list[str]:
    """Return the messages for cycles with the given times [s] between them."""
    notes = [host.note(now, excused=False)]
    for gap in gaps:
        now += gap
        notes.append(host.note(now, excused=False))
    return [line for line in notes if line]


@pytest.mark.parametrize(
    ("gap", "stretch", "pace"),
    [(0.01, 1, 1.0), (0.024, 1, 1.0), (0.026, 2, 1.0), (0.049, 2, 1.0), (0.051, 4, 0.5), (0.3, 4, 0.5)],
)
def test_host_with_late_cycles_gets_longer_watchdog_times_and_slower_motion(gap: float, stretch: int, pace: float):
    host = Punctuality(0.1)
    result = beat(host, [0.01, gap, 0.01])
    assert (host.watchdog_factor, host.pace) == (stretch, pace)
    assert len(result) == (stretch > 1)
    assert all(f"{1e3 * gap:.0f} ms apart: bus watchdogs are {0.1 * stretch:g} s" in line for line in result)


def test_host_with_punctual_cycles_gets_short_watchdog_times_again():
    host = Punctuality(0.1)
    assert len(beat(host, [0.04, *[0.01] * 990])) == 1
    assert host.watchdog_factor == 2
    assert "bus watchdogs are 0.1 s" in beat(host, [0.01] * 20, now=109.95)[-1]
    assert (host.watchdog_factor, host.pace) == (1, 1.0)


def test_delay_of_an_excused_slow_operation_does_not_count_as_host_delay():
    host = Punctuality(0.1)
    beat(host, [0.01])
    assert not host.note(100.02, excused=True)
    assert not host.note(100.5, excused=False)
    assert host.watchdog_factor == 1
    assert host.note(100.6, excused=False)
