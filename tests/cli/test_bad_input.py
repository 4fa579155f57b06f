"""Invalid input: one line and exit code 2, or one dropped behaviour."""

import json

import pytest

from kinesic.body.config import CONFIGS

UPPER22 = (CONFIGS / "robots" / "upper22.toml").read_text()
BLOCK_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
NOD = '<head id="h" lexeme="NOD" start="0.2"/>'
SPEECH = '<speech id="s"><text>Well, <sync id="m"/>hello.</text></speech>'

REFUSED_DOCUMENTS = {
    "empty file": "",
    "not XML": "hello there",
    "entity": '<!DOCTYPE bml [<!ENTITY e "x">]>' + BLOCK_TEMPLATE.format(NOD),
    "entity in an attribute": '<!DOCTYPE bml [<!ENTITY e "NOD">]>'
    + BLOCK_TEMPLATE.format('<head id="h" lexeme="&e;"/>'),
    "time of 1e9 s": BLOCK_TEMPLATE.format('<head id="h" lexeme="NOD" start="1e9"/>'),
    "NaN": BLOCK_TEMPLATE.format('<head id="h" lexeme="NOD" start="nan"/>'),
    "amount NaN": BLOCK_TEMPLATE.format('<head id="h" lexeme="NOD" amount="nan"/>'),
    "unknown behaviour in a reference": BLOCK_TEMPLATE.format('<head id="h" lexeme="NOD" start="nobody:end"/>'),
    "failure inside required": BLOCK_TEMPLATE.format('<required><locomotion id="l" target="door"/></required>'),
}


@pytest.mark.parametrize("name", REFUSED_DOCUMENTS)
def test_invalid_document_is_refused_with_one_line_and_its_location(name, kinesic, tmp_path):
    path = tmp_path / "bad.bml"
    path.write_text(REFUSED_DOCUMENTS[name])
    ended = kinesic("perform", path, "--out", "there", "--no-film")
    assert ended.code == 2
    assert ended.err.startswith(f"kinesic: {path}:")
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "there").exists()


def test_document_of_100_mb_is_refused_by_its_size(kinesic, tmp_path):
    path = tmp_path / "big.bml"
    with path.open("wb") as file:
        file.write(BLOCK_TEMPLATE.format(NOD).encode())
        file.truncate(100_000_000)
    ended = kinesic("perform", path, "--out", "there", "--no-film")
    assert ended.code == 2
    assert "4 MB" in ended.err or "4000000" in ended.err.replace(" ", "").replace("_", "")


DROPPED_BEHAVIOURS = {  # id of the dropped behaviour, and its BML
    "unknown behaviour": ("dance", '<dance id="dance"/>'),
    "unknown sync of a known speech": ("lost", SPEECH + '<head id="lost" lexeme="NOD" stroke="s:nowhere"/>'),
    "cyclic sync": (
        "first",
        '<head id="first" lexeme="NOD" start="second:end"/><head id="second" lexeme="NOD" start="first:end"/>',
    ),
    "negative duration": ("back", '<head id="back" lexeme="NOD" start="3" end="1"/>'),
    "locomotion": ("walk", '<locomotion id="walk" target="door"/>'),
}


@pytest.fixture(scope="module")
def odd_run(kinesic_in, tmp_path_factory):
    """Report of a nod together with all behaviours that are dropped."""
    folder = tmp_path_factory.mktemp("odd")
    (folder / "odd.bml").write_text(
        BLOCK_TEMPLATE.format(NOD + "".join(text for _, text in DROPPED_BEHAVIOURS.values()))
    )
    return kinesic_in(folder, "perform", "odd.bml", "--out", "there", "--no-film", "--json")


