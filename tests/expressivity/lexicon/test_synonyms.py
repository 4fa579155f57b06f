"""Tests of synonyms: unique names, meanings and unlisted names."""

from itertools import cycle

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.names import read_name
from kinesic.expressivity.lexicon.synonyms import NameTable, check_names, class_of

BUILTIN_LEXICON = Lexicon.load()
GESTURE_IDS = set(BUILTIN_LEXICON.forms_by_id)
SYNONYM_TARGETS = dict(BUILTIN_LEXICON.synonyms)


def test_every_lexeme_synonym_refers_to_exactly_one_existing_gesture():
    assert list(check_names(BUILTIN_LEXICON.synonyms, BUILTIN_LEXICON.classes, GESTURE_IDS)) == []
    assert len(SYNONYM_TARGETS) == len(BUILTIN_LEXICON.synonyms) >= 600
    assert (
        len(set(SYNONYM_TARGETS.values())) >= 292
    )  # `beat_both` and `thinker` have none; those of new gestures are optional


def test_every_synonym_is_found_in_several_spellings():
    for name, gesture in SYNONYM_TARGETS.items():
        for spelled in (name, name.title().replace(" ", ""), f"{name.upper().replace(' ', '_')}_RH"):
            match = BUILTIN_LEXICON.find(spelled)
            assert match is not None, spelled
            assert match.form.id == gesture, f"kinesic/configs/gestures/: {match.form.id} hides {name!r} of {gesture}"
            assert match.substitute == "", spelled


def test_gesture_names_without_spaces_are_unique_except_for_listed_pairs():
    spelled: dict[str, set[str]] = {}
    for name, gesture in [*SYNONYM_TARGETS.items(), *((gesture, gesture) for gesture in GESTURE_IDS)]:
        spelled.setdefault("".join(read_name(name).words), set()).add(gesture)
    assert {key: matches for key, matches in spelled.items() if len(matches) > 1} == {
        "upstairs": {"up", "stairs_up"},
        "nowhere": {"refuse_sweep", "now_here"},
    }, "rename a gesture in kinesic/configs/gestures/, or a name in kinesic/configs/gestures/synonyms.toml"
    assert BUILTIN_LEXICON.find("dontknow_Pos_B").form.id == "doubt_shrug"
    assert BUILTIN_LEXICON.find("nowhere").form.id == "refuse_sweep"
    assert BUILTIN_LEXICON.find("now_here").form.id == "now_here"
    assert BUILTIN_LEXICON.find("no_where") is None


DIRECTION_GESTURES = {
    "left": {"left"},
    "right": {"right"},
    "up": {"up"},
    "down": {"down"},
    "self": {"me"},
    "me": {"me"},
    "myself": {"me"},
    "you": {"you"},
    "forward": {"straight_ahead"},
    "behind": {"past_over_shoulder"},
    "here": {"here_down"},
    "there": {"that_far"},
}
POINTING_VERBS = ("point", "pointing", "Point_at", "deictic", "indicate", "point_to_the", "finger_point", "point_hand")


@pytest.mark.parametrize("verb", POINTING_VERBS)
def test_pointing_lexeme_with_a_direction_selects_the_gesture_in_this_direction(verb):
    for where, gestures in DIRECTION_GESTURES.items():
        for lexeme in (f"{verb}_{where}", f"{verb}-{where}".upper(), f"{verb} {where} 2", f"greta_{verb}_{where}_RH"):
            match = BUILTIN_LEXICON.find(lexeme)
            assert match is not None, lexeme
            assert match.form.id in gestures, lexeme
            assert match.form.category == "deictic", lexeme


@pytest.mark.parametrize(
    "lexeme", ["point_up_left", "point_down_right", "point_from_me_to_you", "dont_point", "no_beat"]
)
def test_ambiguous_or_negated_pointing_lexeme_matches_no_gesture(lexeme):
    assert BUILTIN_LEXICON.find(lexeme) is None


@pytest.mark.parametrize("lexeme", ["point_blue_box_RH", "point_camera", "deictic_space_LH", "POINT1"])
def test_pointing_lexeme_with_an_unknown_object_selects_the_index_finger_gesture(lexeme):
    match = BUILTIN_LEXICON.find(lexeme)
    assert (match.form.id, match.kind) == ("this_index", "class")
    assert "it stands for its class, point" in match.substitute


def test_idiom_with_a_gesture_class_word_matches_no_gesture():
    points = ("match_point", "PointOfView_RH", "points_of_interest", "whats the point", "get to the point")
    others = ("beat_it", "beat_eggs", "off_beat", "beat around the bush", "hold_cup", "open_hand_slap")
    for lexeme in (*points, "at_this_point", "turning_point", *others):
        assert BUILTIN_LEXICON.find(lexeme) is None, lexeme


def test_rest_pose_is_found_by_name_with_its_category():
    for name in ("along", "Along", "alongBig"):
        assert BUILTIN_LEXICON.find(name, category="rest").form.id == "arms_hanging"
        assert BUILTIN_LEXICON.find(f"rest={name}").form.id == "arms_hanging"


@pytest.mark.parametrize(
    ("lexeme", "gesture"),
    [
        ("BEAT_LOW_1", "beat_low"),
        ("beat_chop_mid_LH", "beat_edge"),
        ("BeatFistMidLf02", "beat_strong"),
        ("BeatForwardBt01", "beat"),
        ("rhythmic_beats_2H", "beat"),
        ("beat_double_RH", "beat_double"),
        ("drum_beat", "drum"),
    ],
)
def test_beat_lexeme_selects_the_beat_gesture_that_fits_its_words(lexeme, gesture):
    assert BUILTIN_LEXICON.find(lexeme).form.id == gesture


