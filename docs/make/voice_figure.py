"""Draw docs/pictures/voice.png: sound, lips and hand in the example of docs/explanation/voice.md.

.venv/bin/python docs/make/voice_figure.py
"""

import re
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from kinesic import Performer
from kinesic.bench.metric import INK_COLOUR, MAIN_COLOUR, OTHER_COLOUR, SECOND_COLOUR
from kinesic.body.utterance import Mark, Script
from kinesic.expressivity.face.opening import lip_opening
from kinesic.planning.face_track import compute_faces
from kinesic.sim.kinematics import compute_motion_frames
from kinesic.speech.voice import voice

DOCS_FOLDER = Path(__file__).resolve().parent.parent
PAGE = DOCS_FOLDER / "explanation" / "voice.md"
PICTURE_FILE = DOCS_FOLDER / "pictures" / "voice.png"
SAMPLE_PERIOD = 0.005  # [s] time between two points of a curve
LEAD_TIME = 0.45  # [s] length of the time axis before the speech
CLOSED_SOUNDS = frozenset("pbm")  # phonemes for which the lips close

document = re.findall(r"```xml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]
performer = Performer("upper22", voice="hibari", idle=0.0)
plan = performer.plan(document)
spoken = plan.utterances["s"]
assert spoken.sound is not None
times = np.arange(0.0, plan.duration, SAMPLE_PERIOD)
speech_times = times - plan.trajectory.zero - plan.syncs["s:start"].planned
origins = compute_motion_frames(performer.robot.skeleton, plan.trajectory.angles(times)).origins
path = origins[performer.robot.arm("r").wrist].T
velocity = np.linalg.norm(np.gradient(path, SAMPLE_PERIOD, axis=0), axis=1)
openings = [1000.0 * lip_opening(units) for units in compute_faces(plan, times)]

text = re.sub(r"<.*?>", "", re.findall(r"<text>(.*?)</text>", document)[0])
words = list(re.finditer(r"\w+", text))
starts = voice("hibari").say(Script(text, tuple(Mark(str(word.start()), word.start()) for word in words))).marks

figure = Figure(figsize=(8.0, 4.2), layout="constrained", facecolor="white")
sound_axes, lip_axes, hand_axes = figure.subplots(3, 1, sharex=True)
samples = spoken.sound.samples / np.abs(spoken.sound.samples).max()
sound_axes.plot(np.arange(len(samples)) / spoken.sound.rate, samples, color=OTHER_COLOUR, linewidth=0.5)
sound_axes.set(ylabel="sound", yticks=(), ylim=(-1.1, 1.8))
for word in words:
    sound_axes.text(starts[str(word.start())], 1.2, word[0], fontsize=10, color=INK_COLOUR)
lip_axes.plot(speech_times, openings, color=MAIN_COLOUR, linewidth=2.0)
lip_axes.set(ylabel="lip opening\n[mm]", ylim=(0.0, 20.0))
for phoneme in spoken.phonemes:
    if phoneme.letters in CLOSED_SOUNDS:
        onset, release = phoneme.articulation
        lip_axes.axvspan(onset, release, color=SECOND_COLOUR, alpha=0.35, linewidth=0.0)
        lip_axes.text((onset + release) / 2, 16.5, phoneme.letters, fontsize=10, ha="center", color=INK_COLOUR)
hand_axes.plot(speech_times, velocity, color=MAIN_COLOUR, linewidth=2.0)
hand_axes.set(ylabel="hand velocity\n[m/s]", xlabel="time since the speech began [s]", ylim=(0.0, 1.2))
hand_axes.set_xlim(-LEAD_TIME, spoken.duration + 0.05)
hand_axes.text(spoken.marks["m"] + 0.01, 1.02, "stroke", fontsize=10, color=INK_COLOUR)
for axes in (sound_axes, lip_axes, hand_axes):
    axes.axvline(spoken.marks["m"], color=INK_COLOUR, linewidth=1.0, linestyle=":")
    axes.spines[["top", "right"]].set_visible(False)
figure.savefig(PICTURE_FILE, dpi=100)
