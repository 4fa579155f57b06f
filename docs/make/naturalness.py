"""Measure the lexicon in every style, write the metrics into docs/benchmarks/naturalness.md and draw them."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE
from kinesic.bench.metric import Metric
from kinesic.bench.naturalness import (
    VARIATION_SEEDS,
    document_metrics,
    draw,
    measured,
    style_metrics,
    varied_metrics,
)
from kinesic.bench.naturalness.bars import METRIC_PREFIX
from kinesic.bench.naturalness.body import BODY_PARTS
from kinesic.bench.naturalness.captured_table import read_captured_table
from kinesic.bench.naturalness.lexicon import MeasuredGesture, group_by_style
from kinesic.bench.naturalness.rows import EFFORT_ROWS, MOTION_ROWS, ROW_PERCENTILES, format_percentiles, values
from kinesic.bench.naturalness.story import STORY_STYLES
from kinesic.body.config import names_of
from kinesic.body.robot import Robot

DOCS = Path(__file__).parents[1]
PAGE = DOCS / "benchmarks/naturalness.md"
BEGIN, END = "<!-- naturalness -->", "<!-- end of naturalness -->"
HEAD = """## How naturally gestures move

`docs/make/naturalness.py` writes this section. `kinesic bench naturalness` measures every gesture alone, from rest to
rest, in every style. The tables have:

1. percentiles 5, 25, 50, 75 and 95 of captured gestures and of the neutral style, and the medians of the other styles;
2. the goals, which hold for the neutral style;
3. medians by category, in the neutral style;
4. the largest rotation of head, trunk and collar bones, by category and in four gestures, with that of people.

Of two hands the one that moves farther counts, in the chest's frame. Speeds are in arm lengths per second, so that
bodies of different size are comparable.

![Percentiles of captured gestures and of every style](../pictures/naturalness.png)

Thin lines go from the 5th to the 95th percentile, broad ones from the 25th to the 75th. The dashed lines are goals.

- **Preparation**, **stroke**, **hold** and **return** go from `start` to `strokeStart`, to `strokeEnd`, to `relax`,
  to `end`.
- **Flow** is the speed at `strokeStart`, as a fraction of the largest before `strokeEnd`: 0 for a hand that stops
  there.
- **Movement units** are peaks of speed of more than a tenth of the largest. Between two units the speed falls below
  half of the lower peak.
- **Spectral arc length** (SPARC, Balasubramanian 2015) is minus the length of the speed's spectrum up to 10 Hz, with
  both axes normalised. It is -1.4 for one smooth reach; each stop and each tremor adds to it.
- **Lead** is the time from the largest speed between `ready` and `strokeEnd` to the stroke.
- A **dynamic** stroke has two keys or more and a path of more than a quarter of an arm length.

| metric | definition |
|---|---|
| `word_lag` | time between a word and the peak speed of the wrist, in either direction (see below) |
| `word_lag_story` | the same in `story.bml`, whose sixteen gestures were not chosen for it, in three styles |
| `nod_lag` | time between the end of the accented syllable and the end of seven nods |
| `alike` | pairs of gestures with different meanings that look the same from the front on a robot without fingers |
| `nearest_pair` | distances of the most similar pairs that are not exempt |
| `misplaced` | gestures whose palm or finger tips are too far from the place of their meaning (see below) |
| `farthest_place` | the largest distances of this kind [mm] |
| `alike_at_head` | pairs of gestures with a place at the head that are nearer than 80 mm |
| `low_shoulders` | shrugs whose collar bones rise by less than 12 degrees |
| `varied.1`, `varied.2` | the same with the default variation, for two seeds |
| `ks_` | Kolmogorov-Smirnov distance to the captured gestures: largest difference of distributions, 0 to 1 |

- **Words and strokes.** `word_lag` is measured in a passage of eleven dynamic gestures with a `stroke` tied to a word.
  The peak is that between `ready` and `strokeEnd`. Hands of people who talk move slightly before the accent (Pouw
  and Dixon). The captured actors are 0.43 s before their own strokes, as an animator marked them. In kinesic a stroke
  tied to a word has its force near the end; a stroke without speech has it at the beginning.
- **Distance of two strokes.** It is that of the elbow, wrist, finger tip, palm or head that differs most, RMS over the
  stroke, each in its own time. Depth counts half. Below 50 mm two strokes are alike. `kinesic/configs/legibility.toml`
  exempts pairs of one meaning, and numbers, which only fingers distinguish.
- **Places** of a meaning are mouth, ear, temple, chest, other wrist and others.
  `kinesic/configs/legibility.toml` has the allowed distances. Hands hover 15 mm before touched places and are
  measured in their middle, so 40 mm is the smallest possible distance of a palm. Throat and cuff are farther, because
  no arm of this build folds so tightly.
