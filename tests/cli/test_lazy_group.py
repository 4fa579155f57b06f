import json
import subprocess
import sys

import click
import numpy as np
import pytest

from kinesic import cli
from kinesic.cli.servos import servos

NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
WALK = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><locomotion id="w" target="door"/></bml>'
LIMITS = range(5, 120)  # letters


def test_plan_writes_a_motion(kinesic, tmp_path):
    ended = kinesic("plan", "-", "--out", "nod.npz", stdin=NOD)
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
    found = json.loads(ended.out)
    outcomes = {entry["file"].split("/")[-1]: entry for entry in found["documents"]}
    assert {name: entry["outcome"] for name, entry in outcomes.items()} == {
        "nod.bml": "performed",
        "walk.xml": "refused",
        "broken.xml": "refused",
    }
    assert ":1:" in outcomes["broken.xml"]["error"]
    assert "can perform none of its behaviours" in outcomes["walk.xml"]["error"]
    assert json.loads((tmp_path / outcomes["nod.bml"]["report"]).read_text())["ok"]
    assert found["totals"]["documents"] == 3
    assert found["totals"]["performed"] == 1
    assert ended.code == 0


def test_validate_prints_a_table(kinesic, tmp_path):
    (tmp_path / "nod.bml").write_bytes(NOD)
    ended = kinesic("validate", tmp_path / "nod.bml")
    assert ended.code == 0
    assert "substituted" in ended.out


def test_validate_names_a_path_that_is_not_there(kinesic):
    ended = kinesic("validate", "nowhere")
    assert ended.code == 2
    assert ended.err == "kinesic: nowhere: no such file or folder\n"


def test_robots(kinesic):
    assert "upper22" in kinesic("robots", "list").out
    assert "l_elbow_flexion" in kinesic("robots", "show").out
    checked = kinesic("robots", "check")
    assert checked.code == 0
    assert "66 of 105 sectors" in checked.out


def test_gestures(kinesic):
    entries = json.loads(kinesic("gestures", "list", "--json").out)
    assert len(entries) >= 40
    assert "offer" in kinesic("gestures", "show", "offer").out
    unknown = kinesic("gestures", "show", "xyzzy")
    assert unknown.code == 2
    assert unknown.err.startswith("kinesic: no gesture xyzzy")


def test_doctor_names_every_piece(kinesic):
    ended = kinesic("doctor")
    assert ended.code == 0
    for piece in ("ik kernel", "film", "face", "speech"):
        assert piece in ended.out


def test_targets_from_a_file(kinesic, tmp_path):
    (tmp_path / "targets.toml").write_text("bluebox = [1.0, 0.6, 0.9]\n")
    point = NOD.replace(b'<head id="h" lexeme="NOD" start="0.2"/>', b'<pointing id="p" target="bluebox"/>')
    without = json.loads(kinesic("perform", "-", "--no-film", "--json", "--out", "a", stdin=point).out)
    assert without["behaviours"][0]["outcome"] == "dropped"
    assert without["warnings"][0]["type"] == "NO_SUCH_TARGET"
    options = ("--targets", "targets.toml", "--no-film", "--json", "--out", "b")
    assert json.loads(kinesic("perform", "-", *options, stdin=point).out)["behaviours"][0]["outcome"] == "realised"


def test_help_tells_what_every_verb_does(kinesic):
    ended = kinesic("--help")
    rows = [line.split() for line in ended.out.partition("Commands:\n")[2].splitlines()]
    assert ended.code == 0
    assert {"perform", "serve", "servos", "validate"} <= {verb for verb, *_ in rows}
    assert all(len(words) > 3 for words in rows)


@pytest.mark.parametrize("group", [cli.kinesic, servos], ids=lambda group: group.name)
def test_the_list_of_verbs_says_what_they_say_themselves(group):
    context = click.Context(group)
    for verb in group.list_commands(context):
        own = group.get_command(context, verb)
        assert [group.short_help_of(verb, limit) for limit in LIMITS] == [
            own.get_short_help_str(limit) for limit in LIMITS
        ]


def test_a_verb_waits_for_no_library_of_another_one():
    """Seen in a process of its own, which has imported nothing yet; lists of verbs wait for none."""
    said = helped([], ["servos"], ["servos", "scan"], beside={"casadi", "matplotlib", "mujoco", "scipy"})
    assert "validate" in said
    assert "calibrate" in said
    assert "--baud" in said


def test_the_help_of_a_verb_waits_for_nothing_that_only_its_work_needs():
    slow = {"matplotlib", "scipy.interpolate", "scipy.linalg", "scipy.optimize", "scipy.sparse"}
    assert "--force" in helped(["perform"], ["serve"], ["validate"], beside=slow)


def helped(*verbs, beside):
    """What a fresh process says of verbs, which imports none of some libraries."""
    program = f"""import sys
from kinesic.cli import kinesic
for words in {verbs}:
    kinesic([*words, "--help"], standalone_mode=False)
print("heavy:", *{beside} & sys.modules.keys())
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "heavy:"
    return done.stdout


def test_an_unknown_verb_or_option_is_bad_input(kinesic):
    assert kinesic("dance").code == 2
    assert kinesic("perform", "x.bml", "--nonsense").code == 2


def test_a_motion_in_bap_is_planned_and_performed_again(kinesic, tmp_path):
    assert kinesic("plan", "-", "--out", "nod.bap", stdin=NOD).code == 0
    ended = kinesic("plan", "nod.bap", "--out", "again.npz")
    assert ended.code == 0
    with np.load(tmp_path / "again.npz") as data:
        tilt = data["angles"][:, list(data["names"]).index("skullbase_tilt")]
    assert np.isclose(np.degrees(tilt.max()), 10.0, atol=0.3)
    ended = kinesic("perform", "nod.bap", "--out", "performed", "--no-film")
    assert ended.code == 0
    report = json.loads((tmp_path / "performed" / "report.json").read_text())
    assert report["ok"]
    assert report["input"] == "nod.bap"


def test_a_broken_bap_names_its_line(kinesic, tmp_path):
    (tmp_path / "bad.bap").write_text("3.2 bad 25 1\n1 0\n0 1\n")
    ended = kinesic("perform", "bad.bap")
    assert ended.code == 2
    assert ended.err == "kinesic: bad.bap:2: a mask of 2 words; must be 296 flags, each 0 or 1\n"
