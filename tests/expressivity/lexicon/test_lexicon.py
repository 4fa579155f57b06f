import os
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.config import ConfigError
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.lexicon.lexicon import Lexicon, in_mode, mirror_form
from kinesic.expressivity.lexicon.space import to_world

ROBOT = Robot.load()
LEXICON = Lexicon.load()
CATEGORIES = sorted({form.category for form in LEXICON.forms})
FORMS = pytest.mark.parametrize(  # by category: a test for each gesture would cost more than what it looks at
    "forms", [tuple(form for form in LEXICON.forms if form.category == name) for name in CATEGORIES], ids=CATEGORIES
)
MODES = ("left", "right", "both", "unspecified")


def world(side, pose):
    """(3,) [arm lengths] of a wrist in the world."""
    return to_world(ROBOT, side, pose.position) / ROBOT.arm_length


def way(a, b) -> float:
    """From one pose to the next, along its path [arm lengths]."""
    return float(np.linalg.norm(b.position - a.position)) if b.path is None else b.path.length(a.position, b.position)


def turn(a, b) -> float:
    """From one pose to the next, of palm or fingers [rad]."""
    return max(float(np.arccos(np.clip(x @ y, -1.0, 1.0))) for x, y in ((a.palm, b.palm), (a.pointing, b.pointing)))


def test_there_are_gestures_of_every_category():
    assert len(LEXICON.forms) >= 150
    assert {form.category for form in LEXICON.forms} == {
        "beat",
        "deictic",
        "iconic",
        "metaphoric",
        "emblem",
        "adaptor",
        "emotion",
        "rest",
    }
    assert len({form.id for form in LEXICON.forms}) == len(LEXICON.forms)


@FORMS
@pytest.mark.parametrize("mode", MODES)
def test_every_hand_is_within_reach_and_clear_of_the_other(forms, mode):
    for form in forms:
        frames = ROBOT.skeleton.frames(ROBOT.skeleton.rest)
        for key in in_mode(form, mode).keys:
            wrists = {side: world(side, pose) for side, pose in key.hands.items()}
            for side, wrist in wrists.items():
                shoulder = frames.origins[ROBOT.skeleton.segment(f"{side}_shoulder")] / ROBOT.arm_length
                assert 0.28 <= np.linalg.norm(wrist - shoulder) <= 1.15, form.id  # a folded arm has 0.39, trunk upright
            if len(wrists) == 2:
                assert np.linalg.norm(wrists["l"] - wrists["r"]) >= 0.2, form.id


def gap(point) -> float:
    """From a point to trunk and head at rest [m]."""
    frames, arms = ROBOT.skeleton.resting, {name for side in SIDES for name in ROBOT.arm(side).segments}
    gaps = []
    for k, segment in enumerate(ROBOT.skeleton.segments):
        for capsule in () if segment.name in arms else segment.capsules:
            start, end = (frames.origins[k] + frames.rotations[k] @ at for at in (capsule.start, capsule.end))
            share = np.clip((point - start) @ (end - start) / max((end - start) @ (end - start), 1e-12), 0.0, 1.0)
            gaps.append(np.linalg.norm(point - start - share * (end - start)) - capsule.radius)
    return min(gaps)


@FORMS
def test_no_hand_is_inside_trunk_or_head(forms):
    thick = ROBOT.skeleton.segments[ROBOT.arm("r").wrist].capsules[0].radius
    for form in forms:
        for key in form.keys:
            for side, pose in key.hands.items():
                assert gap(to_world(ROBOT, side, pose.position)) >= thick, form.id


@FORMS
def test_a_stroke_can_be_seen(forms):
    for form in forms:
        if form.rest:
            continue
        assert len(form.keys) >= 2, form.id
        rows = [[key.hands[side] for key in form.keys if side in key.hands] for side in form.sides]
        ways = [[way(a, b) for a, b in pairwise(row)] for row in rows]
        turns = [turn(a, b) for row in rows for a, b in pairwise(row)]
        assert max(map(sum, ways)) >= 0.12 or not any(ways) or max(turns) >= np.radians(30), form.id


@FORMS
def test_directions_are_units_and_not_parallel(forms):
    for form in forms:
        for pose in (pose for key in form.keys for pose in key.hands.values()):
            assert pose.palm is not None, form.id
            assert pose.pointing is not None, form.id
            assert np.linalg.norm(pose.palm) == pytest.approx(1.0), form.id
            assert np.linalg.norm(pose.pointing) == pytest.approx(1.0), form.id
            assert abs(pose.palm @ pose.pointing) < 0.9, form.id