@pytest.mark.parametrize("name", DROPPED_BEHAVIOURS)
def test_unperformable_behaviour_is_dropped_with_a_warning_while_others_perform(name, odd_run):
    assert odd_run.code == 0, odd_run.err
    data, (dropped_id, _) = json.loads(odd_run.out), DROPPED_BEHAVIOURS[name]
    outcomes = {entry["id"]: entry for entry in data["behaviours"]}
    assert outcomes["h"]["outcome"] == "realised"
    assert outcomes[dropped_id]["outcome"] == "dropped"
    assert outcomes[dropped_id]["why"]
    assert any(warning["id"] == f"b:{dropped_id}" for warning in data["warnings"])


@pytest.mark.parametrize("seconds", [125, pytest.param(915, marks=pytest.mark.soak)])
def test_block_longer_than_two_minutes_is_performed(kinesic, tmp_path, seconds):
    path = tmp_path / "long.bml"
    path.write_text(
        BLOCK_TEMPLATE.format(NOD + f'<head id="late" lexeme="NOD" start="{seconds - 1}" end="{seconds}"/>')
    )
    ended = kinesic("perform", path, "--out", "there", "--no-film", "--json")
    assert ended.code == 0, ended.err
    assert json.loads(ended.out)["timing"]["duration_s"] >= seconds


def test_missing_robot_file_is_reported(kinesic, tmp_path):
    document = tmp_path / "nod.bml"
    document.write_text(BLOCK_TEMPLATE.format(NOD))
    ended = kinesic("perform", document, "--robot", "nowhere.toml")
    assert ended.code == 2
    assert ended.err == "kinesic: nowhere.toml: no such file\n"


INVALID_ROBOTS = {
    "misspelt key": (("range_deg = [-50, 50]", "rnage_deg = [-50, 50]"), "did you mean range_deg?"),
    "servo id twice": (("l_wrist_pivot = 18", "l_wrist_pivot = 17"), "17"),
    "unknown servo": (('servo = "xm540_w150"', 'servo = "xm540_w15"'), "did you mean xm540_w150?"),
    "range upside down": (("range_deg = [-50, 50]", "range_deg = [50, -50]"), "must be [low, high]"),
}


@pytest.mark.parametrize("name", INVALID_ROBOTS)
def test_invalid_robot_file_is_reported_in_one_line(name, kinesic, tmp_path):
    (old, new), hint = INVALID_ROBOTS[name]
    robot = tmp_path / "mine.toml"
    robot.write_text(UPPER22.replace(old, new, 1))
    document = tmp_path / "nod.bml"
    document.write_text(BLOCK_TEMPLATE.format(NOD))
    ended = kinesic("perform", document, "--robot", robot, "--out", "there", "--no-film")
    assert ended.code == 2
    assert "mine.toml" in ended.err
    assert hint in ended.err
    assert ended.err.count("\n") == 1


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("power=7", "power is 7, outside [-1, 1]"),
        ("head.openness=-1", "head.openness is -1, outside [0, 1]"),
        ("hed.power=0", "a style has no modality 'hed'; did you mean head?"),
    ],
)
def test_invalid_setting_is_reported_with_valid_values(kinesic, tmp_path, setting, message):
    document = tmp_path / "nod.bml"
    document.write_text(BLOCK_TEMPLATE.format(NOD))
    ended = kinesic("perform", document, "--set", setting)
    assert ended.code == 2
    assert ended.err == f"kinesic: {message}\n"


@pytest.mark.parametrize(
    ("attribute", "message"),
    [
        ("kinesic:power='7'", "kinesic:power='7' is out of range; use -1 to 1"),
        ("kinesic:stile='sad'", "kinesic:stile is not a parameter; did you mean style?"),
        ("kinesic:style='sat'", "kinesic:style='sat' is not a style; did you mean sad?"),
    ],
)
def test_invalid_style_attribute_is_reported_with_its_location(kinesic, tmp_path, attribute, message):
    document = tmp_path / "nod.bml"
    document.write_text(BLOCK_TEMPLATE.format(NOD.replace("/>", f" {attribute}/>")))
    ended = kinesic("perform", document)
    assert ended.code == 2
    assert ended.err.startswith(f"kinesic: {document}:")
    assert ended.err.endswith(f"{message}\n")