RIGHT_BUT_NO_SIDE = {"right here", "right now", "right away", "thats right", "stop right there"}


def test_synonyms_with_left_or_right_refer_to_the_gesture_for_that_side():
    for name, gesture in SYNONYM_TARGETS.items():
        sides = {"left", "right"} & set(read_name(name).words)
        if name not in RIGHT_BUT_NO_SIDE:
            assert sides in ({gesture}, set()), name


OPPOSITE_WORDS = [
    ({"yes", "yeah", "agree", "accept"}, {"no", "nope", "disagree", "refuse", "reject"}),
    ({"up", "above", "upstairs"}, {"down", "below", "downstairs"}),
    ({"come", "come here", "approach"}, {"go away", "leave", "away"}),
    ({"stop", "halt", "wait"}, {"continue", "go on", "forward"}),
    ({"large", "big", "huge"}, {"small", "tiny", "little"}),
    ({"more", "increase", "rise"}, {"less", "decrease", "fall"}),
    ({"good", "like", "thumbs up"}, {"bad", "dislike", "thumbs down"}),
    ({"happy", "joy"}, {"sad", "unhappy"}),
    ({"hot"}, {"cold"}),
    ({"open door", "door"}, {"close door", "shut"}),
    ({"past", "yesterday"}, {"future", "tomorrow"}),
    ({"before"}, {"after"}),
    ({"louder", "volume up"}, {"quieter", "volume down", "hush"}),
    ({"put in", "insert"}, {"take out", "extract"}),
    ({"me", "i", "self"}, {"you", "your"}),
    ({"here"}, {"there", "far"}),
    ({"left"}, {"right"}),
    ({"everything", "all"}, {"nothing", "none", "nobody"}),
    ({"know", "think"}, {"dont know", "no idea"}),
    ({"remember"}, {"forget"}),
    ({"understand"}, {"dont understand"}),
    ({"give"}, {"keep"}),
    ({"connect", "link"}, {"break", "separate"}),
    ({"allowed", "ok"}, {"forbidden", "not allowed"}),
    ({"hello"}, {"shoo"}),
    ({"tired", "sleep"}, {"wake up"}),
]


def test_lexemes_with_opposite_words_have_different_gestures():
    for pair in OPPOSITE_WORDS:
        ones, others = ({match.form.id for word in words if (match := BUILTIN_LEXICON.find(word))} for words in pair)
        assert ones, pair
        assert others, pair
        assert not ones & others, pair


def test_negated_gesture_name_does_not_match_the_gesture_it_names():
    denials = {"refuse_sweep", "refuse_push", "no_wag", "crossed_out", "stop", "thumb_down", "doubt_shrug"}
    names = [*SYNONYM_TARGETS.items(), *((gesture, gesture) for gesture in sorted(GESTURE_IDS))]
    for (name, gesture), word in zip(names, cycle(("not", "dont", "no", "never"))):
        match = BUILTIN_LEXICON.find(f"{word} {name}")
        assert match is None or match.form.id != gesture or gesture in denials, f"{word} {name}"


REVIEWED_LEXEMES = {  # Lexemes reported by a user, and their gestures now
    "dont_know": "doubt_shrug",
    "palm_up_open_hand": "offer",
    "point_left": "left",
    "point_you": "you",
    "point_self": "me",
    "on_the_other_hand": "contrast_left_right",
    "UNKNOWN": None,
    "along": None,
    "yes": "allright",
    "cup_LH": "offer",
    "cup-flip_2H_2": "offer",
    "purse": None,
    "easy": None,
}


def test_lexemes_reported_by_users_select_the_listed_gestures():
    for lexeme, gesture in REVIEWED_LEXEMES.items():
        match = BUILTIN_LEXICON.find(lexeme)
        assert (None if match is None else match.form.id) == gesture, lexeme


def table(*names: tuple[str, str]) -> NameTable:
    categories = {"nod": "emblem", "wave": "emblem", "tap": "beat", "tap_twice": "beat"}
    categories |= {"there": "deictic", "yonder": "deictic"}
    classes = (class_of("tap", "tap", ["tap", "soft touch"]), class_of("aim", "there", ["aim"]))
    return NameTable(categories, names, classes)


def test_gesture_names_take_precedence_over_synonyms_and_synonyms_over_gesture_classes():
    for name, gesture, kind in [
        ("tap", "tap", "exact"),
        ("TapTwice", "tap_twice", "exact"),
        ("taptwice", "tap_twice", "exact"),
        ("bye", "wave", "synonym"),
        ("tap_hard", "tap", "class"),
        ("a soft touch here", "tap", "class"),
        ("soft", None, None),
        ("tap_up", "tap", "class"),
        ("twofold_tap", "tap_twice", "synonym"),
        ("hard_twofold_tap", "tap_twice", "synonym"),
        ("tap_bye", None, None),
        ("aim_yonder", "yonder", "synonym"),
        ("aim", "there", "class"),
        ("aim_there_yonder", None, None),
        ("aim_not_blue", None, None),
    ]:
        matches = table(("bye", "wave"), ("twofold", "tap_twice")).find(name)
        assert ((None, None) if matches is None else (matches.gesture, matches.kind)) == (gesture, kind), name


def test_first_of_two_equal_synonyms_is_used():
    assert table(("Bye", "wave"), ("bye", "nod")).find("bye").gesture == "wave"
