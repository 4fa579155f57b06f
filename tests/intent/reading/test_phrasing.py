import pytest

from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.phrasing import clause_ends, find_phrases, read_grammar, stressed_near
from kinesic.intent.reading.words import read_text


def parts(text, kind):
    """Return the words of all phrase parts whose kind has a prefix."""
    language = load_language()
    passage = read_text(text, language)
    phrases = [
        phrase
        for phrase in find_phrases(passage, language, read_grammar(passage, language))
        if phrase.intent.startswith(kind)
    ]
    return [
        (item.intent, " ".join(word.plain for word in passage.words[item.first : item.last + 1])) for item in phrases
    ]


@pytest.mark.parametrize(
    ("text", "items"),
    [
        ("We had apples, old bread and wine.", ["apples", "bread", "wine"]),
        ("We had apples, bread, cheese, or wine.", ["apples", "bread", "cheese", "wine"]),
        ("We had old apples, bread and wine from Spain.", ["apples", "bread", "wine"]),
        ("We had bread and wine.", []),  # Two items are not a list
        ("We ran, we fell, we slept.", []),  # No conjunction
        ("We had apples, which my old aunt from the north had sent, and wine.", []),  # An aside
    ],
)
def test_gestures_for_list_items_alternate_left_and_right(text, items):
    result = parts(text, "listing")
    assert [words for _, words in result] == items
    assert [side for side, _ in result] == [f"listing-{('left', 'right')[k % 2]}" for k in range(len(items))]


@pytest.mark.parametrize(
    ("text", "phrases"),
    [
        ("The dog saw a big cat.", [("first-noun-phrase", "the dog"), ("noun-phrase", "a big cat")]),
        ("It was the, well, end.", []),  # Last word of its phrase
        ("Dogs bark.", []),  # Without a determiner
        ("A bird came. The cat went.", [("first-noun-phrase", "a bird"), ("first-noun-phrase", "the cat")]),
    ],
)
def test_noun_phrase_spans_determiner_to_noun(text, phrases):
    assert [part for part in parts(text, "") if "noun-phrase" in part[0]] == phrases


def test_first_verb_of_a_sentence_gives_an_intent():
    assert parts("They carried the box and sang.", "first-verb") == [("first-verb-phrase", "carried")]
    assert parts("The box was heavy and is gone.", "first-verb") == [("first-verb-phrase", "was")]


@pytest.mark.parametrize(
    ("text", "last"),
    [("I never saw it but he did.", "it"), ("I never saw it, he did.", "it"), ("I never did. He did.", "did")],
)
def test_clause_ends_at_punctuation_or_the_next_clause(text, last):
    passage = read_text(text, load_language())
    assert passage.words[clause_ends(passage, load_language())[1]].plain == last


def test_stroke_of_a_function_word_moves_to_the_next_content_word():
    passage = read_text("The river takes you to my garden.", load_language())
    words = [word.plain for word in passage.words]
    assert stressed_near(passage, words.index("you")) == words.index("garden")
    assert stressed_near(passage, words.index("takes")) == words.index("takes")


@pytest.mark.parametrize(("weak", "stressed"), [("you", "river"), ("from", "garden"), ("it", "garden")])
def test_stroke_of_a_function_word_moves_to_the_nearest_content_word_if_the_next_is_far(weak, stressed):
    passage = read_text("The river to you of me from it to the garden", load_language())
    words = [word.plain for word in passage.words]
    assert len(passage.phrases) == 1
    assert words[stressed_near(passage, words.index(weak))] == stressed


def test_intents_of_noun_phrases_are_less_certain_than_those_of_accents_and_emphasised_words():
    """Check an order that keeps nouns from displacing the phrase's beat."""
    language = load_language()
    passage = read_text("The dog saw a *big* cat.", language)
    certainty = {
        phrase.intent: phrase.certainty for phrase in find_phrases(passage, language, read_grammar(passage, language))
    }
    assert 0.0 < certainty["first-noun-phrase"] == certainty["noun-phrase"] < certainty["accent"]
    assert certainty["accent"] < certainty["emphasis-strong"] < 1.0
