"""Verb `kinesic servos calibrate` on virtual servos that are moved by hand."""

import tomllib
from collections.abc import Callable
from contextlib import nullcontext
from io import StringIO
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.cli.screen.console import Console
from kinesic.cli.servos import calibrate
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.calibration import Travel, measure_hinges

HINGE_RANGES = {hinge.name: np.degrees([hinge.lower, hinge.upper]) for hinge in Robot.load().skeleton.hinges}


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """User's robot file, a copy of the default robot."""
    path = tmp_path / "mine.toml"
    path.write_text(Robot.load().path.read_text(encoding="utf-8"), encoding="utf-8")
    return path


@pytest.fixture
def move_after_zero(table, monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Return a function that schedules motions by hand after the zero posture."""
    read_zero_posture = calibrate.read_zero_posture

    def schedule(*moves: Callable[[str], float]) -> None:
        def begin(*arguments, **keywords):
            travel = read_zero_posture(*arguments, **keywords)
            table.turn(*moves)
            return travel

        monkeypatch.setattr(calibrate, "read_zero_posture", begin)

    return schedule


@pytest.fixture
def times(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Times [s] of the snapshots that are taken after the zero posture."""
    seen: list[float] = []
    counted = calibrate.count_ticks

    def count(snapshot):
        seen.append(snapshot.time)
        return counted(snapshot)

    monkeypatch.setattr(calibrate, "count_ticks", count)
    return seen


def test_calibrate_writes_zeros_directions_and_ranges_measured_by_hand(kinesic, table, mine, monkeypatch):
    read_zero_posture = calibrate.read_zero_posture

    def read_and_move(*arguments, **keywords):
        travel = read_zero_posture(*arguments, **keywords)
        table.turn(
            lambda hinge: 15.0 if hinge != "vl5_roll" else -15.0,
            lambda hinge: HINGE_RANGES[hinge][1] if hinge != "l_elbow_flexion" else 110.0,
            lambda hinge: HINGE_RANGES[hinge][0],
        )
        return travel

    monkeypatch.setattr(calibrate, "read_zero_posture", read_and_move)
    table.set(15, Register.MIN_POSITION_LIMIT, 1000)
    table.set(15, Register.HOMING_OFFSET, 100)
    options = ("--robot", mine, "--port", table.port, "--yes", "--seconds", "2")
    ended = kinesic("servos", "calibrate", *options)
    path = mine.with_name("mine.calibration.toml")
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.splitlines()[-1] == f"calibration: {path}"
    assert "l_elbow_flexion moves only 0..110 deg" in ended.out
    written = tomllib.loads(path.read_text(encoding="utf-8"))
    skeleton = Robot.load().skeleton
    rest = float(np.degrees(skeleton.rest[skeleton.joint("l_elbow_flexion")]))
    assert written["zero_ticks"]["l_elbow_flexion"] == pytest.approx(2048 + rest * 4096 / 360, abs=1)
    assert [hinge for hinge, inverted in written["inverted"].items() if inverted] == ["vl5_roll"]
    assert written["range_deg"] == {"l_elbow_flexion": [0, 110]}
    assert np.degrees(Robot.load(mine).skeleton.upper[Robot.load().skeleton.joint("l_elbow_flexion")]) == 110
    assert "servo 15: HOMING_OFFSET 100 -> 0\nservo 15: MIN_POSITION_LIMIT 1000 -> 0\n" in ended.out
    assert table.energised == 0


def test_calibrate_refuses_a_symlink_as_output_file(kinesic, table, mine):
    path = mine.with_name("mine.calibration.toml")
    path.symlink_to("nowhere.toml")
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, "--yes", "--seconds", "1")
    assert ended.code == 2
    assert ended.err == f"kinesic: {path} is a link, and links are never followed; name the file itself\n"
    assert not mine.with_name("nowhere.toml").exists()


def test_calibrate_refuses_servos_whose_torque_is_on(kinesic, table, mine):
    table.energise()
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, "--yes", "--seconds", "1")
    assert ended.code == 2
    assert "has torque, as have 22 others" in ended.err
    assert not mine.with_name("mine.calibration.toml").exists()


def turn_all_but(still: str) -> list[Callable[[str], float]]:
    """Schedule motions of every hinge but one to its upper and lower limit."""
    return [lambda hinge, end=end: 0.0 if hinge == still else HINGE_RANGES[hinge][end] for end in (1, 0)]


def test_calibrate_keeps_earlier_values_of_joints_that_were_not_turned(kinesic, table, mine, move_after_zero):
    path = mine.with_name("mine.calibration.toml")
    name = Robot.load().name
    path.write_text(f'robot = "{name}"\n[inverted]\nl_elbow_flexion = true\n[range_deg]\nl_elbow_flexion = [0, 100]\n')
    move_after_zero(*turn_all_but("l_elbow_flexion"))
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, "--yes", "--seconds", "2")
    assert (ended.code, ended.err) == (0, "")
    *_, unturned, narrowed, last = ended.out.splitlines()
    assert unturned == "not turned, so their directions and limits are unchanged: l_elbow_flexion"
    assert (narrowed, last) == ("l_elbow_flexion moves only 0..100 deg", f"calibration: {path}")
    written = tomllib.loads(path.read_text(encoding="utf-8"))
    assert written["inverted"]["l_elbow_flexion"]
    assert written["range_deg"] == {"l_elbow_flexion": [0, 100]}