- **At the head.** Mouth, nose, chin and eyes are 25 to 60 mm apart, so hands there differ little in any position of
  the elbow. The elbow distinguishes `think` and `phone_call`.

![Distributions of captured gestures and of the neutral style](../pictures/naturalness-distances.png)

The captured gestures are 241 of standing actors who do not talk, at 30 Hz, with sync points set by an animator
(SmartBody). They have limits:

- `ready` and `strokeStart` often lie 67 ms apart, so part of the preparation counts as stroke.
- 60 % of the returns are cut after 0.33 s, so returns count from 0.7 s on.
- Smoothing over five frames takes about 6 % from the peak of a reach of half a second.
- In 30 gestures from a motion capture suit the strokes are as fast (1.88) and the hand flows (0.48). The peak lies in
  the preparation of 93 % there, so it belongs to neither phase in general.

**Missed goals.** `units_per_second` is 1.06 (goal 1.0), because of repeated strokes:

| gestures | median units per second |
|---|---|
| 250 of up to three keys | 1.00 |
| 44 of four to six keys | 1.35 (`knock` 1.79, `beat_double` 1.57, `no_wag` 1.45) |
| beats, which are short | 1.44 |

40 % of gestures have three units: one in the preparation, one in the stroke and one in the return. 31 % have two.
With three units the hand slows below half at `strokeStart`, where hinges turn back. Servos do not limit this: the
desired motion, without any limit, has 1.06. Hands that swing much farther through their keys reach 1.01. Tension,
fluidity and power then stop growing in eight more cases of thirty ([expressivity](../explanation/expressivity.md)).
Idle motion is off in these measurements.

The spectral arc length meets its goal narrowly, in the neutral style alone, on which it was tuned. The peak lies in
the stroke of 16 % of gestures, compared with 74 % of the captured ones and 7 % of those from the suit, because
kinesic's hands start from hanging.

**Costs.** Of Greta's 107 readable documents, 51 are BML; the other 56 are FML. The 51 perform 426 behaviours whole,
31 in part, 4 in another form, and drop 3. Four strokes come more than 0.2 s from their time. Planning them takes 10.9 s
of processor time. Secondary motion (breath, drift, later wrists) adds 15 % to the planning of a passage of 5 s (goal
10), and 7 % to that of a story.

`kinesic/configs/captured_gestures.toml` holds the statistics of the captured gestures. `kinesic bench naturalness
--capture FOLDER` measures any folder of clips in SmartBody's format in the same way (`ACTOR@NAME.skm` with its
skeleton `ACTOR.sk`). `--style calm` measures the lexicon in one style alone.
"""
STORY = """### How a story looks

`story.bml` and `night.bml` were performed as on the command line (seed 0) and inspected at four stills a second.
`night.bml` was not used for tuning.

- **Trunk and head**: the trunk breathes and drifts, and so does the head, which dips on accents. The head dips and
  leans on its way from key to key, and eyes move no later than the head. While a hand waits, the head turns back to
  the listener until the next gesture.
- **Holds**: held hands drift by 3 to 7 mm, with the trunk. Waiting hands do not swing, in any style.
- **Waiting hands**: a hand that waits for its next gesture sinks half of the way to its rest, if there is time. Folded
  hands return together. Arms pass one another before the body, without dropping.
- **Poses** at the head are taken once, also in the joyful style.
- **Two hands** that do not meet differ from mirror images by up to 17 mm. In two-handed strokes of the neutral style
  the left hand comes 30 to 55 ms before or after the right one (`house`, `open`, `fire`, `more`, `full`).
- **Shoulders** move before wrists on the paths to a stroke and back, less in the joyful style, whose shoulders turn at
  their limits.
- **Returns** differ: hands bow aside by 1 to 5 cm, and between gestures they hang 2 to 18 mm from their rest.

These parts still look mechanical:

- In pauses of a second both arms hang straight down and the trunk is upright. The robot does not shift its weight.
- In the calm style one of eight seeds loses `open`.
- The head follows the hands through a long stroke (`fire`, 3.5 s) to its end.
- The left hand stays folded, alone, while the right one counts.
- In three gestures the head does not look at the hands, because the document overrides it axis by axis. Its gaze to
  the left takes head and eyes from `far` and `mountain`. Its nod takes the head's tilt from `full`, where eyes alone
  look down.

