"""Program that synthesises one utterance with espeak-ng and exits.

Each utterance gets a new process: espeak-ng repeats itself exactly only if it has not spoken before, and its licence
(GPL) stays outside of kinesic. Only the standard library is imported, so that the process starts quickly.

    python espeak_process.py LIBRARY DATA

Standard input gets JSON with `text` in SSML, `voice`, `words_per_minute` and `pitch`. Standard output returns one line
of JSON (`rate` [Hz], `marks` and `phonemes` as pairs of name and sample), followed by samples of 16 bits. If espeak-ng
fails, the exit code is 3 and standard error has one line.
"""

import ctypes
import json
import os
import sys

AUDIO_OUTPUT_SYNCHRONOUS = 2  # constant of speak_lib.h, like those up to EVENT_PHONEME
INITIALIZE_PHONEME_EVENTS = 0x0001
INITIALIZE_PHONEME_IPA = 0x0002
INITIALIZE_DONT_EXIT = 0x8000
PARAMETER_RATE = 1
PARAMETER_PITCH = 3
POSITION_CHARACTER = 1
CHARS_UTF8 = 0x01
TEXT_SSML = 0x10
EVENT_LIST_TERMINATED = 0
EVENT_MARK = 3
EVENT_PHONEME = 7

BUFFER_LENGTH = 1000  # [ms] duration of speech per callback
MAX_DURATION = 1300  # [s] longest speech, after which synthesis stops
FAILURE_CODE = 3  # exit code of the process after a failed synthesis


class _Id(ctypes.Union):
    """Union in espeak_EVENT: name or phoneme of the event."""

    _fields_ = (("name", ctypes.c_char_p), ("string", ctypes.c_char * 8))


class _Event(ctypes.Structure):
    """The C structure espeak_EVENT."""

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
    """Synthesise the utterance read from standard input and return the exit code.

    The module's docstring describes both formats.
    """
    try:
        engine = ctypes.CDLL(library)
    except OSError as error:
        return _fail(str(error))
    rate: int = engine.espeak_Initialize(
        AUDIO_OUTPUT_SYNCHRONOUS,
        BUFFER_LENGTH,
        data.encode(),
        INITIALIZE_PHONEME_EVENTS | INITIALIZE_PHONEME_IPA | INITIALIZE_DONT_EXIT,
    )
    if rate <= 0:
        return _fail(f"espeak-ng does not start with the data in {data}")
    samples = bytearray()
    marks: list[tuple[str, int]] = []
    phonemes: list[tuple[str, int]] = []

    def collect(wave: "ctypes._Pointer[ctypes.c_short]", count: int, events: "ctypes._Pointer[_Event]") -> int:
        if wave and count > 0:
            samples.extend(ctypes.string_at(wave, 2 * count))
        k = 0
        while events[k].type != EVENT_LIST_TERMINATED:
            event = events[k]
            if event.type == EVENT_MARK:
                marks.append(((event.id.name or b"").decode(), event.sample))
            elif event.type == EVENT_PHONEME:
                phonemes.append((event.id.string.decode("utf-8", "ignore"), event.sample))
            k += 1
        return int(len(samples) > 2 * MAX_DURATION * rate)

    callback = _Callback(collect)  # must outlive the synthesis
    engine.espeak_SetSynthCallback(callback)
    request = json.loads(sys.stdin.buffer.read() or b"null")
    if request is None:  # the parent closed the pipe without a request
        return 0
    if engine.espeak_SetVoiceByName(request["voice"].encode()) != 0:
        return _fail(f"espeak-ng has no voice {request['voice']}")
    engine.espeak_SetParameter(PARAMETER_RATE, request["words_per_minute"], 0)
    engine.espeak_SetParameter(PARAMETER_PITCH, request["pitch"], 0)
    text = request["text"].encode()
    failure = engine.espeak_Synth(
        text, ctypes.c_size_t(len(text) + 1), 0, POSITION_CHARACTER, 0, CHARS_UTF8 | TEXT_SSML, None, None
    )
    if failure:
        return _fail(f"espeak-ng cannot speak the text (error {failure})")
    header = json.dumps({"rate": rate, "marks": marks, "phonemes": phonemes})
    sys.stdout.buffer.write(header.encode() + b"\n" + samples)
    sys.stdout.flush()
    os._exit(0)  # skips the slow clean-up


def _fail(why: str) -> int:
    sys.stderr.write(f"{why}\n")
    return FAILURE_CODE


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