def test_calibrate_ends_when_every_hinge_was_turned_through_its_range(kinesic, table, mine, move_after_zero, times):
    move_after_zero(*turn_all_but(""))
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, "--yes", "--seconds", "100")
    assert ended.code == 0
    assert times[-1] - times[0] < 2.0
    assert "not turned" not in ended.out
    assert "moves only" not in ended.out
    assert all(servo.memory[Register.MIN_POSITION_LIMIT] == 0 for servo in table.plant.servos)
    assert all(servo.memory[Register.MAX_POSITION_LIMIT] == 4095 for servo in table.plant.servos)
    (row,) = [line for line in ended.out.splitlines() if line.strip().startswith("l_elbow_flexion ")]
    lower, upper = HINGE_RANGES["l_elbow_flexion"]
    assert row.split()[:2] == ["l_elbow_flexion", "15"]
    assert row.split()[-1] == "whole"
    assert f"{lower:.0f}..{upper:.0f}" in row


def test_calibrate_ends_after_the_time_limit(kinesic, table, mine, move_after_zero, times):
    move_after_zero(*turn_all_but("l_elbow_flexion"))
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, "--yes", "--seconds", "3")
    assert ended.code == 0
    assert times[-1] - times[0] == pytest.approx(3.0, abs=0.15)
    assert np.diff(times[2:]) == pytest.approx(0.05, abs=0.02)


@pytest.mark.parametrize("key", ["\r", "\n", "xy\n"])
def test_enter_ends_an_interactive_calibration(kinesic, table, mine, times, monkeypatch, key: str):
    pressed = iter(["", "x", "", key])
    monkeypatch.setattr(calibrate, "pressed_keys", lambda: nullcontext(lambda: next(pressed)))
    terminal = SimpleNamespace(isatty=lambda: True)
    monkeypatch.setattr(calibrate, "sys", SimpleNamespace(stdin=terminal, stdout=terminal))
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, stdin=b"\n")
    assert ended.code == 0, ended.err
    assert len(times) == 1 + 4
    assert f"{calibrate.ZERO_POSTURE_PROMPT}\nThen press Enter" in ended.out
    assert f"{calibrate.TURN_HINGES_PROMPT} Enter ends." in ended.out


@pytest.mark.parametrize("height", [24, 12, 60])
def test_calibration_progress_fits_the_terminal_with_prompt_and_untruncated_names(height: int):
    robot = Robot.load()
    manifest = Manifest.of(robot)
    hinges = measure_hinges(Travel.begin(np.full(len(manifest.members), 2048)), manifest, robot)
    terminal = Console(StringIO(), 80 if height < 60 else 140, height)
    terminal.print(*calibrate.show_progress(hinges, robot, height=height))
    lines = terminal.file.getvalue().splitlines()
    assert len(lines) <= height
    assert "Enter ends." in " ".join(line.strip() for line in lines[-3:])
    assert not any("\u2026" in line for line in lines)
    named = [hinge.hinge for hinge in hinges if any(line.strip().startswith(hinge.hinge) for line in lines)]
    assert (
        len(named) == len(hinges) if height == 60 else len(named) == min(height - calibrate.PROMPT_LINES, len(hinges))
    )


def test_calibrate_with_yes_does_not_ask_for_the_zero_posture(kinesic, table, mine):
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, "--yes", "--seconds", "0.2")
    assert ended.code == 0
    assert "Then press Enter" not in ended.out


@pytest.mark.parametrize("option", [("--yes",), ("--seconds", "1")])
def test_calibrate_without_a_terminal_is_refused_if_option_yes_or_seconds_is_missing(
    kinesic, table, mine, option: tuple[str, ...]
):
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, *option)
    assert ended.code == 2
    assert ended.err == "kinesic: standard input is no terminal; give --yes and --seconds N\n"


def test_calibrate_fails_without_writing_a_file_if_a_servo_stops_answering(kinesic, table, mine, monkeypatch, tmp_path):
    prepared = calibrate.prepare_servos
    options = ("--robot", mine, "--port", table.port, "--yes", "--seconds", "1")

    def silence(*arguments, **keywords):
        axes = prepared(*arguments, **keywords)
        table.plant.servos[4].mute = True
        return axes

    monkeypatch.setattr(calibrate, "prepare_servos", silence)
    ended = kinesic("servos", "calibrate", *options)
    assert ended.code == 2
    assert ended.err == "kinesic: not all servos answer; run `kinesic servos doctor` to find the cause\n"
    assert not mine.with_name("mine.calibration.toml").exists()


def test_calibration_of_a_packaged_robot_is_written_to_the_user_configuration_folder(
    kinesic, table, tmp_path, monkeypatch
):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "new" / "config"))
    for _ in range(2):
        ended = kinesic("servos", "calibrate", "--port", table.port, "--yes", "--seconds", "0.2")
        assert ended.code == 0, ended.err
    written = tmp_path / "new" / "config" / "kinesic" / "upper22.calibration.toml"
    assert ended.out.splitlines()[-1] == f"calibration: {written}"
    assert tomllib.loads(written.read_text(encoding="utf-8"))["robot"] == Robot.load().name
