import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.search import NEAR_SCORE, find_gestures
from kinesic.expressivity.lexicon.word_stems import word_stem


@pytest.fixture(scope="module")
def lexicon() -> Lexicon:
    return Lexicon.load()


def ids(lexicon: Lexicon, query: str, count: int = 5) -> list[str]:
    return [hit.id for hit in find_gestures(lexicon, query, count=count)]


@pytest.mark.parametrize(
    ("query", "gesture"),
    [
        ("versus", "contrast_left_right"),
        ("compare", "contrast_left_right"),
        ("compare two options", "contrast_left_right"),
        ("big", "large"),
        ("thumbs up", "thumb_up"),
        ("weigh two things", "balance"),
        ("weigh against", "balance"),
        ("run away", "run"),
        ("falling", "fall"),
        ("yes", "allright"),
        ("waving goodbye", "greet_wave"),
        ("counting to three", "count_three"),
        ("ballance", "balance"),
        ("thinkng", "think"),
        ("GREET_WAVE", "greet_wave"),
        ("drink coffee", "drink"),
        ("idea bowl", "conduit"),
        ("shrug", "doubt_shrug"),
        ("look at the watch", "watch_time"),
        ("two hands apart", "large"),
        ("be quiet", "hush"),
        ("call me on the phone", "phone_call"),
        ("push it away", "refuse_push"),
        ("point at my nose", "nose"),
        ("she is heartbroken", "sadness"),
        ("firstly, secondly, thirdly", "list_fingers"),
        ("suddenly an idea strikes him", "grasp"),
        ("a child about so high", "flat_hand_level"),
    ],
)
def test_gesture_search_lists_the_expected_gesture_first(lexicon, query, gesture):
    assert ids(lexicon, query)[0] == gesture


@pytest.mark.parametrize(
    ("query", "gestures"),
    [
        ("hand to the temple", {"think", "crazy", "salute"}),
        ("finger at the temple", {"think", "crazy"}),
        ("touch the forehead", {"palm_to_forehead", "wipe_brow"}),
        ("hand on the belly", {"belly", "pat_tummy"}),
        ("big box", {"large", "object_hold"}),
        ("cover the mouth", {"gasp", "yawn"}),
        ("hands on the hips", {"akimbo", "hand_on_hip"}),
        ("palm down", {"flat_hand_down", "calm_down"}),
        ("fold your hands", {"hands_folded_low", "hands_together"}),
        ("small amount of money", {"money"}),
        ("show the biceps", {"beat_strong", "yes_fist"}),
        ("hands in the air", {"joy_cheer"}),
    ],
)
def test_first_3_hits_for_body_places_and_movements_contain_the_expected_gestures(lexicon, query, gestures):
    assert gestures <= set(ids(lexicon, query, 3))


def test_function_words_of_a_query_do_not_change_its_hits(lexicon):
    assert ids(lexicon, "the hand is at the temple") == ids(lexicon, "hand temple")
    assert ids(lexicon, "come here")[0] == ids(lexicon, "come")[0] == "come"
    assert ids(lexicon, "you")[0] == "you"


def test_gesture_found_by_a_lexeme_lookup_that_ignores_words_is_not_among_the_first_3_search_hits(lexicon):
    assert lexicon.find("point at my nose").form.id == "me"
    assert "me" not in ids(lexicon, "point at my nose", 3)


def test_gesture_search_does_not_match_inside_a_word(lexicon):
    assert "watching_you" not in ids(lexicon, "yes", 50)
    assert "watching_you" in ids(lexicon, "eyes")


def test_gestures_that_match_only_some_query_words_are_marked_as_near_hits(lexicon):
    hits = find_gestures(lexicon, "run away")
    assert "go_away" in [hit.id for hit in hits[:3]]
    assert {hit.kind for hit in hits if hit.score < NEAR_SCORE} == {"near"}
    assert next(hit for hit in hits if hit.id == "go_away").words == ("away",)


def test_gesture_search_results_are_sorted_by_score_with_synonyms_first(lexicon):
    hits = find_gestures(lexicon, "thumbs up")
    assert [hit.score for hit in hits] == sorted((hit.score for hit in hits), reverse=True)
    assert [hit.kind for hit in hits[:2]] == ["synonym", "words"]
    assert find_gestures(lexicon, "thumb_up")[0].kind == "name"
    assert len({hit.id for hit in hits}) == len(hits)


def test_search_for_a_gesture_name_or_synonym_lists_its_gesture_first(lexicon):
    names = [*lexicon.forms_by_id, *(name for name, _ in lexicon.synonyms[::9])]
    for name in names:
        assert ids(lexicon, name, 1) == [lexicon.find(name).form.id], name


def test_gesture_search_completes_a_word_beginning_of_five_letters(lexicon):
    assert "balance" in ids(lexicon, "balan")
    assert ids(lexicon, "ba", 50) == []


def test_gesture_search_is_limited_by_category_and_count(lexicon):
    hits = find_gestures(lexicon, "wave", category="emblem", count=2)
    assert len(hits) == 2
    assert {hit.category for hit in hits} == {"emblem"}
    assert find_gestures(lexicon, "wave", category="nothing") == ()


@pytest.mark.parametrize("query", ["", "  "])
def test_empty_gesture_search_lists_all_gestures(lexicon, query):
    assert [hit.id for hit in find_gestures(lexicon, query, count=9999)] == [entry.id for entry in lexicon.entries]


@pytest.mark.parametrize("query", ["qqqq", "???", "=", "\0", "q" * 100_000, "\N{GRINNING FACE}"])
def test_gesture_search_without_a_known_word_finds_nothing(lexicon, query):
    assert find_gestures(lexicon, query) == ()


def test_gestures_of_the_user_are_found_with_their_names(tmp_path):
    (tmp_path / "mine.toml").write_text(
        'category = "iconic"\n'
        '[[gesture]]\nid = "teapot"\nmeanings = ["teapot", "kettle"]\nsays = "A hand pours tea."\n'
        'keys = [{right = {at = [0.2, 0.1, 0.5], palm = "in", pointing = "forward", shape = "flat"}}]\n'
        '[synonyms]\nteapot = ["short and stout"]\n'
    )
    lexicon = Lexicon.load(tmp_path / "mine.toml")
    assert ids(lexicon, "short and stout")[0] == "teapot"
    assert ids(lexicon, "kettles")[0] == "teapot"


@pytest.mark.parametrize(
    "forms",
    [
        ("wave", "waves", "waved", "waving"),
        ("carry", "carries", "carried", "carrying"),
        ("stop", "stopped", "stopping"),
    ],
)
def test_inflected_forms_of_a_word_share_their_stem(forms):
    assert len({word_stem(form) for form in forms}) == 1


def test_search_stem_of_a_short_word_is_the_word_itself():
    assert [word_stem(word) for word in ("yes", "is", "red", "bus", "king", "a", "")] == [
        *("yes", "is", "red", "bus", "king", "a", "")
    ]