@FORMS
def test_the_mirror_image_is_exact_and_its_own_inverse(forms):
    for form in forms:
        image = mirror_form(form)
        for key, other in zip(form.keys, image.keys, strict=True):
            for side, pose in key.hands.items():
                opposite = "r" if side == "l" else "l"
                assert np.array_equal(world(side, pose) * [1, -1, 1], world(opposite, other.hands[opposite])), form.id
        assert [key.hands for key in mirror_form(image).keys] == [key.hands for key in form.keys], form.id


@FORMS
def test_left_and_right_mirror_each_other(forms):
    for form in forms:
        if len(form.sides) == 2:
            continue
        left, right = in_mode(form, "left"), in_mode(form, "right")
        assert (left.sides, right.sides) == ({"l"}, {"r"}), form.id
        for one, other in zip(left.keys, right.keys, strict=True):
            assert np.array_equal(world("l", one.hands["l"]) * [1, -1, 1], world("r", other.hands["r"])), form.id


@FORMS
def test_a_mode_yields_its_sides(forms):
    for form in forms:
        assert in_mode(form, "left").sides == {"l"}, form.id
        assert in_mode(form, "right").sides == {"r"}, form.id
        assert in_mode(form, "both").sides == set(SIDES), form.id
        assert in_mode(form, "unspecified") is form, form.id
        assert in_mode(form, "left") is in_mode(form, "left"), "remembered, with all that is known of it"


def test_one_side_of_a_two_handed_form_is_what_this_hand_does():
    form = LEXICON.find("balance").form
    assert [key.hands["l"] for key in in_mode(form, "left").keys] == [key.hands["l"] for key in form.keys]


def test_both_hands_of_an_inward_form_stay_apart():
    key = LEXICON.find("me", "both").form.keys[-1]
    assert key.hands["l"].position == pytest.approx(key.hands["r"].position)
    assert key.hands["l"].position[1] > LEXICON.find("me").form.keys[-1].hands["r"].position[1]


@FORMS
def test_names_are_found_in_any_case_and_with_their_category(forms):
    for form in forms:
        for lexeme in (form.id, form.id.upper(), f"{form.category}={form.id.title()}"):
            match = LEXICON.find(lexeme)
            assert match.form is form, form.id
            assert match.substitute == "", form.id


@pytest.mark.parametrize(
    ("lexeme", "gesture", "sides"),
    [
        ("Greet_Wave_LH", "greet_wave", "l"),
        ("balance-2H", "balance", "lr"),
        ("StopRt01", "stop", "r"),
        ("BEAT3", "beat", "r"),
        ("animations/Stand/Gestures/CalmDown_5", "calm_down", "lr"),
    ],
)
def test_its_own_name_is_exact_in_any_spelling_and_names_the_hand(lexeme, gesture, sides):
    match = LEXICON.find(lexeme)
    assert (match.form.id, match.kind, match.substitute) == (gesture, "exact", "")
    assert "".join(sorted(match.form.sides)) == sides


@pytest.mark.parametrize(
    ("lexeme", "gesture", "sides"),
    [
        ("Tiny_Ges_R", "small_pinch", "r"),
        ("yesterday_Pos_L2", "past_over_shoulder", "l"),
        ("TheBoxes", "object_hold", "lr"),
        ("UnderTheTable", "hands_low", "lr"),
        ("handsTogetherLeaning", "hands_together_forward", "lr"),
        ("fold_arms", "arms_crossed", "lr"),
        ("Greeting-left", "greet_wave", "l"),
        ("objectManip", "object_handle", "lr"),
        ("OBLIGATION_METAPHORIC", "beat_fist_palm", "lr"),
        ("I don't know!", "doubt_shrug", "lr"),
        ("beat_strongly_ges_b", "beat_strong", "lr"),
    ],
)
def test_a_synonym_means_the_same(lexeme, gesture, sides):
    match = LEXICON.find(lexeme)
    assert (match.form.id, match.kind, match.substitute) == (gesture, "synonym", "")
    assert "".join(sorted(match.form.sides)) == sides


@pytest.mark.parametrize(
    ("lexeme", "sides", "why"),
    [
        ("POINT", "r", "substituted by this_index: it stands for its class, point"),
        ("beat_flip_mid_LH", "l", 'substituted by beat: it stands for its class, beat; "flip mid" is left out'),
        ("palm_up_open_hand", "r", "substituted by offer: it stands for its class, open hand"),
        ("Greet_Ges_R_Low", "r", 'substituted by greet_wave: "low" is left out'),
        ("YouLeftRt01", "r", 'substituted by you: "left" is left out'),
        ("", "r", "substituted by beat: no lexeme"),
    ],
)
def test_a_substitute_says_what_it_does_not_mean(lexeme, sides, why):
    match = LEXICON.find(lexeme)
    assert match.substitute == why
    assert "".join(sorted(match.form.sides)) == sides


