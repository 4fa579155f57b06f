"""Draw docs/pictures/text_timeline.png: when the example of docs/explanation/text-to-gestures.md speaks and moves.

.venv/bin/python docs/make/text_timeline.py
"""

import re
import subprocess
from collections.abc import Mapping
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

import kinesic

PICTURE = Path(__file__).parents[1] / "pictures" / "text_timeline.png"
TEXT = "No, I did not say that! There were three big boxes."
ROWS = {
    "s": "speech",
    "h": "head",
    "g": "hand",
    "f": "face",
    "l": "gaze",
}  # row title by first letter of an id
PALE_COLOUR = "#c9d8e6"
STRONG_COLOUR = "#35648f"
WORD_COLOUR = "#c0561f"
BAR_HEIGHT = 0.3  # [rows] height of a behaviour's bar
STAGGER = 0.17  # [rows] alternating vertical shift of successive bars in a row
LABEL_SIZE = 8.5  # [pt] font size of the labels
LABEL_GAP = 0.03  # [s] distance between a bar and its label


def plan_times(document: str) -> Mapping[tuple[str, str], float]:
    """Return the planned time [s] of each behaviour's sync points."""
    plan = kinesic.Performer("upper36", voice="durations").plan(document)
    return {(sync.behaviour, sync.sync): sync.planned for sync in plan.syncs}


def draw_words(axes: Axes, document: str, times: Mapping[tuple[str, str], float], row: int) -> None:
    """Write the words of the speech at their times."""
    (text,) = re.findall(r"<text>(.*?)</text>", document, re.DOTALL)
    parts = re.split(r'<sync id="(\w+)"/>', " ".join(text.split()))
    for name, words in zip(parts[1::2], parts[2::2], strict=True):
        axes.text(times["s", name], row, words.strip(), fontsize=LABEL_SIZE, color=WORD_COLOUR, va="center")


def draw_behaviour(axes: Axes, name: str, label: str, times: Mapping[tuple[str, str], float], row: float) -> None:
    """Draw a behaviour as a bar, with stroke phase and stroke time."""
    start, end = times[name, "start"], times[name, "end"]
    axes.barh(row, end - start, BAR_HEIGHT, start, color=PALE_COLOUR)
    begin = next(times[name, sync] for sync in ("strokeStart", "attackPeak", "ready") if (name, sync) in times)
    finish = next(times[name, sync] for sync in ("strokeEnd", "relax") if (name, sync) in times)
    axes.barh(row, finish - begin, BAR_HEIGHT, begin, color=STRONG_COLOUR)
    if (name, "stroke") in times:
        axes.plot(times[name, "stroke"], row, "o", color=WORD_COLOUR, ms=5)
    axes.text(end + LABEL_GAP, row, label, fontsize=LABEL_SIZE, color="#222222", va="center")


def draw(document: str) -> Figure:
    """Draw the timeline with one row per channel."""
    times = plan_times(document)
    figure = Figure(figsize=(8.6, 3.7), dpi=100, facecolor="white")
    axes = figure.add_axes((0.08, 0.13, 0.91, 0.86))
    rows = {letter: -k for k, letter in enumerate(ROWS)}
    draw_words(axes, document, times, rows["s"])
    for name, attributes in re.findall(r'<(?:gesture|head|faceLexeme|gaze) id="(\w+)" (.*?)/>', document):
        (label, *_) = re.findall(r'(?:lexeme|offsetDirection|target)="(\w+)"', attributes)
        draw_behaviour(axes, name, label, times, rows[name[0]] - STAGGER * (-1) ** int(name[1:]))
    axes.set_yticks(list(rows.values()), list(ROWS.values()))
    axes.set_ylim(-len(ROWS) + 0.6, 0.6)
    axes.set_xlim(-0.1, max(times.values()) + 0.8)
    axes.set_xlabel("time from the first motion [s]")
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="x", lw=0.4, color="#dddddd")
    axes.set_axisbelow(True)
    return figure


if __name__ == "__main__":
    words = ["kinesic", "say", TEXT, "--to", "bml"]
    document = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    draw(document).savefig(PICTURE)
