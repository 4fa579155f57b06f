import inspect
import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib import import_module

import click
import numpy as np
import pytest

from kinesic import cli
from kinesic.cli import options

NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
WALK = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><locomotion id="w" target="door"/></bml>'
SLOW_MODULES = {
    *("casadi", "glfw", "matplotlib", "mujoco", "OpenGL", "PIL", "scipy", "serial"),
    *(
        f"kinesic.{room}"
        for room in ("expressivity", "ik", "motion", "planning", "realizer", "report", "speech", "studies")
    ),
}


def test_plan_command_writes_a_motion_file(kinesic, tmp_path):
    ended = kinesic("plan", "-", "--variation", "0", "--out", "nod.npz", stdin=NOD)
    assert ended.code == 0
    assert ended.out.splitlines()[-1] == "motion: nod.npz"
    with np.load(tmp_path / "nod.npz") as data:
        tilt = data["angles"][:, list(data["names"]).index("skullbase_tilt")]
    assert np.isclose(np.degrees(tilt.max()), 10.0, atol=0.1)  # amount 0.5 x 20 deg


def test_validate_searches_folders_and_ends_with_totals(kinesic, tmp_path):
    folder = tmp_path / "documents"
    folder.mkdir()
    (folder / "nod.bml").write_bytes(NOD)
    (folder / "walk.xml").write_bytes(WALK)
    (folder / "broken.xml").write_bytes(b"<bml>")
    (folder / "notes.txt").write_bytes(b"not a document")
    ended = kinesic("validate", folder, "--json", "--jobs", "2", "--out", "reports")
    summary = json.loads(ended.out)
    outcomes = {entry["file"].split("/")[-1]: entry for entry in summary["documents"]}
    assert {name: entry["outcome"] for name, entry in outcomes.items()} == {
        "nod.bml": "performed",
        "walk.xml": "refused",
        "broken.xml": "refused",
    }
    assert ":1:" in outcomes["broken.xml"]["error"]
    assert "can perform none of its behaviours" in outcomes["walk.xml"]["error"]
    assert json.loads((tmp_path / outcomes["nod.bml"]["report"]).read_text())["ok"]
    assert summary["totals"]["documents"] == 3
    assert summary["totals"]["performed"] == 1
    assert ended.code == 0


def test_validate_prints_a_table_of_behaviour_outcomes(kinesic, tmp_path):
    (tmp_path / "nod.bml").write_bytes(NOD)
    ended = kinesic("validate", tmp_path / "nod.bml")
    assert ended.code == 0
    assert "substituted" in ended.out


def test_validate_reports_a_missing_path(kinesic):
    ended = kinesic("validate", "nowhere")
    assert ended.code == 2
    assert ended.err == "kinesic: nowhere: no such file or folder; built-in documents: night, story, welcome\n"


def test_robots_list_show_and_check_commands_print_robots_joints_and_reached_sectors(kinesic):
    assert "upper22" in kinesic("robots", "list").out
    assert "l_elbow_flexion" in kinesic("robots", "show").out
    checked = kinesic("robots", "check")
    assert checked.code == 0
    assert "66 of 105 sectors" in checked.out


def test_gestures_list_and_show_commands_print_gestures_and_refuse_an_unknown_name(kinesic):
    entries = json.loads(kinesic("gestures", "list", "--json").out)
    assert len(entries) >= 40
    assert "offer" in kinesic("gestures", "show", "offer").out
    unknown = kinesic("gestures", "show", "xyzzy")
    assert unknown.code == 2
    assert unknown.err.startswith("kinesic: no gesture xyzzy")


def test_doctor_lists_optional_components(kinesic):
    ended = kinesic("doctor")
    assert ended.code == 0
    for piece in ("film", "face", "speech"):
        assert piece in ended.out


