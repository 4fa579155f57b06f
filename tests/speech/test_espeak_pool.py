import subprocess
import sys
from pathlib import Path

import pytest

from kinesic.speech import espeak_pool
from kinesic.speech.espeak_pool import EspeakPaths, SpeechError, synthesise

HELLO_SSML = "<speak>Hello, I am <mark name='0'/>here</speak>"  # text with a mark before its last word
VOICE_SETTINGS = {"voice": "gmw/en-US", "words_per_minute": 175, "pitch": 50}


@pytest.fixture
def place(espeak: object) -> EspeakPaths:
    paths = espeak_pool.find_engine()
    assert paths is not None
    return paths


def test_same_text_gives_the_same_speech_samples(place: EspeakPaths):
    first = synthesise(HELLO_SSML, place, **VOICE_SETTINGS)
    synthesise("<speak>something else</speak>", place, **VOICE_SETTINGS)
    assert synthesise(HELLO_SSML, place, **VOICE_SETTINGS) == first
    assert first.samples


def test_synthesis_runs_in_its_own_process(place: EspeakPaths):
    """Check that the library is not loaded into the test process."""
    maps = Path("/proc/self/maps")
    if not maps.exists():
        pytest.skip("this system does not list the libraries of a process")
    synthesise(HELLO_SSML, place, **VOICE_SETTINGS)
    assert "espeak" not in maps.read_text()


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"voice": "xx/nobody"}, "no voice xx/nobody"),
        ({"place": EspeakPaths(Path("/no/library.so"), Path("/"))}, "no/library"),
    ],
)
def test_synthesis_failure_is_reported_with_its_reason(place: EspeakPaths, change: dict[str, object], why: str):
    espeak_pool._dismiss()  # the waiting process has the right library
    with pytest.raises(SpeechError, match=why):
        synthesise(**({"text": HELLO_SSML, "place": place} | VOICE_SETTINGS | change))
    espeak_pool._dismiss()
    assert synthesise(HELLO_SSML, place, **VOICE_SETTINGS).samples


def test_speech_engine_beyond_its_time_limit_raises_an_error(place: EspeakPaths, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(espeak_pool, "ENGINE_TIMEOUT", 0.0)
    with pytest.raises(SpeechError, match="longer than 0 s"):
        synthesise(HELLO_SSML, place, **VOICE_SETTINGS)


def test_speech_engine_program_ends_silently_without_a_request(place: EspeakPaths):
    program = Path(espeak_pool.__file__).with_name("espeak_process.py")
    process = subprocess.run(
        [sys.executable, "-I", "-S", program, place.library, place.data], input=b"", capture_output=True, check=False
    )
    assert (process.returncode, process.stdout, process.stderr) == (0, b"", b"")


def test_missing_espeak_package_gives_the_install_command(monkeypatch: pytest.MonkeyPatch):
    espeak_pool.find_engine.cache_clear()
    espeak_pool.espeak_fault.cache_clear()
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    try:
        assert espeak_pool.find_engine() is None
        assert "pip install" in espeak_pool.espeak_fault()
    finally:
        espeak_pool.find_engine.cache_clear()
        espeak_pool.espeak_fault.cache_clear()
