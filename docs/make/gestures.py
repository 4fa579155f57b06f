"""Writes docs/gestures.md and draws docs/gestures.png: every gesture of the lexicon, by category.

What `docs/make/naturalness.py` has written into the page stays.
"""

from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from kinesic.controller.perform import set_up
from kinesic.studies.gestures.isolated import key_postures, plan_gesture
from kinesic.studies.gestures.sheet import MOST_POSTURES, draw_gesture_sheet
from kinesic.studies.gestures.vocabulary import VocabularyEntry, vocabulary

DOCS = Path(__file__).parents[1]
PAGE = DOCS / "gestures.md"
BEGIN, END = "<!-- naturalness -->", "<!-- end of naturalness -->"  # of what docs/make/naturalness.py writes
KINDS = {
    "adaptor": "What the hands do to the body and to things, beside the talk.",
    "beat": "The rhythm of the talk: no picture, only stress.",
    "deictic": "Pointing: at things, places, people and times.",
    "emblem": "Agreed signs that need no words; performatives.",
    "emotion": "What is felt, shown by hands and arms.",
    "iconic": "A picture of a thing, or of what is done with it.",
    "metaphoric": "An abstract thing as if it had a shape: image schemas.",
    "rest": "Postures that stay until the next one.",
}
HEAD = """# The gestures

Written by `docs/make/gestures.py` from `kinesic/configs/gestures/`: {count} gestures, no two alike. Two gestures count
as two only if their hands, in neutral manner, go ways that differ by 5 cm RMS over both hands, or are turned by 30 deg
RMS or shaped differently. [my-gestures.md](my-gestures.md) says how to write one.

Each is drawn at its stroke, from the front, over the shadow of how its arms begin; the line is the palm's way through
the stroke. The robot has no fingers: they are drawn to show the shape that a hand with fingers would take.
`kinesic gestures render NAME --out NAME.png` draws one as key postures, `--turntable --out NAME.webp` films it from all
around; `--robot` names who does it ([my-gestures.md](my-gestures.md)).

![Every gesture at its stroke](gestures.png)

`kinesic gestures list --json` prints the same as a vocabulary for a planner or a language model: a list of
`{{id, category, says, meanings, hands, shapes, stroke_s, whole_s, synonyms, tempo, body}}`; `id` is what BML's
`lexeme` says, `meanings` are words that speak of the gesture, `synonyms` names that find it too ([all of
them](synonyms.md)), the times are natural ones in neutral manner, `body` is what head, trunk, shoulders, eyes and face
do beside the hands. Keys may be added, never renamed.

[At the end](#how-naturally-they-move) the gestures are measured beside those of people.
"""


def page(entries: list[VocabularyEntry]) -> str:
    """The page, in Markdown."""
    return "\n".join([HEAD.format(count=len(entries)), *_tables(entries), f"{BEGIN}{_measured()}{END}", ""])


def _measured() -> str:
    """What the page says already of what was measured."""
    text = PAGE.read_text(encoding="utf-8")
    return text.split(BEGIN)[1].split(END)[0] if BEGIN in text else "\n"


def _tables(entries: list[VocabularyEntry]) -> Iterator[str]:
    for category, group in groupby(entries, lambda entry: entry.category):
        rows = list(group)
        yield f"## {category} ({len(rows)})\n\n{KINDS[category]}\n"
        yield "| gesture | what is done | hands | tempo | words |\n|---|---|---|---|---|"
        for entry in rows:
            hands = "both" if len(entry.hands) == 2 else entry.hands[0]
            tempo = "" if entry.tempo == "neutral" else entry.tempo
            yield f"| `{entry.id}` | {entry.says} | {hands} | {tempo} | {', '.join(entry.meanings[:6])} |"
        yield ""


if __name__ == "__main__":
    known = set_up()
    PAGE.write_text(page(vocabulary(known.lexicon, known.pace)), encoding="utf-8")
    shows = [key_postures(form, plan_gesture(form, known), MOST_POSTURES) for form in known.lexicon.forms]
    draw_gesture_sheet(shows, known.robot, DOCS / "gestures.png")
