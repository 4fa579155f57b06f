import sys

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.intent.reading import spacy_parser
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.spacy_parser import parse_grammar, parser_fault
from kinesic.intent.reading.text import find_intents
from kinesic.intent.reading.words import read_text

needs_spacy = pytest.mark.skipif(bool(parser_fault()), reason=parser_fault() or "spaCy is there")
BUILTIN_LEXICON = Lexicon.load()


def grammar_of(text):
    passage = read_text(text, load_language())
    return [word.plain for word in passage.words], parse_grammar(passage)


@needs_spacy
@pytest.mark.parametrize(
    ("text", "word", "last"),
    [
        ("I did not say that there were boxes.", "not", "boxes"),
        ("I did not come but he laughed.", "not", "come"),
        ("I didn't come because the night was cold.", "didn't", "come"),
        ("He never saw the house that burned down.", "never", "down"),
        ("Not today.", "not", "today"),
    ],
)
def test_clause_parsed_by_spacy_ends_with_its_last_dependent_word(text, word, last):
    words, grammar = grammar_of(text)
    assert words[grammar.clauses[words.index(word)]] == last


@needs_spacy
def test_spacy_parser_finds_noun_phrases_and_verbs():
    words, grammar = grammar_of("The old captain quickly described three long roads. Rain fell on us.")
    named = [" ".join(words[first : last + 1]) for first, last in grammar.things]
    assert named == ["the old captain", "three long roads"]
    assert [words[k] for k in grammar.verbs] == ["described", "fell"]


@needs_spacy
@pytest.mark.parametrize(
    "text", ["", "...", "Hm", "<b>?!</b> :) \U0001f600 a\u0301b", "x " * 300, "don't can't won't! -- (no)"]
)
def test_spacy_parser_gives_any_text_clause_ends_within_the_text(text):
    words, grammar = grammar_of(text)
    assert len(grammar.clauses) == len(words)
    assert all(k <= end < len(words) for k, end in enumerate(grammar.clauses))


@needs_spacy
def test_word_rules_and_spacy_parser_find_the_same_negations():
    language = load_language()
    passage = read_text("No, I never saw it, and you did not tell me so.", language)
    names = [
        [
            (intent.name, intent.word)
            for intent in find_intents(passage, language, BUILTIN_LEXICON, grammar=grammar)
            if "nega" in intent.name
        ]
        for grammar in ("rules", "spacy")
    ]
    assert names[0] == names[1] != []


@pytest.mark.parametrize(
    ("missing", "says"),
    [(("spacy", *spacy_parser.MODEL_PACKAGES), "not installed"), (spacy_parser.MODEL_PACKAGES, "no model")],
)
def test_missing_spacy_parser_is_named_and_german_needs_none(monkeypatch, missing, says):
    spacy_parser._load_model.cache_clear()
    monkeypatch.setattr(spacy_parser, "find_spec", lambda name: None if name in missing else sys)
    with pytest.raises(ConfigError, match=rf"--grammar spacy: .*{says}.*kinesic\[text\]"):
        parse_grammar(read_text("Hello", load_language()))
    german = load_language("de")
    assert find_intents(read_text("Hallo!", german), german, BUILTIN_LEXICON, grammar="spacy")