The head is turned from the listener for half of the time: it looks at places that hands draw and point at. `still`
means less than 0.1 deg/s of the trunk, 0.5 deg/s of the head or of everything. A hold is 0.4 s or longer, and frozen
below 2 mm.
"""
STORY_ROWS = ("still_trunk", "still_head", "still_all", "frozen_holds", "aside", "missed")
VARIED = tuple(f"varied.{seed}" for seed in VARIATION_SEEDS)
MARKS = {True: "met", False: "missed", None: ""}


def section(gestures: Sequence[MeasuredGesture], metrics: Sequence[Metric]) -> str:
    """Return the text and five tables in Markdown."""
    return "\n".join(
        [
            HEAD,
            *_row_table(gestures),
            "",
            *_bar_table(metrics),
            "",
            *_category_table(metrics),
            "",
            *_body_table(metrics),
            "",
            STORY,
            *_story_table(metrics),
        ]
    )


def _row_table(gestures: Sequence[MeasuredGesture]) -> Iterator[str]:
    styles = {style: [each.hand for each in group if each.hand] for style, group in group_by_style(gestures).items()}
    others = [style for style in styles if style != NEUTRAL_STYLE]
    yield f"| | unit | captured | {' | '.join(styles)} |"
    yield "|---|---|---|" + "---|" * len(styles)
    for name, row in MOTION_ROWS.items():
        people = read_captured_table().percentiles.get(name)
        neutral = format_percentiles(np.percentile(values(name, styles[NEUTRAL_STYLE]), ROW_PERCENTILES).tolist())
        medians = [f"{np.median(values(name, styles[style])):.2f}" for style in others]
        cells = [row.words, row.unit, format_percentiles(people) if people else "", neutral, *medians]
        yield f"| {' | '.join(cells)} |"


def _bar_table(metrics: Sequence[Metric]) -> Iterator[str]:
    yield "| figure | value | goal | | |"
    yield "|---|---|---|---|---|"
    for metric in metrics:
        name = metric.name.removeprefix(f"{METRIC_PREFIX}.")
        if (
            (name.rpartition(".")[0] not in ("", *VARIED))
            or (name in MOTION_ROWS and metric.goal is None)
            or metric.value is None
        ):
            continue
        goal = "" if metric.goal is None else f"{'>=' if metric.better == 'higher' else '<='} {metric.goal:g}"
        note = "" if name in MOTION_ROWS else metric.why
        yield f"| `{metric.name}` | {metric.value:.3g} {metric.unit} | {goal} | {MARKS[metric.ok]} | {note} |"


def _category_table(metrics: Sequence[Metric]) -> Iterator[str]:
    values = {metric.name: metric.value for metric in metrics}
    categories = sorted({name.split(".")[2] for name in values if name.startswith(f"{METRIC_PREFIX}.category.")})
    yield f"| | {' | '.join(MOTION_ROWS[row].words for row in EFFORT_ROWS)} |"
    yield "|---|" + "---|" * len(EFFORT_ROWS)
    for category in categories:
        cells = [f"{values[f'{METRIC_PREFIX}.category.{category}.{row}']:.2f}" for row in EFFORT_ROWS]
        yield f"| {category} | {' | '.join(cells)} |"


def _body_table(metrics: Sequence[Metric]) -> Iterator[str]:
    found = {
        tuple(metric.name.split(".")[2:]): metric
        for metric in metrics
        if metric.name.startswith(f"{METRIC_PREFIX}.body.")
    }
    yield f"| turn at most, median [deg] | {' | '.join(BODY_PARTS)} |"
    yield "|---|" + "---|" * len(BODY_PARTS)
    for group in dict.fromkeys(name for name, _ in found):
        row = [found[group, part] for part in BODY_PARTS]
        cells = [f"{metric.value:.1f}{f' ({metric.why})' if metric.why else ''}" for metric in row]
        yield f"| {group} | {' | '.join(cells)} |"


def _story_table(metrics: Sequence[Metric]) -> Iterator[str]:
    found = {metric.name: metric for metric in metrics if metric.name.startswith(f"{METRIC_PREFIX}.story.")}
    yield f"| `{METRIC_PREFIX}.story.*` | {' | '.join(STORY_STYLES)} | |"
    yield "|---|" + "---|" * (len(STORY_STYLES) + 1)
    for row in STORY_ROWS:
        of = [found[f"{METRIC_PREFIX}.story.{style}.{row}"] for style in STORY_STYLES]
        cells = [f"{metric.value:.2g}" for metric in of]
        yield f"| `{row}` | {' | '.join(cells)} | {of[0].unit} {of[0].why} |"


if __name__ == "__main__":
    styles = names_of("style")
    found = measured(styles)
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    written_section = section(
        found, [*style_metrics(found, Robot.load().arm_length), *document_metrics(), *varied_metrics()]
    )
    PAGE.write_text(f"{before}{BEGIN}\n\n{written_section}\n\n{END}{rest.split(END)[1]}", encoding="utf-8")
    draw(styles, DOCS / "pictures")
