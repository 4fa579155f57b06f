"""Measures the lexicon in every style, writes the figures into docs/gestures.md and draws them beside it."""

from collections.abc import Iterator, Sequence

import numpy as np
from gestures import BEGIN, DOCS, END, PAGE

from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE
from kinesic.bench.figure import Figure
from kinesic.bench.naturalness import PART, SEEDS, document_figures, draw, lexicon_figures, measured, varied_figures
from kinesic.bench.naturalness.body import PARTS
from kinesic.bench.naturalness.captured_table import captured_table
from kinesic.bench.naturalness.lexicon import MeasuredGesture, by_style
from kinesic.bench.naturalness.rows import EFFORT, PERCENTILES, ROWS, values, written
from kinesic.bench.naturalness.story import STYLES
from kinesic.body.config import names_of
from kinesic.body.robot import Robot

HEAD = """## How naturally they move

Written by `docs/make/naturalness.py`. Every gesture is measured alone, from rest to rest, in every style, as `kinesic
bench naturalness` does it. The first table has percentiles 5, 25, 50, 75 and 95 of captured gestures and of the
neutral style, and the medians of the other styles; the second one the goals, which hold for the neutral style; the
third one medians by category, in the neutral style; the fourth one how far head, trunk and collar bones turn at most,
by category and in four gestures, beside what accompanies the hands of people. Of two hands the one that goes farther
counts, as the chest carries it; speeds are in arm lengths per second, so that bodies of different size compare.

![Percentiles of captured gestures and of every style](naturalness.png)

Thin lines go from the 5th to the 95th percentile, broad ones from the 25th to the 75th; the dashed lines are goals.

- **Preparation**, **stroke**, **hold** and **return** go from `start` to `strokeStart`, to `strokeEnd`, to `relax`,
  to `end`.
- **Flow** is the speed at `strokeStart`, as a share of the largest before `strokeEnd`: 0 for a hand that stops there.
- **Movement units** are peaks of speed of more than a tenth of the largest, between which it falls below half of the
  lower one.
- **Spectral arc length** (SPARC, Balasubramanian 2015) is minus the length of the speed's spectrum up to 10 Hz, both
  axes normalised: -1.4 for one smooth reach; each stop and each tremor adds to it.
- **Lead**: from the largest speed between `ready` and `strokeEnd` to the stroke.
- **`word_lag`**: how far from its word a wrist is fastest between `ready` and `strokeEnd`, either way, in a passage of
  eleven dynamic gestures whose `stroke` is tied to a word; `word_lag_story`: in `story.bml`, whose sixteen gestures
  nobody chose for it, in three styles; `nod_lag`: how far from the accented syllable's end seven nods end. Hands of
  people who talk lead the accent by a little (Pouw and Dixon); the captured actors lead their own strokes by 0.43 s,
  as an animator marked them. Ours put their force near the end of a stroke that meets a word, and at its beginning
  where nobody talks.
- **`alike`**: pairs of gestures with different meanings that cannot be told apart from the front by a robot without
  fingers. Two strokes, each in its own time, are as far apart as the elbow, wrist, finger tip, palm or head that
  differs most, RMS over the stroke, with depth counting half; below 50 mm they are alike. Pairs of one meaning, and
  numbers, which fingers alone tell apart, are exempt by name (`kinesic/configs/legibility.toml`); `nearest_pair` has
  the others.
- **`misplaced`**: gestures whose palm or finger tips are farther from the place that their meaning needs (mouth, ear,
  temple, chest, other wrist ...) than that file allows; `farthest_place` has the largest distances [mm]. Hands hover
  15 mm before what they touch, and are measured in their middle: 40 mm is as near as a palm comes. The throat and the
  own cuff are farther: no arm of this build folds so tightly.
- **`alike_at_head`**: pairs of gestures with a place at the head that are nearer than 80 mm: mouth, nose, chin and eyes
  are 25 to 60 mm apart, so that hands there differ little, whatever the elbows do; `think` and `phone_call` are told
  apart by the elbow. **`low_shoulders`**: shrugs whose collar bones rise by less than 12 degrees.
- **`varied.1`, `varied.2`**: the same as gestures vary by default, for two seeds.
- A **dynamic** stroke has two keys or more and a path of more than a quarter of an arm length.
- **`ks_`** is the Kolmogorov-Smirnov distance to the captured gestures: the largest difference between two shares of
  gestures up to a value, 0 to 1.

![Distributions of captured gestures and of the neutral style](naturalness-distances.png)

The captured gestures are 241 of standing actors who do not talk, at 30 Hz, with sync points that an animator set
(SmartBody). Read them with care: `ready` and `strokeStart` often lie 67 ms apart, so that part of the preparation
counts as stroke; 60 % of the returns are cut after 0.33 s, which is why returns count from 0.7 s on; and smoothing
over five frames takes some 6 % from the peak of a reach of half a second. In 30 gestures from a motion capture suit
the strokes are as fast (1.88) and the hand flows (0.48), but the peak lies in the preparation of 93 %: it belongs to
neither phase by law.

**What was alike.** `me_low` and `tiny_low` were 40 mm apart, `beat_purse` and `beckon_finger` 48; now the low hand of
`me_low` comes before the chest, a pinch is shown farther out, and the purse bounces with its finger tips up. `piano`
bounces higher than `flat_surface` slides, `high_five` is above the head, and the hand of `listen` comes from farther
out, as they and `flat_surface`, `victory` and `phone_call` were 51 to 53 mm apart.

**What is missed.** `units_per_second` is 1.06 (goal 1.0). It is repeated strokes that tip the median: the 250 gestures
of up to three keys have 1.00, the 44 of four to six 1.35 (`knock` 1.79, `beat_double` 1.57, `no_wag` 1.45), and beats
1.44, as they are short. 40 % of gestures have three units, one on the way there, one in the stroke and one on the way
home, where 31 % have two: their hand slows below half at `strokeStart`, as hinges turn back there. Servos do not bind:
the desired motion, of which no limit is asked, has 1.06. Hands that swing much farther through their keys come to 1.01,
but then tension, fluidity and power no longer grow in eight more cases of thirty ([expressivity.md](expressivity.md)).
What goes on beneath gestures does not count here: nothing idles in these figures. The spectral arc length is met by a
hair, and in the neutral style alone, on which it was tuned; the other styles stand in the table. The peak lies in the
stroke of 16 % of gestures, in 74 % of the captured ones and 7 % of those from the suit: our hands come all the way from
hanging.

**What it costs.** Of Greta's 107 documents that can be read, 51 perform the same behaviours as before there was any
effort by phase: 426 whole, 31 in part, 4 in another form, 3 dropped, then and now. Strokes that come more than 0.2 s
beside their time are 4 (6), and planning them takes 10.9 s of processor time (36.4 s; at the median 0.37 of what it
was, at worst 1.26, of 3 ms), much of it the planner's own progress. The other 56 are FML, of which speech alone was
performed then. What is laid on (breath, drift, wrists that are late) takes 15 % of the rest of the planning of a
passage of 5 s (goal 10; 21 before its steps were fewer), and 7 % of a story's.

`kinesic/configs/captured_gestures.toml` holds these statistics. `kinesic bench naturalness --capture FOLDER` measures
any folder of clips in SmartBody's format in the same way (`ACTOR@NAME.skm` with its skeleton `ACTOR.sk`) beside them;
`--style calm` measures the lexicon in one style alone.
"""
STORY = """### How a story looks

`story.bml`, told as the command line tells it (seed 0) and looked at four stills a second. What looked mechanical, and
what became of it:

- **The trunk was dead**: in the neutral style it stood still for two thirds of the speech, for 13 s at once, and with
  it everything for 1.3 s where a hand waited. Now it breathes and strays, and so does the head, which dips on accents.
- **Holds were frozen**: all six moved by less than 0.2 mm. Now hands stray by 3 to 7 mm, with their trunk.
- **Arms dropped on their way**: between `full` and `i` both fell most of the way to hanging and rose again, within
  0.3 s, as a detour around one another. Now they pass before the body. In the calm style they dropped by 20 cm still,
  as the left hand went home to be folded, alone, where the right one passed: now it waits and goes home with it.
- **Loose hands swung where they waited**: in the calm style by 20 to 80 mm, in holds beneath which the trunk turned,
  and into the chest. Now they stop there. Planning the calm story takes less than half of the time, as nothing has to
  be led around the body, and none of eight seeds loses `i` (one in eight did).
- **An arm stayed up for nothing**: in `night.bml`, of which nothing was tuned, the left one stood out to the side for a
  second after a shrug, while the right one gave something. A hand that waits for its next gesture now sinks half of the
  way to its rest, where there is time for it.
- **Poses were done twice**: in the joyful `night.bml` the hand went to the ear, aside and to the ear again, for one
  "listened", and both hands twice to the cheek. A hand that comes to the head to stay does so once.
- **An arm turned over**: the left one in the joyful `house`, by 150 degrees, so that the stroke came 0.38 s late.
- **A stroke ran over the next word**: the joyful `fire` rose twice, and hands that should fold at `waited` did not.
- **The head stayed on a hand that waited**, for up to 5 s. Now it turns back to the listener until the next gesture.
- **Two hands were exact mirror images.** Where they do not meet, the left one is now up to 17 mm beside that.
- **Everything arrived at once**: in the two-handed strokes of the neutral style the left hand came within 15 ms of the
  right one; now it is 30 to 55 ms sooner or later in `house`, `open`, `fire`, `more` and `full`. Shoulders lead on the
  ways there and back, and wrists follow. The joyful style keeps less of it, as its shoulders turn at their limits.
- **Ways home were all of one form**, and hands came to rest in one place. Now hands bow aside on their way, by 1 to
  5 cm, and between gestures they hang 2 to 18 mm beside their rest.
- **The head went straight from key to key.** Now it dips and leans on its way, and eyes leave no later than it does.

What still looks mechanical: in pauses of a second both arms hang straight down, as at attention, and the trunk is
upright; nobody shifts weight. In the calm style one of eight seeds loses `open`; the head follows the hands through a
long stroke (`fire`, 3.5 s) to its end; the left hand stays folded, alone, while the right one counts. In three gestures
the head does not look at the hands, as the document has it: its gaze to the left takes head and eyes from `far` and
`mountain`; its nod takes the head's tilt from `full`, where eyes alone look down. What a document asks comes first,
axis by axis.

The head is off the listener for half of the time: it looks at what hands draw and point at. `still` is less
than 0.1 deg/s of the trunk, 0.5 deg/s of the head or of everything; a hold is 0.4 s or longer, frozen below 2 mm.
"""
STORY_BEFORE = {  # measured in the same way before the body lived beneath its gestures
    "still_trunk": (0.64, 0.39, 0.03),
    "still_head": (0.36, 0.31, 0.06),
    "still_all": (1.26, 0.0, 0.0),
    "frozen_holds": (6, 0, 0),
    "aside": (0.59, 0.59, 0.56),
    "missed": (0, 0, 1),
}
VARIED = tuple(f"varied.{seed}" for seed in SEEDS)
MARKS = {True: "met", False: "missed", None: ""}


