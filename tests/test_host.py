"""Kinesic on systems other than Linux, with a simulated Windows."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import click
import pytest

from kinesic import host
from kinesic.body.config import ConfigError
from kinesic.cli import kinesic
from kinesic.host import HostFeature

WINDOWS_HOST = Path(__file__).parent / "windows_host"
ROOT = Path(host.__file__).parents[1]  # folder that contains the package
NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
LIVE_VERBS = [("serve",), ("studio",), ("mcp",), ("say", "-")]
SERVO_VERBS = [
    *(("servos", verb) for verb in ("calibrate", "doctor", "release", "scan", "show", "stop")),
    ("perform", "nod.bml", "--on", "servos", "--port", "COM3"),
]
LINUX_VERBS = [("servos", "simulate"), ("bench", "bus"), ("bench", "bus", "--matrix")]
WORKING_VERBS = [
    ("perform", "nod.bml", "--no-film", "--voice", "durations", "--out", "report"),
    ("perform", "nod.bml", "--no-film", "--voice", "durations", "--out", "report", "--force"),
    ("plan", "nod.bml", "--out", "nod.npz"),
    ("gestures", "find", "hello"),
    ("gestures", "show", "offer"),
    ("robots", "list"),
    ("robots", "show", "upper22"),
    ("styles", "show", "joyful"),
    ("completion", "bash"),
    ("say", "Hello there.", "--to", "bml"),
    ("new", "gesture", "mine"),
]


def windows(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python on the simulated Windows."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (WINDOWS_HOST, ROOT)))}
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        stdin=subprocess.DEVNULL,
    )


def help_lines(group: click.Group, *words: str) -> Iterator[tuple[str, ...]]:
    """Yield the command line that shows the help of each verb."""
    for name, command in group.commands.items():
        yield (*words, name, "-h")
        if isinstance(command, click.Group):
            yield from help_lines(command, *words, name)


@pytest.fixture(scope="module")
def ended(tmp_path_factory) -> dict[tuple[str, ...], tuple[int, str, str]]:
    """Run all command lines on the simulated Windows, in one process."""
    folder = tmp_path_factory.mktemp("windows")
    (folder / "nod.bml").write_text(NOD)
    lines = [*help_lines(kinesic), *LIVE_VERBS, *SERVO_VERBS, *LINUX_VERBS, *WORKING_VERBS]
    done = windows(folder, str(WINDOWS_HOST / "run_verbs.py"), json.dumps(lines))
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout.splitlines()[-1])
    assert "kinesic.cli.live.serve" in answer["modules"]
    return {line: tuple(end) for line, end in zip(lines, answer["ended"], strict=True)}


def test_every_kinesic_verb_shows_its_help_on_simulated_windows(ended):
    assert [line for line in help_lines(kinesic) if ended[line][0] != 0] == []


@pytest.mark.parametrize(
    ("lines", "feature"),
    [
        (LIVE_VERBS, "the live server (serve, studio, mcp, say -) needs Linux or macOS"),
        (SERVO_VERBS, "the servo driver needs Linux or macOS"),
        (LINUX_VERBS, "the simulation of servo ports needs Linux"),
    ],
    ids=["live", "servos", "simulation"],
)
def test_commands_unsupported_on_windows_name_the_missing_feature_in_one_line(ended, lines, feature):
    for line in lines:
        code, _, err = ended[line]
        assert (code, err.count("\n")) == (2, 1), (line, err)
        assert err.startswith(f"kinesic: {feature}, and this is Windows; run it in "), line


def test_kinesic_plans_performs_and_replaces_reports_on_simulated_windows(ended):
    for line in WORKING_VERBS:
        code, out, err = ended[line]
        assert code == 0, (line, out, err)
    assert "ok: nod.bml on upper22" in ended[WORKING_VERBS[0]][1]


def test_simulated_windows_has_no_folder_descriptors_and_no_user_ids(tmp_path):
    print_platforms = "print(host.sys.platform, host.HAS_FOLDER_DESCRIPTORS, host.user_id(), sys.platform)"
    done = windows(tmp_path, "-c", f"import sys\nfrom kinesic import host\n{print_platforms}")
    assert done.stdout.split() == ["win32", "False", "0", sys.platform], done.stderr


@pytest.mark.parametrize(
    ("platform", "missing"),
    [("linux", []), ("darwin", ["STOP_FROM_OUTSIDE", "VIRTUAL_PORTS"]), ("win32", None)],
    ids=["linux", "macos", "windows"],
)
def test_linux_has_all_host_features_macos_lacks_two_and_windows_has_none(monkeypatch, platform, missing):
    monkeypatch.setattr(sys, "platform", platform)
    spec = spec_from_file_location("host_of_another_system", host.__file__)
    assert spec is not None
    assert spec.loader is not None
    spec.loader.exec_module(again := module_from_spec(spec))
    features = {name: value for name, value in vars(again).items() if isinstance(value, again.HostFeature)}
    lacking = [name for name, feature in features.items() if not feature.is_available]
    assert sorted(lacking) == sorted(features if missing is None else missing)


def test_missing_host_feature_error_names_the_required_system():
    HostFeature("the feature", "Linux", True, "do without").require()
    with pytest.raises(ConfigError, match=r"^the feature needs Linux, and this is .+; do without$"):
        HostFeature("the feature", "Linux", False, "do without").require()


@pytest.mark.soak
@pytest.mark.parametrize(
    "line",
    [
        ("perform", "nod.bml", "--film-size", "160x90", "--film-rate", "5", "--out", "filmed"),
        ("validate", "nod.bml", "--jobs", "2", "--out", "validated"),
        ("sweep", "beat", "--parameter", "power", "--values", "0,0.5", "--out", "swept"),
        ("demo", "--no-open", "--no-film"),
    ],
    ids=lambda line: line[0],
)
def test_commands_with_child_processes_succeed_on_simulated_windows(tmp_path, line):
    (tmp_path / "nod.bml").write_text(NOD)
    done = windows(tmp_path, "-m", "kinesic", *line)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
