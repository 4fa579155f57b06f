"""Speech program whose words are tones: `tone_program.py [FAULT]`."""

import json
import struct
import sys
import time

SAMPLE_RATE = 8000  # [Hz] sample rate of the tones
WORD_SAMPLES = 2400  # number of samples of a word at rate 1


def answer(phrase: dict, fault: str) -> bytes:
    """Return the answer to a phrase."""
    words, position = [], 0
    size = round(WORD_SAMPLES / phrase["rate"])
    for number, word in enumerate(phrase["text"].split()):
        begin = phrase["text"].index(word, position)
        position = begin + len(word)
        start = number * size / SAMPLE_RATE
        words.append({"begin": begin, "end": position, "start": start, "stop": start + size / SAMPLE_RATE})
    sound = struct.pack("<2h", 12000, -12000) * (size * len(words) // 2)
    header = {"rate": SAMPLE_RATE, "bytes": len(sound), "words": words, "later_key": 1}
    if fault == "phonemes":
        header["phonemes"] = [{"symbol": "b", "start": 0.1, "end": 0.3, "onset": 0.04, "release": 0.1}]
    header |= {
        "error": {"error": "no such voice", "bytes": 0},
        "unreadable": {"unreadable": True, "error": "not a word", "bytes": 0},
        "odd": {"bytes": 3},
        "long": {"bytes": 10**12},
        "rate": {"rate": 0},
        "short": {"bytes": len(sound) + 2},
        "wav": {"format": "wav", "bytes": len(sound) + 44},
        "broken_wav": {"format": "wav"},
    }.get(fault, {})
    if fault == "wav":
        sizes = (
            struct.pack("<I", 36 + len(sound)),
            struct.pack("<IHHIIHH", 16, 1, 1, SAMPLE_RATE, 2 * SAMPLE_RATE, 2, 16),
        )
        sound = b"RIFF" + sizes[0] + b"WAVEfmt " + sizes[1] + b"data" + struct.pack("<I", len(sound)) + sound
    line = b"{nonsense" if fault == "json" else json.dumps(header).encode()
    return line + b"\n" + sound[: header["bytes"]]


def main(fault: str = "") -> None:
    """Answer phrases until standard input ends."""
    for line in sys.stdin.buffer:
        if fault == "ends":
            sys.exit("model not found")
        if fault == "hangs":
            time.sleep(60)
        sys.stdout.buffer.write(answer(json.loads(line), fault))
        sys.stdout.buffer.flush()
        if fault == "short":
            return


main(*sys.argv[1:])