def section(gestures: Sequence[MeasuredGesture], figures: Sequence[Figure]) -> str:
    """Words and five tables, in Markdown."""
    return "\n".join(
        [
            HEAD,
            *_row_table(gestures),
            "",
            *_bar_table(figures),
            "",
            *_category_table(figures),
            "",
            *_body_table(figures),
            "",
            STORY,
            *_story_table(figures),
        ]
    )


def _row_table(gestures: Sequence[MeasuredGesture]) -> Iterator[str]:
    styles = {style: [each.hand for each in group if each.hand] for style, group in by_style(gestures).items()}
    others = [style for style in styles if style != NEUTRAL_STYLE]
    yield f"| | unit | captured | {' | '.join(styles)} |"
    yield "|---|---|---|" + "---|" * len(styles)
    for name, row in ROWS.items():
        people = captured_table().percentiles.get(name)
        neutral = written(np.percentile(values(name, styles[NEUTRAL_STYLE]), PERCENTILES).tolist())
        medians = [f"{np.median(values(name, styles[style])):.2f}" for style in others]
        cells = [row.words, row.unit, written(people) if people else "", neutral, *medians]
        yield f"| {' | '.join(cells)} |"


def _bar_table(figures: Sequence[Figure]) -> Iterator[str]:
    yield "| figure | value | goal | | |"
    yield "|---|---|---|---|---|"
    for figure in figures:
        name = figure.name.removeprefix(f"{PART}.")
        if (
            (name.rpartition(".")[0] not in ("", *VARIED))
            or (name in ROWS and figure.goal is None)
            or figure.value is None
        ):
            continue
        goal = "" if figure.goal is None else f"{'>=' if figure.better == 'higher' else '<='} {figure.goal:g}"
        note = "" if name in ROWS else figure.why
        yield f"| `{figure.name}` | {figure.value:.3g} {figure.unit} | {goal} | {MARKS[figure.ok]} | {note} |"


