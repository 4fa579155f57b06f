import subprocess
import sys
from pathlib import Path

import pytest

from kinesic.speech import espeak_pool
from kinesic.speech.espeak_pool import EspeakPaths, SpeechError, synthesise

HELLO = "<speak>Hello, I am <mark name='0'/>here</speak>"
USUAL = {"voice": "gmw/en-US", "words_per_minute": 175, "pitch": 50}


@pytest.fixture
def place(espeak: object) -> EspeakPaths:
    found = espeak_pool.engine()
    assert found is not None
    return found


def test_the_same_text_sounds_the_same_each_time(place: EspeakPaths):
    first = synthesise(HELLO, place, **USUAL)
    synthesise("<speak>something else</speak>", place, **USUAL)
    assert synthesise(HELLO, place, **USUAL) == first
    assert first.samples


def test_a_process_of_its_own_says_it(place: EspeakPaths):
    """The licence of the library stays outside of our process, and so does what it remembers."""
    maps = Path("/proc/self/maps")
    if not maps.exists():
        pytest.skip("this system does not tell which libraries a process has")
    synthesise(HELLO, place, **USUAL)
    assert "espeak" not in maps.read_text()


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"voice": "xx/nobody"}, "no voice xx/nobody"),
        ({"place": EspeakPaths(Path("/no/library.so"), Path("/"))}, "no/library"),
    ],
)
def test_what_fails_says_why(place: EspeakPaths, change: dict[str, object], why: str):
    espeak_pool._dismiss()  # the one that waits knows the right library
    with pytest.raises(SpeechError, match=why):
        synthesise(**({"text": HELLO, "place": place} | USUAL | change))
    espeak_pool._dismiss()
    assert synthesise(HELLO, place, **USUAL).samples


def test_an_engine_that_takes_too_long_is_given_up(place: EspeakPaths, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(espeak_pool, "ENGINE_TIMEOUT", 0.0)
    with pytest.raises(SpeechError, match="longer than 0 s"):
        synthesise(HELLO, place, **USUAL)


def test_the_program_ends_quietly_when_nobody_asks(place: EspeakPaths):
    program = Path(espeak_pool.__file__).with_name("espeak_process.py")
    done = subprocess.run(
        [sys.executable, "-I", "-S", program, place.library, place.data], input=b"", capture_output=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")


def test_without_the_package_the_line_that_installs_it_is_told(monkeypatch: pytest.MonkeyPatch):
    espeak_pool.engine.cache_clear()
    espeak_pool.espeak_fault.cache_clear()
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    try:
        assert espeak_pool.engine() is None
        assert "pip install" in espeak_pool.espeak_fault()
    finally:
        espeak_pool.engine.cache_clear()
        espeak_pool.espeak_fault.cache_clear()
