"""Synthesises one utterance with espeak-ng in a process of its own, and exits.

It runs in a process of its own, for each utterance anew: espeak-ng repeats itself exactly only as long as it has not
spoken before, and its licence (GPL) stays outside. Nothing but the standard library is imported, so that it starts at
once.

    python espeak_process.py LIBRARY DATA

Standard input says, in JSON: `text` in SSML, `voice`, `words_per_minute` and `pitch`. Standard output gets one line of
JSON (`rate` [Hz], `marks` and `phonemes` as pairs of name and sample) and then the samples, 16 bits each. It ends with
code 3, and one line on standard error, where espeak-ng cannot do it.
"""

import ctypes
import json
import os
import sys

SYNCHRONOUS = 2  # names and numbers of speak_lib.h
PHONEME_EVENTS, PHONEME_IPA, DONT_EXIT = 0x0001, 0x0002, 0x8000
RATE, PITCH = 1, 3
CHARACTERS = 1
UTF8, SSML = 0x01, 0x10
END_OF_LIST, MARK, PHONEME = 0, 3, 7

BUFFER = 1000  # [ms] of speech at a time
LONGEST = 1300  # [s] after which nobody listens any more
FAILED = 3


class _Id(ctypes.Union):
    """The name or the phoneme that an event of espeak-ng carries."""

    _fields_ = (("name", ctypes.c_char_p), ("string", ctypes.c_char * 8))


class _Event(ctypes.Structure):
    """espeak_EVENT."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("message", ctypes.c_uint),
        ("text_position", ctypes.c_int),
        ("length", ctypes.c_int),
        ("audio_position", ctypes.c_int),
        ("sample", ctypes.c_int),
        ("user_data", ctypes.c_void_p),
        ("id", _Id),
    )


_Callback = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.POINTER(_Event), use_errno=False
)


def main(library: str, data: str) -> int:
    """Synthesises the utterance on standard input; the module's docstring describes both formats."""
    try:
        engine = ctypes.CDLL(library)
    except OSError as error:
        return _failed(str(error))
    rate: int = engine.espeak_Initialize(SYNCHRONOUS, BUFFER, data.encode(), PHONEME_EVENTS | PHONEME_IPA | DONT_EXIT)
    if rate <= 0:
        return _failed(f"espeak-ng does not start with the data in {data}")
    samples = bytearray()
    marks: list[tuple[str, int]] = []
    phonemes: list[tuple[str, int]] = []

    def collect(wave: "ctypes._Pointer[ctypes.c_short]", count: int, events: "ctypes._Pointer[_Event]") -> int:
        if wave and count > 0:
            samples.extend(ctypes.string_at(wave, 2 * count))
        k = 0
        while events[k].type != END_OF_LIST:
            event = events[k]
            if event.type == MARK:
                marks.append(((event.id.name or b"").decode(), event.sample))
            elif event.type == PHONEME:
                phonemes.append((event.id.string.decode("utf-8", "ignore"), event.sample))
            k += 1
        return int(len(samples) > 2 * LONGEST * rate)

    callback = _Callback(collect)  # must outlive the synthesis
    engine.espeak_SetSynthCallback(callback)
    request = json.loads(sys.stdin.buffer.read() or b"null")
    if request is None:  # nobody has anything to say
        return 0
    if engine.espeak_SetVoiceByName(request["voice"].encode()) != 0:
        return _failed(f"espeak-ng has no voice {request['voice']}")
    engine.espeak_SetParameter(RATE, request["words_per_minute"], 0)
    engine.espeak_SetParameter(PITCH, request["pitch"], 0)
    text = request["text"].encode()
    failure = engine.espeak_Synth(text, ctypes.c_size_t(len(text) + 1), 0, CHARACTERS, 0, UTF8 | SSML, None, None)
    if failure:
        return _failed(f"espeak-ng does not say it (error {failure})")
    header = json.dumps({"rate": rate, "marks": marks, "phonemes": phonemes})
    sys.stdout.buffer.write(header.encode() + b"\n" + samples)
    sys.stdout.flush()
    os._exit(0)  # nobody waits until everything is put away


def _failed(why: str) -> int:
    sys.stderr.write(f"{why}\n")
    return FAILED


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
