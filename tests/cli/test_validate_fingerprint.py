from dataclasses import replace

from kinesic.body.robot import Robot
from kinesic.cli.options import Planning
from kinesic.cli.validate import fingerprint_inputs

PLANNING = Planning("upper22", "neutral", {})


def test_validations_with_equal_planning_options_have_equal_fingerprints():
    assert fingerprint_inputs(PLANNING, "nominal") == fingerprint_inputs(replace(PLANNING), "nominal")


def test_each_planning_option_changes_the_fingerprint_of_a_validation(tmp_path):
    targets = tmp_path / "targets.toml"
    targets.write_text("box = [1.0, 0.0, 1.0]")
    others = [
        fingerprint_inputs(PLANNING, "pessimistic"),
        fingerprint_inputs(replace(PLANNING, style="lively"), "nominal"),
        fingerprint_inputs(replace(PLANNING, options={"settings": ("power=0.5",)}), "nominal"),
        fingerprint_inputs(replace(PLANNING, options={"targets": targets}), "nominal"),
        fingerprint_inputs(replace(PLANNING, options={"dialect": "greta"}), "nominal"),
    ]
    assert len({fingerprint_inputs(PLANNING, "nominal"), *others}) == 6


def test_content_of_a_lexicon_file_changes_the_fingerprint_of_a_validation(tmp_path):
    lexicon = tmp_path / "lexicon"
    lexicon.mkdir()
    fingerprints = []
    for text in ("a = 1", "a = 2"):
        (lexicon / "own.toml").write_text(text)
        fingerprints.append(fingerprint_inputs(replace(PLANNING, options={"lexicon": lexicon}), "nominal"))
    assert fingerprints[0] != fingerprints[1]


def test_calibration_file_changes_the_fingerprint_of_a_validation(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(Robot.load().path.read_text(encoding="utf-8"), encoding="utf-8")
    mine = replace(PLANNING, robot=str(path))
    before = fingerprint_inputs(mine)
    path.with_name("mine.calibration.toml").write_text('robot = "upper22"\n', encoding="utf-8")
    assert fingerprint_inputs(mine) != before