def test_the_mode_outweighs_the_letter_in_the_name():
    assert LEXICON.find("tiny_Ges_R", "left").form.sides == {"l"}
    assert LEXICON.find("tiny_Ges_R", "both").form.sides == {"l", "r"}


def test_a_category_may_name_the_class():
    assert LEXICON.find("", category="deictic").form.category == "deictic"
    assert LEXICON.find("beat=qwzx").form.id == "beat"
    assert LEXICON.find("rest=qwzx") is None


@pytest.mark.parametrize(
    "lexeme",
    ["qwzx", "Xy_Ges_B", "42", "nothingness=qwzx", "winging", "UNKNOWN", "manip", "dont_point", "start", "left_right"],
)
def test_a_word_without_meaning_finds_nothing(lexeme):
    assert LEXICON.find(lexeme) is None


def test_a_name_longer_than_names_are_is_none():
    assert LEXICON.find("stop " * 30) is None
    assert LEXICON.find(f"stop{' ' * 100}now").form.id == "stop"
    assert LEXICON.find(f"stop{' ' * 200}now") is None
    assert LEXICON.near("left " * 100_000) == LEXICON.near("left " * 24)


def test_gestures_near_an_unknown_lexeme_are_named_by_words_and_by_letters():
    assert "doubt_shrug" in LEXICON.near("unknown_thing")
    assert LEXICON.near("greet_wav")[0] == "greet_wave"
    assert len(LEXICON.near("hand hands arms count")) == 3
    assert LEXICON.near("qwzx") == ()


@given(st.text(max_size=40), st.sampled_from(MODES))
def test_any_text_is_either_understood_or_not(lexeme, mode):
    match = LEXICON.find(lexeme, mode)
    assert match is None or match.form.keys


GESTURE = """
category = "beat"
[[gesture]]
id = "own"
keys = [{ right = { at = ["XC", 0.1, "ZNear"], palm = "in up" } }, { both = { at = [0.3, 0.2, 0.5] } }]
"""


def test_gestures_of_the_user_come_first(tmp_path: Path):
    (tmp_path / "a.toml").write_text(GESTURE.replace('"own"', '"beat"'))
    for path in (tmp_path, tmp_path / "a.toml"):
        lexicon = Lexicon.load(path)
        assert lexicon.find("beat").form.keys[0].hands["r"].position == pytest.approx([0.4, 0.25, 0.1])
        assert lexicon.find("stop").form.id == "stop"
        assert lexicon.find("beat").form.keys[0].hands["r"].palm == pytest.approx([0, -np.sqrt(0.5), np.sqrt(0.5)])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("palm", "plam", r"plam.*did you mean palm\?"),
        ('"beat"', '"beet"', "beet"),
        ("in up", "inn", r"gesture own: inn is no direction; did you mean in\?"),
        ("in up", "in out", r"gesture own: 'in out' points nowhere"),
        ('"XC"', "1e308", r"gesture own: a hand is 1e\+308 arm lengths outward, outside \[-5, 5\]"),
        ("XC", "XD", r"gesture own: XD is no sector of x; known: XEP"),
        ("{ both = { at = [0.3, 0.2, 0.5] } }", "{}", r"gesture own: a key without hands"),
        ("{ both =", "{ left = { at = [0.3, 0, 0.5] }, both =", r"gesture own: a key has both and a single hand"),
        ('palm = "in up"', "openness = 3", r"gesture own: openness is 3, outside \[0, 1\]"),
        ("0.1,", "inf,", r"must be a finite number"),
    ],
)
def test_a_wrong_file_teaches(tmp_path: Path, old, new, message):
    assert old in GESTURE
    (tmp_path / "own.toml").write_text(GESTURE.replace(old, new))
    with pytest.raises(ConfigError, match=message) as error:
        Lexicon.load(tmp_path / "own.toml")
    assert "own.toml" in str(error.value)


@pytest.mark.parametrize("odd", ["pipe", "link"])
def test_a_folder_of_gestures_leads_nowhere_else(odd: str, tmp_path: Path):
    folder = tmp_path / "gestures"
    folder.mkdir()
    (folder / "a.toml").touch()
    (tmp_path / "b.toml").touch()
    if odd == "pipe":
        os.mkfifo(folder / "b.toml")
    else:
        (folder / "b.toml").symlink_to("../b.toml")
    with pytest.raises(ConfigError, match=r"b\.toml' is (outside|no ordinary file)"):
        Lexicon.load(folder)


def test_missing_files_and_empty_folders_are_named(tmp_path: Path):
    with pytest.raises(ConfigError, match=r"without \.toml files"):
        Lexicon.load(tmp_path)
    with pytest.raises(ConfigError, match="no such file"):
        Lexicon.load(tmp_path / "none.toml")
