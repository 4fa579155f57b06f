"""Tests of gestures, facial expressions and head movements chosen by meaning."""

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author, plan_behaviours
from kinesic.intent.meaning.cue_table import load_cues

LEXICON, NEUTRAL = Lexicon.load(), Style.load("neutral")
REFUSALS = {"no_low", "no_wag", "refuse_sweep", "refuse_push", "crossed_out", "stop", "stop_low"}


def shown(text: str, channel: str = "gesture", seed: int = 0) -> set[str]:
    """Return the lexemes of one channel for a text."""
    _, selection = plan_behaviours(text, LEXICON, NEUTRAL, seed=seed)
    return {behaviour.lexeme for behaviour in selection.behaviours if behaviour.channel == channel}


def is_beat(lexemes: set[str]) -> bool:
    return all(lexeme.startswith("beat") for lexeme in lexemes)


@pytest.mark.parametrize(
    "text",
    ["No problem!", "I couldn't agree more.", "Why not?", "Not bad at all!", "I can't wait to see it.", "Don't worry.",
     "They couldn't agree with him more.", "Nothing beats fresh bread.", "No wonder it broke.",
     "It's at number 5, not only today."],
)  # fmt: skip
def test_idioms_with_negative_words_get_no_refusal_gesture(text: str):
    for seed in range(3):
        assert not shown(text, seed=seed) & REFUSALS
    assert "SHAKE" not in shown(text, "head") or "not only" in text


@pytest.mark.parametrize(
    "text",
    ["Nobody bakes a nicer pie than my aunt.", "Not a bad start for a small team.", "I'm not saying it's cheap.",
     "The nurse says it won't take long.", "I haven't slept so well in months.", "It might never snow.",
     "Thank goodness nobody was hurt.", "If you don't run, the train leaves.", "She found no error in it.",
     "I never thought I'd do it."],
)  # fmt: skip
def test_sentences_without_a_denial_get_no_head_shake(text: str):
    assert "SHAKE" not in shown(text, "head")


@pytest.mark.parametrize(
    ("text", "face"),
    [("What a way to spoil a perfectly good morning.", "smile"), ("He refused a very good job in York.", "smile"),
     ("Sorry, is this chair free?", "sorry")],
)  # fmt: skip
def test_words_of_politeness_in_other_senses_get_no_facial_expression(text: str, face: str):
    assert face not in shown(text, "face")
    assert shown("Good morning!", "face") == {"smile"}
    assert shown("I'm so sorry!", "face") & {"sorry", "sadness", "LOWER_MOUTH_CORNERS"}


@pytest.mark.parametrize("text", ["Watch out, the pan is hot!", "Mind your step.", "Look out for the bus."])
def test_text_that_warns_of_a_danger_gets_a_raised_finger(text: str):
    assert shown(text) == {"warning_finger"}
    assert "warning_finger" not in shown("Mind your own business.") | shown("You look out of the window.")


def test_idiom_count_on_one_hand_gets_no_gesture_for_one_side_of_an_argument():
    assert "on_one_hand" not in shown("I can count on one hand the boats that came back.")
    assert "on_one_hand" in shown("On one hand, boats are slow; on the other hand, they are quiet.")


def test_two_sides_of_an_argument_are_shown_by_one_hand_each():
    text = "On the one hand, it is cheap. On the other hand, it breaks."
    for seed in range(4):
        bml = author(text, LEXICON, NEUTRAL, seed=seed)
        assert [bml.count(f'lexeme="on_one_hand" mode="{side}_HAND"') for side in ("RIGHT", "LEFT")] == [1, 1]


