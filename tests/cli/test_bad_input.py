"""Every bad input has the outcome that is promised: one line and exit code 2, or a named drop and a performance."""

import json

import pytest

from kinesic.body.config import CONFIGS

UPPER22 = (CONFIGS / "robots" / "upper22.toml").read_text()
BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
NOD = '<head id="h" lexeme="NOD" start="0.2"/>'
SPEECH = '<speech id="s"><text>Well, <sync id="m"/>hello.</text></speech>'

REFUSED = {
    "empty file": "",
    "not XML": "hello there",
    "entity": '<!DOCTYPE bml [<!ENTITY e "x">]>' + BML.format(NOD),
    "entity in an attribute": '<!DOCTYPE bml [<!ENTITY e "NOD">]>' + BML.format('<head id="h" lexeme="&e;"/>'),
    "time of 1e9 s": BML.format('<head id="h" lexeme="NOD" start="1e9"/>'),
    "NaN": BML.format('<head id="h" lexeme="NOD" start="nan"/>'),
    "amount NaN": BML.format('<head id="h" lexeme="NOD" amount="nan"/>'),
    "unknown behaviour in a reference": BML.format('<head id="h" lexeme="NOD" start="nobody:end"/>'),
    "failure inside required": BML.format('<required><locomotion id="l" target="door"/></required>'),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_with_one_located_line(name, kinesic, tmp_path):
    path = tmp_path / "bad.bml"
    path.write_text(REFUSED[name])
    ended = kinesic("perform", path, "--out", "there", "--no-film")
    assert ended.code == 2
    assert ended.err.startswith(f"kinesic: {path}:")
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "there").exists()


def test_a_document_of_100_mb_is_refused_at_once(kinesic, tmp_path):
    path = tmp_path / "big.bml"
    with path.open("wb") as file:
        file.write(BML.format(NOD).encode())
        file.truncate(100_000_000)
    ended = kinesic("perform", path, "--out", "there", "--no-film")
    assert ended.code == 2
    assert "4 MB" in ended.err or "4000000" in ended.err.replace(" ", "").replace("_", "")


DROPPED = {  # the id of what is dropped, and the document about it
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
def odd(kinesic_in, tmp_path_factory):
    """A nod among everything that is dropped."""
    folder = tmp_path_factory.mktemp("odd")
    (folder / "odd.bml").write_text(BML.format(NOD + "".join(text for _, text in DROPPED.values())))
    return kinesic_in(folder, "perform", "odd.bml", "--out", "there", "--no-film", "--json")


@pytest.mark.parametrize("name", DROPPED)
def test_dropped_by_name_and_the_rest_performs(name, odd):
    assert odd.code == 0, odd.err
    data, (wrong, _) = json.loads(odd.out), DROPPED[name]
    outcomes = {entry["id"]: entry for entry in data["behaviours"]}
    assert outcomes["h"]["outcome"] == "realised"
    assert outcomes[wrong]["outcome"] == "dropped"
    assert outcomes[wrong]["why"]
    assert any(warning["id"] == f"b:{wrong}" for warning in data["warnings"])


@pytest.mark.parametrize("seconds", [125, pytest.param(915, marks=pytest.mark.soak)])
def test_a_long_block_is_performed(kinesic, tmp_path, seconds):
    path = tmp_path / "long.bml"
    path.write_text(BML.format(NOD + f'<head id="late" lexeme="NOD" start="{seconds - 1}" end="{seconds}"/>'))
    ended = kinesic("perform", path, "--out", "there", "--no-film", "--json")
    assert ended.code == 0, ended.err
    assert json.loads(ended.out)["timing"]["duration_s"] >= seconds


def test_missing_robot_file(kinesic, tmp_path):
    document = tmp_path / "nod.bml"
    document.write_text(BML.format(NOD))
    ended = kinesic("perform", document, "--robot", "nowhere.toml")
    assert ended.code == 2
    assert ended.err == "kinesic: nowhere.toml: no such file\n"


ROBOTS = {
    "misspelt key": (("range_deg = [-50, 50]", "rnage_deg = [-50, 50]"), "did you mean range_deg?"),
    "servo id twice": (("l_wrist_pivot = 18", "l_wrist_pivot = 17"), "17"),
    "unknown servo": (('servo = "xm540_w150"', 'servo = "xm540_w15"'), "did you mean xm540_w150?"),
    "range upside down": (("range_deg = [-50, 50]", "range_deg = [50, -50]"), "must be [low, high]"),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_a_wrong_robot_is_one_line(name, kinesic, tmp_path):
    (old, new), taught = ROBOTS[name]
    robot = tmp_path / "mine.toml"
    robot.write_text(UPPER22.replace(old, new, 1))
    document = tmp_path / "nod.bml"
    document.write_text(BML.format(NOD))
    ended = kinesic("perform", document, "--robot", robot, "--out", "there", "--no-film")
    assert ended.code == 2
    assert "mine.toml" in ended.err
    assert taught in ended.err
    assert ended.err.count("\n") == 1


@pytest.mark.parametrize(
    ("setting", "taught"),
    [
        ("power=7", "power is 7, outside [-1, 1]"),
        ("head.openness=-1", "head.openness is -1, outside [0, 1]"),
        ("hed.power=0", "a style has no modality 'hed'; did you mean head?"),
    ],
)
def test_a_wrong_setting_names_its_range_or_what_there_is(kinesic, tmp_path, setting, taught):
    document = tmp_path / "nod.bml"
    document.write_text(BML.format(NOD))
    ended = kinesic("perform", document, "--set", setting)
    assert ended.code == 2
    assert ended.err == f"kinesic: {taught}\n"


@pytest.mark.parametrize(
    ("attribute", "taught"),
    [
        ("kinesic:power='7'", "kinesic:power='7' is out of range; -1 to 1 is allowed"),
        ("kinesic:stile='sad'", "kinesic:stile is no parameter; did you mean style?"),
        ("kinesic:style='sat'", "kinesic:style='sat' is no style; did you mean sad?"),
    ],
)
def test_a_wrong_manner_in_a_document_names_its_place(kinesic, tmp_path, attribute, taught):
    document = tmp_path / "nod.bml"
    document.write_text(BML.format(NOD.replace("/>", f" {attribute}/>")))
    ended = kinesic("perform", document)
    assert ended.code == 2
    assert ended.err.startswith(f"kinesic: {document}:")
    assert ended.err.endswith(f"{taught}\n")