def test_pointing_targets_are_read_from_a_file(kinesic, tmp_path):
    (tmp_path / "targets.toml").write_text("bluebox = [1.0, 0.6, 0.9]\n")
    point = NOD.replace(b'<head id="h" lexeme="NOD" start="0.2"/>', b'<pointing id="p" target="bluebox"/>')
    without = json.loads(kinesic("perform", "-", "--no-film", "--json", "--out", "a", stdin=point).out)
    assert without["behaviours"][0]["outcome"] == "dropped"
    assert without["warnings"][0]["type"] == "NO_SUCH_TARGET"
    options = ("--targets", "targets.toml", "--no-film", "--json", "--out", "b")
    assert json.loads(kinesic("perform", "-", *options, stdin=point).out)["behaviours"][0]["outcome"] == "realised"


def test_help_describes_every_verb(kinesic):
    ended = kinesic("--help")
    lines = ended.out.partition("\nPerform:\n")[2].splitlines()
    rows = [line.split() for line in lines if line.startswith("  ")]
    assert ended.code == 0
    assert {"perform", "serve", "servos", "validate"} <= {verb for verb, *_ in rows}
    assert [verb for verb, *words in rows if len(words) < 2] == [], "kinesic/cli/verbs.py: give them a longer docstring"


def commands(group: click.Group, *words: str) -> Iterator[tuple[str, ...]]:
    """Yield the command words of every verb, such as `servos scan`."""
    for name, command in group.commands.items():
        yield (*words, name)
        if isinstance(command, click.Group):
            yield from commands(command, *words, name)


def test_help_imports_no_slow_modules():
    """Print all help pages in a new process."""
    program = f"""import sys
from kinesic.cli import kinesic
for words in {[(), *commands(cli.kinesic)]}:
    for flag in ("-h", "--help"):
        kinesic([*words, flag], standalone_mode=False)
print("slow:", *{SLOW_MODULES} & sys.modules.keys())
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "slow:"
    assert {"--feedforward", "--baud", "--parameter"} <= {*done.stdout.split()}


@pytest.mark.parametrize("words", [*commands(cli.kinesic)], ids=" ".join)
def test_function_behind_each_command_accepts_the_command_options(words, monkeypatch):
    command: click.Command = cli.kinesic
    for word in words:
        command = command.commands[word]
    if isinstance(command, click.Group):
        return

    class Checked:
        """Module whose functions only check their arguments."""

        def __init__(self, name: str) -> None:
            self.module = import_module(name)

        def __getattr__(self, name: str) -> Callable[..., int]:
            signature = inspect.signature(getattr(self.module, name))
            return lambda **arguments: len(signature.bind(**arguments).arguments)

    monkeypatch.setattr(options, "import_at_once", Checked)
    assert command.callback(**{option.name: None for option in command.params}) <= max(1, len(command.params))


def test_unknown_verb_and_option_are_refused(kinesic):
    assert kinesic("dance").code == 2
    assert kinesic("perform", "x.bml", "--nonsense").code == 2


def test_bap_motion_is_planned_and_performed(kinesic, tmp_path):
    assert kinesic("plan", "-", "--variation", "0", "--out", "nod.bap", stdin=NOD).code == 0
    ended = kinesic("plan", "nod.bap", "--variation", "0", "--out", "again.npz")
    assert ended.code == 0
    with np.load(tmp_path / "again.npz") as data:
        tilt = data["angles"][:, list(data["names"]).index("skullbase_tilt")]
    assert np.isclose(np.degrees(tilt.max()), 10.0, atol=0.3)
    ended = kinesic("perform", "nod.bap", "--out", "performed", "--no-film")
    assert ended.code == 0
    report = json.loads((tmp_path / "performed" / "report.json").read_text())
    assert report["ok"]
    assert report["input"] == "nod.bap"


def test_invalid_bap_file_is_reported_with_its_line(kinesic, tmp_path):
    (tmp_path / "bad.bap").write_text("3.2 bad 25 1\n1 0\n0 1\n")
    ended = kinesic("perform", "bad.bap")
    assert ended.code == 2
    assert ended.err == "kinesic: bad.bap:2: a mask of 2 words; must be 296 flags, each 0 or 1\n"