@pytest.mark.parametrize(
    ("text", "gestures"),
    [
        ("I never want to see that place again.", {"refuse_sweep", "no_low"}),
        ("We no longer want to wait for him.", {"refuse_sweep", "no_low"}),
        ("If I never want to see it, I go.", set()),
        ("Meanwhile, my brother was asleep.", {"contrast_left_right"}),
        ("Some of them stayed, whereas others went home.", {"contrast_left_right"}),
        ("Some of them stayed, but others went home.", {"contrast_left_right"}),
        ("The stairs were narrow.", {"narrow_low", "between_fingers"}),
        ("We found a small box.", {"small_pinch", "tiny_low", "narrow_low"}),
        ("They had a wide table.", {"large"}),
        ("After that it was easy.", {"after_that"}),
        ("It was not my idea at all.", {"no_low", "refuse_sweep"}),
        ("I have absolutely no clue.", {"doubt_shrug", "shrug_small"}),
        ("He is a big shot there.", set()),
        ("It was a small mistake.", set()),
        ("We made small talk.", set()),
        ("If you look up, it is there.", {"up"}),
        ("Look up the word.", set()),
        ("Please do not touch it.", {"stop", "stop_low"}),
        ("I do not know.", {"doubt_shrug", "shrug_small"}),
        ("The tower collapsed.", {"fall"}),
        ("And then it popped.", {"explode"}),
        ("Could you put it over there, please?", {"that_far"}),
        ("Is it over there?", {"ask_open", "that_far"}),
        ("The bird flew out of the window.", {"fly_bird"}),
        ("We flew over to Oslo.", set()),
        ("It turns faster and faster.", {"fast_off"}),
        ("He fell into the river.", {"fall"}),
        ("He fell in love.", set()),
        ("She fell into a deep sleep.", set()),
        ("The ice cracked.", {"break_apart"}),
        ("It was the longest queue of all.", {"large"}),
        ("It was the longest day of all.", set()),
        ("Do not open that door!", {"stop", "stop_low"}),
        ("I wish I could say that.", set()),
        ("I wish I could help.", {"heart"}),
        ("In my opinion, we should wait.", {"me_low", "me"}),
        ("Everybody out, now!", {"go_away"}),
        ("Could you keep it down back there?", {"quieter"}),
        ("She had her knee replaced last year.", set()),
        ("Replace it with a new one.", {"exchange"}),
        ("You must never open it.", {"one_moment", "warning_finger", "no_wag"}),
        ("You always say so.", {"you_low", "you"}),
        ("Our school has a new roof.", set()),
        ("Our team needs you!", {"we"}),
        ("Well done, that's it, you've got it!", {"thumb_up", "thumb_up_low"}),
        ("That's it.", {"dust_hands"}),
        ("Give her a big hug from me.", {"self_hug"}),
        ("And she only shrugs.", {"shrug_small", "doubt_shrug"}),
        ("The flood carried everything away.", {"wipe_away"}),
        ("Slowly breathe in, and let it out again.", {"calm_down", "relief"}),
    ],
)
def test_each_sample_sentence_gets_only_its_listed_illustrating_gestures(text: str, gestures: set[str]):
    pictures = {name for name in shown(text) if not name.startswith("beat")}
    assert pictures <= gestures
    assert bool(pictures) == bool(gestures)


@pytest.mark.parametrize(
    "text",
    ["We all walked and went down to the harbour.", "A thin mist hung over the canal.", "She pushed the lid over it.",
     "The iron hook hangs under the roof.", "Here stands the thing that visitors come for."],
)  # fmt: skip
def test_direction_words_in_other_senses_get_only_beat_gestures(text: str):
    assert is_beat(shown(text))


def test_repeated_path_words_give_a_circle_or_a_sequence_gesture():
    assert shown("She walked round and round the pond.") >= {"circle_drawn"}
    assert "one_after_another" in shown("Step by step the bridge was built.")


def test_word_this_before_a_noun_gets_no_pointing_gesture():
    assert "that_low" in shown("I'll take this one.")
    assert "that_low" not in shown("The whole roof rests on this one beam.")


def test_sentence_about_a_third_person_gets_no_gesture_to_the_listener():
    assert "you_low" in shown("Oh, just admit it.")
    assert "you_low" not in shown("He will admit it.")


def test_word_pairs_of_a_cue_match_across_a_comma_only_if_repeated():
    assert "thumb_up" in shown("It was well done.") | shown("Well done!") | shown("Well done!", seed=1)
    assert is_beat(shown("Look, out there it rains.") - {"that_far", "rain", "that_low"})
    assert "no_low" in shown("No, no, not now.")
    assert not shown("The answer is right, now the next question.") & {"now_here", "here_down"}


