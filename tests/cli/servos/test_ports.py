"""Ports of a robot's buses from the options of the command line."""

import json
import tomllib
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.cli.servos import ports
from kinesic.cli.servos.ports import read_all_ports, read_ports


def test_port_without_a_bus_name_belongs_to_the_only_bus():
    assert read_ports(["/dev/a"], ["body"]) == {"body": Path("/dev/a")}
    assert read_ports(["body=/dev/a=b"], ["body"]) == {"body": Path("/dev/a=b")}


def test_port_options_assign_ports_to_buses_by_name():
    given = ["right=/dev/b", "left=/dev/a"]
    assert read_all_ports(given, iter(["left", "right"])) == {"left": Path("/dev/a"), "right": Path("/dev/b")}


@pytest.mark.parametrize(
    ("texts", "buses", "message"),
    [
        (["/dev/a"], ["left", "right"], "--port /dev/a: no bus /dev/a"),
        (["arm=/dev/a"], ["body"], "--port arm=/dev/a: no bus arm; known: body; give NAME=PATH"),
        (["left=/dev/a", "left=/dev/b"], ["left", "right"], "--port left=/dev/b: give one path for bus left"),
        (["left="], ["left", "right"], "--port left=: give one path for bus left"),
    ],
)
def test_unknown_or_repeated_bus_names_in_port_options_are_refused(texts: list[str], buses: list[str], message: str):
    with pytest.raises(ConfigError) as error:
        read_ports(texts, buses)
    assert str(error.value).startswith(message)


@pytest.mark.parametrize(("here", "named"), [([], "none on USB"), ([Path("/dev/x"), Path("/dev/y")], "/dev/x, /dev/y")])
def test_missing_ports_are_reported_with_the_ports_of_this_machine(monkeypatch, here: list[Path], named: str):
    monkeypatch.setattr(ports, "ports_here", lambda: here)
    with pytest.raises(ConfigError) as error:
        read_ports([], ["left", "right"])
    remedy = "no port given; add --port left=PATH --port right=PATH; serial ports here:"
    assert str(error.value) == f"{remedy} {named}"


def test_port_options_that_leave_a_bus_without_a_port_are_refused():
    with pytest.raises(ConfigError, match=r"^a bus has no port; add --port right=PATH$"):
        read_all_ports(["left=/dev/a"], ["left", "right"])


def test_calibration_files_of_lerobot_are_converted_without_servos(kinesic, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    motors = {f"m{k}": {"id": k, "homing_offset": 10, "range_min": 100, "range_max": 4000} for k in range(1, 7)}
    (tmp_path / "arm.json").write_text(json.dumps(motors))
    options = [text for bus in ("left", "right") for text in ("--lerobot", f"{bus}={tmp_path}/arm.json")]
    ended = kinesic("servos", "calibrate", "--robot", "so101_pair", *options)
    assert ended.code == 0, ended.err
    written = tomllib.loads((tmp_path / "kinesic" / "so101_pair.calibration.toml").read_text())
    assert (written["zero_ticks"]["l_elbow_flexion"], written["zero_ticks"]["r_elbow_flexion"]) == (1218, 1218)
    wrong = kinesic("servos", "calibrate", "--robot", "so101_pair", "--lerobot", "arm=a.json")
    assert "--lerobot arm=a.json: no bus arm" in wrong.err
    both = kinesic("servos", "calibrate", "--robot", "so101_pair", *options, "--pypot", "a.json")
    assert "--lerobot and --pypot: give one of them" in both.err
    other = kinesic("servos", "calibrate", "--robot", "so101_pair", "--pypot", "a.json")
    assert "so101_pair is no robot of pypot that kinesic knows" in other.err
