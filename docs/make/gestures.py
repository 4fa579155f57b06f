"""Write docs/reference/gestures.md and draw docs/pictures/gestures.png: every gesture of the lexicon, by category."""

from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import key_postures, plan_gesture
from kinesic.studies.gestures.sheet import MAX_POSTURES, draw_gesture_sheet
from kinesic.studies.gestures.vocabulary import VocabularyEntry, list_vocabulary

DOCS = Path(__file__).parents[1]
PAGE = DOCS / "reference/gestures.md"
KINDS = {
    "adaptor": "Movements in which the hands touch the body or handle things.",
    "beat": "Small movements in the rhythm of speech, which stress words and show nothing else.",
    "deictic": "Pointing at things, places, people and times.",
    "emblem": "Conventional signs that can replace words.",
    "emotion": "Feelings, shown by hands and arms.",
    "iconic": "Gestures that draw a thing, or show how it is used.",
    "metaphoric": "Gestures that show abstract things as if they had a shape.",
    "rest": "Postures that the robot holds until the next gesture.",
}
HEAD = """# Gestures

A document requests a gesture by its name, the lexeme. This page shows all {count} gestures of the lexicon with their
names and meanings. To search them by words, run `kinesic gestures find big box`. To add one, read
[Write a gesture](../how-to/write-a-gesture.md).

The picture shows each gesture at its stroke, from the front. The shadow is the posture of the arms at the start, and
the line is the path of the palm in the stroke. The robot has no fingers; the drawn ones show the hand shape.

To see one gesture, run `kinesic gestures render NAME --out NAME.png`, which draws its key postures. The option
`--turntable` with `--out NAME.webp` films it from all sides, and `--robot` chooses another robot.

![Every gesture at its stroke](../pictures/gestures.png)

No two gestures are alike. At neutral expressivity, two gestures differ in at least one of three ways: the paths of
their hands by 5 cm RMS over both hands, their orientations by 30 deg RMS, or their hand shapes.

`kinesic gestures list --json` prints the same list for a program or a language model. Each gesture has the keys
`id`, `category`, `says`, `meanings`, `hands`, `shapes`, `stroke_s`, `whole_s`, `synonyms`, `tempo` and `body`. Later
versions may add keys, but never rename them.

| key | content |
|---|---|
| `id` | the name for BML's `lexeme` |
| `says` | movement and meaning in one line |
| `meanings` | words for the meaning of the gesture |
| `synonyms` | names that also find it ([all of them](synonyms.md)) |
| `stroke_s`, `whole_s` | natural durations at neutral expressivity [s] |
| `body` | accompanying motion of head, trunk, shoulders, eyes and face |

[Naturalness](../benchmarks/naturalness.md) compares the gestures with those of people.
"""


def page(entries: list[VocabularyEntry]) -> str:
    """Return the page in Markdown."""
    return "\n".join([HEAD.format(count=len(entries)), *_tables(entries)])


def _tables(entries: list[VocabularyEntry]) -> Iterator[str]:
    for category, group in groupby(entries, lambda entry: entry.category):
        rows = list(group)
        yield f"## {category} ({len(rows)})\n\n{KINDS[category]}\n"
        yield "| gesture | movement | hands | tempo | words |\n|---|---|---|---|---|"
        for entry in rows:
            hands = "both" if len(entry.hands) == 2 else entry.hands[0]
            tempo = "" if entry.tempo == "neutral" else entry.tempo
            yield f"| `{entry.id}` | {entry.says} | {hands} | {tempo} | {', '.join(entry.meanings[:6])} |"
        yield ""


if __name__ == "__main__":
    known = set_up()
    PAGE.write_text(page(list_vocabulary(known.lexicon, known.pace)), encoding="utf-8")
    shows = [key_postures(form, plan_gesture(form, known), MAX_POSTURES) for form in known.lexicon.forms]
    draw_gesture_sheet(shows, known.robot, DOCS / "pictures" / "gestures.png")