def test_text_with_a_denial_gets_a_head_shake_and_a_refusal_gesture():
    assert shown("No, I won't.") & {"no_low"}
    assert shown("No, I won't.", "head") == {"SHAKE"}


@pytest.mark.parametrize(
    "text", ["Are you happy?", "I wish I were happy.", "He said he was so happy.", "I'm not happy."]
)
def test_emotions_are_shown_only_if_the_speaker_feels_them(text: str):
    assert "joy" in shown("I'm so happy about it!", "face")
    assert "joy" not in shown(text, "face")
    assert not shown(text) & {"joy_bounce", "joy_cheer"}


@pytest.mark.parametrize(
    "text",
    ["The bus stop is opposite the bank.", "The heating comes on at half past two.", "He plays left back for a team.",
     "The shop opens at nine on Mondays.", "The high street was closed."],
)  # fmt: skip
def test_plain_statements_get_only_beat_gestures(text: str):
    assert is_beat(shown(text))


@pytest.mark.parametrize(
    "text",
    ["My jaw hit the floor at the price.", "They vanished into thin air.", "He is always up in arms.",
     "Tickets for it are a long shot."],
)  # fmt: skip
def test_words_of_idioms_get_no_illustrating_gesture(text: str):
    for seed in range(2):
        assert is_beat(shown(text, seed=seed))


def test_pronouns_in_separate_clauses_do_not_trigger_the_we_gesture():
    assert "we" in shown("This is just between me and you.")
    assert "we" not in shown("You never praise me, and you never listen.")


def test_word_with_a_literal_gesture_is_shown_unless_denied():
    assert "large" in shown("It was a huge dog.")
    assert "large" not in shown("It was not a huge dog.")


def test_counted_things_get_a_number_gesture_but_units_of_measurement_do_not():
    assert "count_three" in shown("There are three reasons for it.")
    assert is_beat(shown("The lesson takes three hours on Fridays."))


def test_random_seed_chooses_only_among_the_gestures_of_one_cue():
    cues = load_cues("en").cues
    (unsure,) = (set(cue.shows) for cue in cues if cue.says == "does not know")
    assert {item for seed in range(6) for item in shown("I have no idea.", seed=seed)} <= unsure


def test_gestures_named_by_cues_exist_in_the_lexicon():
    known = {entry.id for entry in LEXICON.entries}
    assert {name for cue in load_cues("en").cues for name in cue.shows} <= known


def test_language_without_cues_keeps_the_gestures_of_its_rules():
    assert not load_cues("de").cues
    _, selection = plan_behaviours("Hallo!", LEXICON, NEUTRAL, language="de")
    assert {behaviour.lexeme for behaviour in selection.behaviours if behaviour.channel == "gesture"} & {
        "greet_wave",
        "wave_small",
    }


def test_successive_sentences_of_equal_meaning_get_different_gestures():
    _, selection = plan_behaviours("I have no idea. I have no clue. Who knows. I don't know why.", LEXICON, NEUTRAL)
    gestures = [behaviour.lexeme for behaviour in selection.behaviours if behaviour.channel == "gesture"]
    assert len(gestures) == len(set(gestures)) > 1


def test_only_statements_of_long_texts_in_a_lively_style_get_presenting_gestures():
    story = "The tower leaned a little further every day. The captain carried a heavy box along the river. " * 2
    topics = {"conduit", "inform_spread", "open_low", "present"}

    def presented(text: str, style: str) -> list[str]:
        _, selection = plan_behaviours(text, LEXICON, Style.load(style))
        return [each.lexeme for each in selection.behaviours if "is presented" in each.intent.reason]

    assert set(presented(story, "joyful")) & topics
    assert not presented(story, "neutral")
    assert not presented("The captain carried a box along the river.", "joyful")
    assert not presented("Nobody carried the box along the river for him. " * 4, "joyful")
