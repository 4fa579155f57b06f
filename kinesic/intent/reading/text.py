"""Finds what a text means: its intents, from words, phrases, feelings and turns."""

from collections.abc import Iterator, Sequence
from functools import lru_cache

from kinesic.body.choices import GrammarName
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.reading.language import ENGLISH, Language, Rule
from kinesic.intent.reading.matching import Finding, find_rules
from kinesic.intent.reading.passage import SPEECH, Passage
from kinesic.intent.reading.phrasing import PhrasePart, find_phrases, read_grammar, stressed_near
from kinesic.intent.reading.spacy_parser import parse_grammar

PICTURED = {"iconic": 0.45, "metaphoric": 0.38}  # categories of gestures that a word may show, and how surely it does
LEAST_LETTERS = 3  # of a word that a gesture pictures
LONG = 8  # words of a text in which the speaker looks away at first
EMPHASIS = 0.25  # certainty that stress by the writer adds
EMOTICON = 0.7  # certainty of a feeling that an emoticon shows
STYLES = {"emotion-joy": "joyful", "emotion-joyStrong": "joyful", "emotion-sadness": "sad", "emotion-anger": "angry"}
WORDS_KEPT = 8192  # words


def find_intents(
    passage: Passage,
    language: Language,
    lexicon: Lexicon,
    *,
    grammar: GrammarName = "rules",
    begins: bool = True,
    ends: bool = True,
) -> tuple[Intent, ...]:
    """Finds all that a text means, in the order in which it is said; the same text has the same intents.

    Args:
        passage: the text.
        language: its rules.
        lexicon: gestures that may picture its words.
        grammar: who finds how its words belong together; spaCy does so for English.
        begins: whether a turn begins with it.
        ends: whether a turn ends with it.

    Raises:
        ConfigError: spaCy or its model is missing.
    """
    if not passage.words:
        return ()
    is_parsed = grammar == "spacy" and passage.language == ENGLISH
    found_grammar = parse_grammar(passage) if is_parsed else read_grammar(passage, language)
    clauses = found_grammar.clauses
    found = [
        *(_of_rule(passage, clauses, each) for each in find_rules(passage, language)),
        *(_of_part(passage, each) for each in find_phrases(passage, language, found_grammar)),
        *_pictures(passage, lexicon),
        *_feelings(passage),
        *_turns(passage, begins=begins, ends=ends),
    ]
    return tuple(sorted(found, key=lambda intent: (intent.stroke.seconds, -intent.certainty, intent.name)))


def _of_rule(passage: Passage, clauses: Sequence[int], finding: Finding) -> Intent:
    rule, last = finding.rule, finding.last
    content = [k for k in range(finding.first, finding.last + 1) if passage.words[k].is_content]
    if rule.reach == "clause":
        last = clauses[finding.last]
    elif rule.reach == "sentence":
        last = passage.sentences[passage.words[finding.first].sentence][-1]
    sure = min(
        1.0, rule.certainty + EMPHASIS * any(w.emphatic for w in passage.words[finding.first : finding.last + 1])
    )
    said = " ".join(word.text for word in passage.words[finding.first : finding.last + 1])
    word = content[-1] if content else finding.last
    return _intent(passage, rule.intent, (finding.first, word, last), sure, f"'{said}' {rule.says}", rule)


def _of_part(passage: Passage, part: PhrasePart) -> Intent:
    said = " ".join(word.text for word in passage.words[part.first : part.last + 1])
    return _intent(passage, part.intent, (part.first, part.last, part.last), part.certainty, f"'{said}' {part.says}")


def _pictures(passage: Passage, lexicon: Lexicon) -> Iterator[Intent]:
    """What gestures of the lexicon picture the words: `rain`, `write`, `grow`; their names are English."""
    if passage.language != ENGLISH:
        return
    for k, word in enumerate(passage.words):
        if not word.is_content or len(word.plain) < LEAST_LETTERS:
            continue
        pictured = _pictured(lexicon, word.plain)
        if pictured is not None:
            gesture, category = pictured
            why = f"'{word.text}' can be shown: {category} gesture"
            sure = PICTURED[category] + EMPHASIS * word.emphatic
            yield _intent(passage, category, (k, k, k), sure, why, lexemes=(gesture,))


@lru_cache(maxsize=WORDS_KEPT)
def _pictured(lexicon: Lexicon, word: str) -> tuple[str, str] | None:
    """The gesture that a word names outright, with its category."""
    found = lexicon.find(word)
    if found is None or found.substitute or found.form.category not in PICTURED:
        return None
    return found.form.id, found.form.category


def _feelings(passage: Passage) -> Iterator[Intent]:
    for sentence, feeling in passage.feelings:
        indices = passage.sentences[sentence]
        if indices:
            why = "an emoticon shows it"
            rule = STYLES.get(feeling, "")
            yield _intent(passage, feeling, (indices[0], indices[-1], indices[-1]), EMOTICON, why, style=rule)


def _turns(passage: Passage, *, begins: bool, ends: bool) -> Iterator[Intent]:
    """Where the speaker takes and gives the floor, and where phrases and sentences end."""
    last = len(passage.words) - 1
    if begins and last >= LONG:
        start, end, why = Moment(f"{SPEECH}:start", 0.0), passage.close(min(2, last)), "eyes go aside to plan"
        yield Intent("turn-begin", start, end, end, 0.5, f"the turn begins: {why}", word=0)
    if ends:
        yield _intent(passage, "turn-end", (last, last, last), 0.6, "the turn ends: it is looked at who listens")
    for indices in passage.phrases if passage.is_over and not ends else passage.phrases[:-1]:
        k = indices[-1]
        is_end = k < last and passage.words[k + 1].sentence != passage.words[k].sentence
        name, what = ("boundary-sentence", "sentence") if is_end else ("boundary-phrase", "phrase")
        sure = 0.4 if is_end else 0.15
        yield _intent(passage, name, (k, k, k), sure, f"a {what} ends with '{passage.words[k].text}'")


def _intent(
    passage: Passage,
    name: str,
    place: tuple[int, int, int],
    certainty: float,
    reason: str,
    rule: Rule | None = None,
    *,
    lexemes: tuple[str, ...] = (),
    style: str = "",
) -> Intent:
    """An intent whose stroke is at a word near its own that is stressed.

    Args:
        passage: in which it is found.
        name: of its behaviour set.
        place: its first word, the one that it is about, and its last one.
        certainty: 0..1.
        reason: for people.
        rule: that holds, which may name gestures and a manner.
        lexemes: gestures that show it better than its set.
        style: manner that it asks for.
    """
    first, word, last = place
    stressed = stressed_near(passage, word)
    return Intent(
        name=name,
        start=passage.onset(first),
        stroke=passage.stress(stressed),
        end=passage.close(max(last, stressed)),
        certainty=certainty,
        reason=reason,
        lexemes=rule.lexemes if rule else lexemes,
        word=word,
        phrase=passage.words[stressed].phrase,
        style=rule.style if rule else style,
    )
