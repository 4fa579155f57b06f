from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.lexicon.lexicon import Lexicon, in_mode, mirror_form
from kinesic.expressivity.lexicon.space import to_world

DEFAULT_ROBOT = Robot.load()
BUILTIN_LEXICON = Lexicon.load()
CATEGORY_NAMES = sorted({form.category for form in BUILTIN_LEXICON.forms})
FORMS_BY_CATEGORY = pytest.mark.parametrize(  # By category, to limit the duration of the tests
    "forms",
    [tuple(form for form in BUILTIN_LEXICON.forms if form.category == name) for name in CATEGORY_NAMES],
    ids=CATEGORY_NAMES,
)
HAND_MODES = ("left", "right", "both", "unspecified")


def world_position(side, pose):
    """Return the wrist position in the world, (3,) [arm lengths]."""
    return to_world(DEFAULT_ROBOT, side, pose.position) / DEFAULT_ROBOT.arm_length


def path_length(a, b) -> float:
    """Return the distance between two poses along the path [arm lengths]."""
    return float(np.linalg.norm(b.position - a.position)) if b.path is None else b.path.length(a.position, b.position)


def rotation_angle(a, b) -> float:
    """Return the rotation of palm or fingers between two poses [rad]."""
    return max(float(np.arccos(np.clip(x @ y, -1.0, 1.0))) for x, y in ((a.palm, b.palm), (a.pointing, b.pointing)))


def place(form) -> str:
    """Return the file of a gesture and its id."""
    return f"kinesic/configs/gestures/{form.category}.toml: {form.id}"


def test_lexicon_has_gestures_of_every_category():
    assert len(BUILTIN_LEXICON.forms) >= 150
    assert {form.category for form in BUILTIN_LEXICON.forms} == {
        "beat",
        "deictic",
        "iconic",
        "metaphoric",
        "emblem",
        "adaptor",
        "emotion",
        "rest",
    }
    assert len({form.id for form in BUILTIN_LEXICON.forms}) == len(BUILTIN_LEXICON.forms)


@FORMS_BY_CATEGORY
@pytest.mark.parametrize("mode", HAND_MODES)
def test_lexicon_hand_positions_are_reachable_and_apart_unless_they_touch(forms, mode):
    for form in forms:
        frames = DEFAULT_ROBOT.skeleton.frames(DEFAULT_ROBOT.skeleton.rest)
        for key in in_mode(form, mode).keys:
            wrists = {side: world_position(side, pose) for side, pose in key.hands.items()}
            for side, wrist in wrists.items():
                shoulder = frames.origins[DEFAULT_ROBOT.skeleton.segment(f"{side}_shoulder")] / DEFAULT_ROBOT.arm_length
                # A folded arm has 0.39 with an upright trunk
                assert 0.28 <= np.linalg.norm(wrist - shoulder) <= 1.15, place(form)
            if len(wrists) == 2:
                touching = any(pose.touch == "hand" for pose in key.hands.values())
                assert np.linalg.norm(wrists["l"] - wrists["r"]) >= (0.1 if touching else 0.2), place(form)


def body_distance(point) -> float:
    """Return the distance from a point to the resting trunk and head [m]."""
    frames, arms = (
        DEFAULT_ROBOT.skeleton.rest_frames,
        {name for side in SIDES for name in DEFAULT_ROBOT.arm(side).segments},
    )
    gaps = []
    for k, segment in enumerate(DEFAULT_ROBOT.skeleton.segments):
        for capsule in () if segment.name in arms else segment.capsules:
            start, end = (frames.origins[k] + frames.rotations[k] @ at for at in (capsule.start, capsule.end))
            share = np.clip((point - start) @ (end - start) / max((end - start) @ (end - start), 1e-12), 0.0, 1.0)
            gaps.append(np.linalg.norm(point - start - share * (end - start)) - capsule.radius)
    return min(gaps)


@FORMS_BY_CATEGORY
def test_lexicon_hand_positions_are_outside_trunk_and_head(forms):
    thick = DEFAULT_ROBOT.skeleton.segments[DEFAULT_ROBOT.arm("r").wrist].capsules[0].radius
    for form in forms:
        for key in form.keys:
            for side, pose in key.hands.items():
                assert body_distance(to_world(DEFAULT_ROBOT, side, pose.position)) >= thick, place(form)


@FORMS_BY_CATEGORY
def test_every_gesture_stroke_of_the_lexicon_moves_or_rotates_the_hand_visibly(forms):
    for form in forms:
        if form.rest:
            continue
        assert len(form.keys) >= 2, place(form)
        rows = [[key.hands[side] for key in form.keys if side in key.hands] for side in form.sides]
        ways = [[path_length(a, b) for a, b in pairwise(row)] for row in rows]
        turns = [rotation_angle(a, b) for row in rows for a, b in pairwise(row)]
        assert max(map(sum, ways)) >= 0.12 or not any(ways) or max(turns) >= np.radians(30), place(form)


@FORMS_BY_CATEGORY
def test_palm_and_pointing_directions_of_lexicon_gestures_are_unit_vectors_and_not_parallel(forms):
    for form in forms:
        for pose in (pose for key in form.keys for pose in key.hands.values()):
            assert pose.palm is not None, place(form)
            assert pose.pointing is not None, place(form)
            assert np.linalg.norm(pose.palm) == pytest.approx(1.0), place(form)
            assert np.linalg.norm(pose.pointing) == pytest.approx(1.0), place(form)
            assert abs(pose.palm @ pose.pointing) < 0.9, place(form)


