"""The table of synonyms: each name one gesture, none with another meaning, and names that nobody listed."""

from itertools import cycle

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.names import read_name
from kinesic.expressivity.lexicon.synonyms import NameTable, check_names, class_of

LEXICON = Lexicon.load()
GESTURES = set(LEXICON.forms_by_id)
TARGETS = dict(LEXICON.synonyms)


def test_every_name_means_one_gesture_that_there_is_and_is_none_itself():
    assert list(check_names(LEXICON.synonyms, LEXICON.classes, GESTURES)) == []
    assert len(TARGETS) == len(LEXICON.synonyms) >= 600
    assert set(TARGETS.values()) == GESTURES - {"beat_both", "thinker"}  # `beat` with both hands; no other name


def test_every_name_is_found_as_it_stands_in_small_letters_and_with_a_hand():
    for name, gesture in TARGETS.items():
        for spelled in (name, name.title().replace(" ", ""), f"{name.upper().replace(' ', '_')}_RH"):
            match = LEXICON.find(spelled)
            assert match is not None, spelled
            assert match.form.id == gesture, spelled
            assert match.substitute == "", spelled


def test_names_run_together_mean_the_same_gesture_unless_two_do():
    spelled: dict[str, set[str]] = {}
    for name, gesture in [*TARGETS.items(), *((gesture, gesture) for gesture in GESTURES)]:
        spelled.setdefault("".join(read_name(name).words), set()).add(gesture)
    assert {key: found for key, found in spelled.items() if len(found) > 1} == {
        "upstairs": {"up", "stairs_up"},
        "nowhere": {"refuse_sweep", "now_here"},
    }
    assert LEXICON.find("dontknow_Pos_B").form.id == "doubt_shrug"
    assert LEXICON.find("nowhere").form.id == "refuse_sweep"
    assert LEXICON.find("now_here").form.id == "now_here"
    assert LEXICON.find("no_where") is None


DIRECTIONS = {
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
VERBS = ("point", "pointing", "Point_at", "deictic", "indicate", "point_to_the", "finger_point", "point_hand")


@pytest.mark.parametrize("verb", VERBS)
def test_who_points_somewhere_points_there(verb):
    for where, gestures in DIRECTIONS.items():
        for lexeme in (f"{verb}_{where}", f"{verb}-{where}".upper(), f"{verb} {where} 2", f"greta_{verb}_{where}_RH"):
            match = LEXICON.find(lexeme)
            assert match is not None, lexeme
            assert match.form.id in gestures, lexeme
            assert match.form.category == "deictic", lexeme


@pytest.mark.parametrize(
    "lexeme", ["point_up_left", "point_down_right", "point_from_me_to_you", "dont_point", "no_beat"]
)
def test_who_points_two_ways_or_not_at_all_points_nowhere(lexeme):
    assert LEXICON.find(lexeme) is None


@pytest.mark.parametrize("lexeme", ["point_blue_box_RH", "point_camera", "deictic_space_LH", "POINT1"])
def test_who_points_at_what_is_unknown_points(lexeme):
    match = LEXICON.find(lexeme)
    assert (match.form.id, match.kind) == ("this_index", "class")
    assert "it stands for its class, point" in match.substitute


def test_a_word_of_a_class_may_say_something_else():
    points = ("match_point", "PointOfView_RH", "points_of_interest", "whats the point", "get to the point")
    others = ("beat_it", "beat_eggs", "off_beat", "beat around the bush", "hold_cup", "open_hand_slap")
    for lexeme in (*points, "at_this_point", "turning_point", *others):
        assert LEXICON.find(lexeme) is None, lexeme


def test_a_rest_is_named_by_fewer_words_than_a_gesture():
    for name in ("along", "Along", "alongBig"):
        assert LEXICON.find(name, category="rest").form.id == "arms_hanging"
        assert LEXICON.find(f"rest={name}").form.id == "arms_hanging"


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
def test_a_beat_is_a_beat_or_what_its_words_say(lexeme, gesture):
    assert LEXICON.find(lexeme).form.id == gesture


RIGHT_BUT_NO_SIDE = {"right here", "right now", "right away", "thats right", "stop right there"}


def test_who_names_a_side_means_the_gesture_of_this_side():
    for name, gesture in TARGETS.items():
        sides = {"left", "right"} & set(read_name(name).words)
        if name not in RIGHT_BUT_NO_SIDE:
            assert sides in ({gesture}, set()), name


OPPOSITES = [
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


def test_opposites_share_no_gesture():
    for pair in OPPOSITES:
        ones, others = ({match.form.id for word in words if (match := LEXICON.find(word))} for words in pair)
        assert ones, pair
        assert others, pair
        assert not ones & others, pair


def test_who_denies_something_does_not_do_it():
    denials = {"refuse_sweep", "refuse_push", "no_wag", "crossed_out", "stop", "thumb_down", "doubt_shrug"}
    names = [*TARGETS.items(), *((gesture, gesture) for gesture in sorted(GESTURES))]
    for (name, gesture), word in zip(names, cycle(("not", "dont", "no", "never"))):
        match = LEXICON.find(f"{word} {name}")
        assert match is None or match.form.id != gesture or gesture in denials, f"{word} {name}"


REVIEWED = {  # what an outsider complained of, and what is performed now
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


def test_what_was_performed_with_another_meaning():
    for lexeme, gesture in REVIEWED.items():
        match = LEXICON.find(lexeme)
        assert (None if match is None else match.form.id) == gesture, lexeme


def table(*names: tuple[str, str]) -> NameTable:
    categories = {"nod": "emblem", "wave": "emblem", "tap": "beat", "tap_twice": "beat"}
    categories |= {"there": "deictic", "yonder": "deictic"}
    classes = (class_of("tap", "tap", ["tap", "soft touch"]), class_of("aim", "there", ["aim"]))
    return NameTable(categories, names, classes)


def test_spelling_goes_before_synonyms_and_these_before_classes():
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
        found = table(("bye", "wave"), ("twofold", "tap_twice")).find(name)
        assert ((None, None) if found is None else (found.gesture, found.kind)) == (gesture, kind), name


def test_of_two_synonyms_with_one_name_the_first_counts():
    assert table(("Bye", "wave"), ("bye", "nod")).find("bye").gesture == "wave"