def _category_table(figures: Sequence[Figure]) -> Iterator[str]:
    values = {figure.name: figure.value for figure in figures}
    categories = sorted({name.split(".")[2] for name in values if name.startswith(f"{PART}.category.")})
    yield f"| | {' | '.join(ROWS[row].words for row in EFFORT)} |"
    yield "|---|" + "---|" * len(EFFORT)
    for category in categories:
        cells = [f"{values[f'{PART}.category.{category}.{row}']:.2f}" for row in EFFORT]
        yield f"| {category} | {' | '.join(cells)} |"


def _body_table(figures: Sequence[Figure]) -> Iterator[str]:
    found = {tuple(figure.name.split(".")[2:]): figure for figure in figures if figure.name.startswith(f"{PART}.body.")}
    yield f"| turn at most, median [deg] | {' | '.join(PARTS)} |"
    yield "|---|" + "---|" * len(PARTS)
    for group in dict.fromkeys(name for name, _ in found):
        figure_of = [found[group, part] for part in PARTS]
        cells = [f"{figure.value:.1f}{f' ({figure.why})' if figure.why else ''}" for figure in figure_of]
        yield f"| {group} | {' | '.join(cells)} |"


def _story_table(figures: Sequence[Figure]) -> Iterator[str]:
    found = {figure.name: figure for figure in figures if figure.name.startswith(f"{PART}.story.")}
    yield f"| `{PART}.story.*`, before and after | {' | '.join(STYLES)} | |"
    yield "|---|" + "---|" * (len(STYLES) + 1)
    for row, before in STORY_BEFORE.items():
        of = [found[f"{PART}.story.{style}.{row}"] for style in STYLES]
        cells = [f"{was:g} -> {figure.value:.2g}" for was, figure in zip(before, of, strict=True)]
        yield f"| `{row}` | {' | '.join(cells)} | {of[0].unit} {of[0].why} |"


if __name__ == "__main__":
    styles = names_of("style")
    found = measured(styles)
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    written_section = section(
        found, [*lexicon_figures(found, Robot.load().arm_length), *document_figures(), *varied_figures()]
    )
    PAGE.write_text(f"{before}{BEGIN}\n\n{written_section}\n\n{END}{rest.split(END)[1]}", encoding="utf-8")
    draw(styles, DOCS)
