"""Speech program for `kinesic --engine`: a voice of Piper, with the times of its phonemes.

Run it in an environment of its own, because Piper is under the GPL: `pip install piper-tts onnx`, and
`kinesic say TEXT --engine "PYTHON examples/voices/piper_voice.py VOICE.onnx"`. The file VOICE.onnx.json lies beside it.
"""

import json
import re
import sys
from pathlib import Path

from piper import PiperVoice
from piper.config import SynthesisConfig

MODIFIERS = "\u02d0\u02d1\u02b0\u02b2\u0303\u0329\u032f"  # symbols that change the sound before them
STOPS = "pbtdkg\u0261"
CLOSURE_TIME = 0.06  # [s] duration of the closed lips or tongue before a plosive
STRESS_MARKS = "\u02c8\u02cc"  # symbols that belong to the vowel after them


def answer(voice: PiperVoice, phrase: dict) -> tuple[dict, bytes]:
    """Speak a phrase and return the header and the samples."""
    settings = SynthesisConfig(length_scale=1.0 / phrase["rate"], noise_w_scale=0.0)
    phonemes, groups, samples, stress = [], [[]], b"", ""
    for chunk in voice.synthesize(phrase["text"], settings, include_alignments=True):
        now = len(samples) / 2 / chunk.sample_rate
        for alignment in chunk.phoneme_alignments or ():
            letter, start, now = alignment.phoneme, now, now + int(alignment.num_samples) / chunk.sample_rate
            if letter in STRESS_MARKS:
                stress, start_of_stress = letter, start
            elif letter in MODIFIERS and groups[-1]:
                groups[-1][-1]["end"] = now
            elif letter.isalpha():
                phonemes.append({"symbol": stress + letter, "start": start_of_stress if stress else start, "end": now})
                groups[-1].append(phonemes[-1])
                stress = ""
            elif letter == " " and groups[-1]:
                groups.append([])
        groups.append([])
        samples += chunk.audio_int16_bytes
    spans = [match.span() for match in re.finditer(r"\w[\w'\u2019]*", phrase["text"])]
    spoken = [group for group in groups if group]
    words = []
    if len(spans) == len(spoken):  # else espeak has joined or divided words, and kinesic estimates their times
        for (begin, end), group in zip(spans, spoken, strict=True):
            words.append({"begin": begin, "end": end, "start": group[0]["start"], "stop": group[-1]["end"]})
    for phoneme in phonemes:
        if phoneme["symbol"] in STOPS:  # a stop of Piper starts with its burst, after the closure
            phoneme |= {"onset": phoneme["start"] - CLOSURE_TIME, "release": phoneme["start"]}
    rate = voice.config.sample_rate
    return {
        "rate": rate,
        "bytes": len(samples),
        "words": words,
        "phonemes": phonemes,
        "unreadable": not phonemes,
    }, samples


def main(model: str) -> None:
    """Answer phrases until standard input ends."""
    voice = PiperVoice.load(Path(model), include_alignments=True)
    for line in sys.stdin.buffer:
        header, samples = answer(voice, json.loads(line))
        sys.stdout.buffer.write(json.dumps(header).encode() + b"\n" + samples)
        sys.stdout.buffer.flush()


if __name__ == "__main__":
    main(sys.argv[1])