@FORMS_BY_CATEGORY
def test_mirroring_a_gesture_twice_gives_the_same_gesture(forms):
    for form in forms:
        image = mirror_form(form)
        for key, other in zip(form.keys, image.keys, strict=True):
            for side, pose in key.hands.items():
                opposite = "r" if side == "l" else "l"
                assert np.array_equal(
                    world_position(side, pose) * [1, -1, 1], world_position(opposite, other.hands[opposite])
                ), place(form)
        assert [key.hands for key in mirror_form(image).keys] == [key.hands for key in form.keys], place(form)


@FORMS_BY_CATEGORY
def test_left_and_right_handed_forms_of_a_gesture_are_mirror_images(forms):
    for form in forms:
        if len(form.sides) == 2:
            continue
        left, right = in_mode(form, "left"), in_mode(form, "right")
        assert (left.sides, right.sides) == ({"l"}, {"r"}), place(form)
        for one, other in zip(left.keys, right.keys, strict=True):
            assert np.array_equal(
                world_position("l", one.hands["l"]) * [1, -1, 1], world_position("r", other.hands["r"])
            ), place(form)


@FORMS_BY_CATEGORY
def test_hand_mode_selects_the_hands_of_a_gesture(forms):
    for form in forms:
        assert in_mode(form, "left").sides == {"l"}, place(form)
        assert in_mode(form, "right").sides == {"r"}, place(form)
        assert in_mode(form, "both").sides == set(SIDES), place(form)
        assert in_mode(form, "unspecified") is form, place(form)
        assert in_mode(form, "left") is in_mode(form, "left"), "remembered, with all that is known of it"


def test_one_handed_mode_keeps_the_motion_of_the_hand():
    form = BUILTIN_LEXICON.find("balance").form
    assert [key.hands["l"] for key in in_mode(form, "left").keys] == [key.hands["l"] for key in form.keys]


def test_hands_of_a_one_handed_chest_gesture_are_spread_in_two_handed_mode():
    key = BUILTIN_LEXICON.find("me", "both").form.keys[-1]
    assert key.hands["l"].position == pytest.approx(key.hands["r"].position)
    assert key.hands["l"].position[1] > BUILTIN_LEXICON.find("me").form.keys[-1].hands["r"].position[1]


@FORMS_BY_CATEGORY
def test_gesture_names_are_found_in_any_case_and_with_category(forms):
    for form in forms:
        for lexeme in (form.id, form.id.upper(), f"{form.category}={form.id.title()}"):
            match = BUILTIN_LEXICON.find(lexeme)
            assert match.form is form, place(form)
            assert match.substitute == "", place(form)


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
def test_spelling_variants_of_a_gesture_name_with_a_hand_suffix_match_exactly(lexeme, gesture, sides):
    match = BUILTIN_LEXICON.find(lexeme)
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
def test_lexeme_synonym_matches_a_gesture_without_a_substitution_notice(lexeme, gesture, sides):
    match = BUILTIN_LEXICON.find(lexeme)
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
def test_substituted_gesture_reports_its_class_and_omitted_lexeme_words(lexeme, sides, why):
    match = BUILTIN_LEXICON.find(lexeme)
    assert match.substitute == why
    assert "".join(sorted(match.form.sides)) == sides


def test_hand_mode_overrides_the_hand_letter_of_a_gesture_name():
    assert BUILTIN_LEXICON.find("tiny_Ges_R", "left").form.sides == {"l"}
    assert BUILTIN_LEXICON.find("tiny_Ges_R", "both").form.sides == {"l", "r"}


def test_gesture_category_selects_a_gesture_without_lexeme():
    assert BUILTIN_LEXICON.find("", category="deictic").form.category == "deictic"
    assert BUILTIN_LEXICON.find("beat=qwzx").form.id == "beat"
    assert BUILTIN_LEXICON.find("rest=qwzx") is None


@pytest.mark.parametrize(
    "lexeme",
    ["qwzx", "Xy_Ges_B", "42", "nothingness=qwzx", "winging", "UNKNOWN", "manip", "dont_point", "start", "left_right"],
)
def test_meaningless_negated_or_ambiguous_lexeme_matches_no_gesture(lexeme):
    assert BUILTIN_LEXICON.find(lexeme) is None


def test_overlong_lexeme_matches_no_gesture():
    assert BUILTIN_LEXICON.find("stop " * 30) is None
    assert BUILTIN_LEXICON.find(f"stop{' ' * 100}now").form.id == "stop"
    assert BUILTIN_LEXICON.find(f"stop{' ' * 200}now") is None
    assert BUILTIN_LEXICON.near("left " * 100_000) == BUILTIN_LEXICON.near("left " * 24)


def test_similar_gestures_are_suggested_by_words_and_letters():
    assert "doubt_shrug" in BUILTIN_LEXICON.near("unknown_thing")
    assert BUILTIN_LEXICON.near("greet_wav")[0] == "greet_wave"
    assert len(BUILTIN_LEXICON.near("hand hands arms count")) == 3
    assert BUILTIN_LEXICON.near("qwzx") == ()


@given(st.text(max_size=40), st.sampled_from(HAND_MODES))
def test_any_lexeme_is_matched_or_rejected_without_error(lexeme, mode):
    match = BUILTIN_LEXICON.find(lexeme, mode)
    assert match is None or match.form.keys
