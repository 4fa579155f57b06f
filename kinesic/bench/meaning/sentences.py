"""Makes sentences of templates: prose as people talk, and sentences with one deictic word each."""

import random
from collections.abc import Sequence

OPENINGS = (
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
WHO = (
    "the old captain",
    "my sister",
    "everybody in the village",
    "a young doctor",
    "our neighbours",
    "they",
    "she",
    "you",
)
DO = (
    "found",
    "never saw",
    "described",
    "really wanted",
    "did not understand",
    "carried",
    "could hardly believe",
    "sold",
)
WHAT = (
    "three enormous boxes", "a tiny silver key", "the whole story", "nothing at all", "the long road to the river",
    "many wonderful pictures", "a heavy round stone", "the letter from his mother", "the small wooden bridge",
)  # fmt: skip
ENDINGS = (
    "", " before the rain came", ", but nobody listened", " and laughed", ", first slowly and then very fast",
    " in the great hall of the palace", ", because the night was cold", " on Sunday morning", ", my friend",
)  # fmt: skip
ASIDES = (
    "Is that not strange?", "Hello, and welcome!", "No, I do not believe it.", "What can we do now?",
    "Thank you very much!",
    "It was apples, bread, cheese and wine.", "Look over there!", "You must be very careful.", "I am so happy :)",
)  # fmt: skip
EVERY = 6  # sentences after which an aside comes
POINTING = (  # where a word points, and the intent that shows it; none: it points at nothing
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
THINGS = (
    "lamp", "basket", "table", "garden chair", "red bicycle", "kettle", "picture", "blanket", "candle", "little boat",
    "umbrella", "drum", "ladder", "mirror", "old clock", "guitar", "bottle", "hammer", "carpet", "wooden spoon",
)  # fmt: skip


def prose(count: int, seed: int = 0) -> Sequence[str]:
    """Makes sentences as they follow one another in a talk."""
    chance = random.Random(seed)
    made = []
    for number in range(count):
        opening, who, do, what, ending = (chance.choice(each) for each in (OPENINGS, WHO, DO, WHAT, ENDINGS))
        said = f"{opening}{who} {do} {what}{ending}."
        made.append(chance.choice(ASIDES) if number % EVERY == EVERY - 1 else said[0].upper() + said[1:])
    return made


def deictic_sentences() -> Sequence[tuple[str, str]]:
    """Makes 200 sentences, each with the intent of what it points at; empty where it points at nothing."""
    return [(text.format(thing=thing), intent) for text, intent in POINTING for thing in THINGS]
