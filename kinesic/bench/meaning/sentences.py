"""Sentences from templates: spoken prose, and sentences for tests of deixis."""

import random
from collections.abc import Sequence

SENTENCE_OPENINGS = (
    "",
    "Well, ",
    "And ",
    "However, ",
    "I think that ",
    "In the end, ",
    "Yesterday ",
    "Of course, ",
    "So ",
    "Perhaps ",
)
SENTENCE_SUBJECTS = (
    "the old captain",
    "my sister",
    "everybody in the village",
    "a young doctor",
    "our neighbours",
    "they",
    "she",
    "you",
)
SENTENCE_VERBS = (
    "found",
    "never saw",
    "described",
    "really wanted",
    "did not understand",
    "carried",
    "could hardly believe",
    "sold",
)
# Objects from which sentences are composed.
SENTENCE_OBJECTS = (
    "three enormous boxes", "a tiny silver key", "the whole story", "nothing at all", "the long road to the river",
    "many wonderful pictures", "a heavy round stone", "the letter from his mother", "the small wooden bridge",
)  # fmt: skip
# Ends of composed sentences; empty: none.
SENTENCE_ENDINGS = (
    "", " before the rain came", ", but nobody listened", " and laughed", ", first slowly and then very fast",
    " in the great hall of the palace", ", because the night was cold", " on Sunday morning", ", my friend",
)  # fmt: skip
# Short sentences between the composed sentences.
SHORT_ASIDES = (
    "Is that not strange?", "Hello, and welcome!", "No, I do not believe it.", "What can we do now?",
    "Thank you very much!",
    "It was apples, bread, cheese and wine.", "Look over there!", "You must be very careful.", "I am so happy :)",
)  # fmt: skip
ASIDE_INTERVAL = 6  # [sentences] every sixth sentence is a short aside
DEICTIC_TEMPLATES = (  # sentence template and its deictic intent; empty: no deictic word
    ("Put the {thing} over there.", "world-place-there"),
    ("There was a {thing} in the garden.", ""),
    ("There are many kinds of {thing}.", ""),
    ("Come here and bring the {thing}.", "world-place-here"),
    ("Give me the {thing}.", "deictic-me"),
    ("The {thing} is mine.", "deictic-me"),
    ("Is the {thing} yours?", "deictic-you"),
    ("You broke the {thing}.", "deictic-you"),
    ("I said that the {thing} was broken.", "deictic-me"),
    ("The {thing} that he found was new.", ""),
)
# Names of things that the sentences of `DEICTIC_TEMPLATES` point at.
DEICTIC_OBJECTS = (
    "lamp", "basket", "table", "garden chair", "red bicycle", "kettle", "picture", "blanket", "candle", "little boat",
    "umbrella", "drum", "ladder", "mirror", "old clock", "guitar", "bottle", "hammer", "carpet", "wooden spoon",
)  # fmt: skip


def prose(count: int, seed: int = 0) -> Sequence[str]:
    """Generate random sentences with occasional short asides, as in a talk."""
    rng = random.Random(seed)
    sentences = []
    for number in range(count):
        opening, subject, verb, noun, ending = (
            rng.choice(words)
            for words in (SENTENCE_OPENINGS, SENTENCE_SUBJECTS, SENTENCE_VERBS, SENTENCE_OBJECTS, SENTENCE_ENDINGS)
        )
        sentence = f"{opening}{subject} {verb} {noun}{ending}."
        sentences.append(
            rng.choice(SHORT_ASIDES)
            if number % ASIDE_INTERVAL == ASIDE_INTERVAL - 1
            else sentence[0].upper() + sentence[1:]
        )
    return sentences


def deictic_sentences() -> Sequence[tuple[str, str]]:
    """Return 200 sentences with their deictic intents.

    The intent is empty for a sentence without a deictic word.
    """
    return [(text.format(thing=thing), intent) for text, intent in DEICTIC_TEMPLATES for thing in DEICTIC_OBJECTS]
