"""Sources of streamed sound."""

from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from kinesic.hearing import microphone
from kinesic.hearing.microphone import Microphone, MicrophoneError, SampleFile, open_source

PortAudioError = type("PortAudioError", (Exception,), {})


class Stream:
    """Fake PortAudio input that counts samples."""

    def __init__(self, **options: object) -> None:
        self.options, self.state = options, "created"
        if options["device"] == "missing":
            raise ValueError("No input device matching 'missing'")
        opened.append(self)

    def start(self) -> None:
        self.state = "started"

    def read(self, count: int) -> tuple[np.ndarray, bool]:
        return np.arange(count, dtype=np.float32)[:, None], False

    def abort(self) -> None:
        self.state = "aborted"

    def close(self) -> None:
        self.state += ", closed"


opened: list[Stream] = []


def import_fake(name: str) -> SimpleNamespace:
    assert name == "sounddevice"
    return SimpleNamespace(InputStream=Stream, PortAudioError=PortAudioError)


def import_nothing(error: Exception):
    def fail(_name: str) -> ModuleType:
        raise error

    return fail


def test_file_of_samples_is_read_in_parts_until_its_end(tmp_path):
    path = tmp_path / "sound.raw"
    path.write_bytes(np.array([0, 16_384, -32_768], "<i2").tobytes() + b"x")
    source = open_source(str(path), 44_100)
    assert source.rate == 16_000
    np.testing.assert_array_equal(source.read(2), [0.0, 0.5])
    np.testing.assert_array_equal(source.read(2), [-1.0])
    assert len(source.read(2)) == 0
    source.close()


def test_missing_file_of_samples_is_an_error_with_its_name(tmp_path):
    with pytest.raises(MicrophoneError, match=r"there is no file or pipe .*absent.raw: make a pipe by `mkfifo"):
        SampleFile(tmp_path / "absent.raw")


@pytest.mark.parametrize(("name", "device"), [("default", None), ("USB", "USB")])
def test_microphone_is_opened_by_its_name_and_read_as_one_channel(name, device, monkeypatch):
    monkeypatch.setattr(microphone.importlib, "import_module", import_fake)
    source = open_source(name, 44_100)
    stream = opened.pop()
    assert isinstance(source, Microphone)
    assert stream.state == "started"
    assert stream.options == {"samplerate": 44_100, "channels": 1, "dtype": "float32", "device": device}
    np.testing.assert_array_equal(source.read(3), [0.0, 1.0, 2.0])
    source.close()
    assert stream.state == "aborted, closed"


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (ImportError("sounddevice"), r"sounddevice is not installed: .*\[hear\]"),
        (OSError("PortAudio library not found"), "PortAudio is not installed: apt-get install libportaudio2"),
    ],
)
def test_error_about_a_missing_library_names_the_command_that_installs_it(error, message, monkeypatch):
    monkeypatch.setattr(microphone.importlib, "import_module", import_nothing(error))
    with pytest.raises(MicrophoneError, match=message):
        Microphone("default", 44_100)


def test_error_about_a_missing_microphone_names_it(monkeypatch):
    monkeypatch.setattr(microphone.importlib, "import_module", import_fake)
    with pytest.raises(MicrophoneError, match="no microphone missing that records 44100 Hz"):
        Microphone("missing", 44_100)
