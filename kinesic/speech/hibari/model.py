"""Acoustic model of hibari-tts: phoneme letters in, samples, durations and pitch out.

The package's own class is not used: it can download other voices. Only its files and its signal processing are.
"""

import importlib
import importlib.util
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kinesic.body.utterance import Samples
from kinesic.extras import install_extra
from kinesic.speech.engines.phrase import EngineError
from kinesic.speech.hibari.graph import PITCH_INPUT, PITCH_OUTPUT, SPEED_INPUT, edit_graph
from kinesic.speech.hibari.protobuf import ProtobufError

PACKAGE_NAME = "hibari"  # import name of hibari-tts
RUNTIME_NAME = "onnxruntime"  # import name of the package that runs the model
ASSET_NAMES = ("hibari.onnx", "vocab.json")  # files of the model: the graph, and the ids of its letters
SAMPLE_RATE = 24_000  # [Hz] sample rate of the voice
FRAME_SAMPLES = 300  # samples per frame (12.5 ms)
FRAMES_PER_UNIT = 2  # frames per unit in which the model predicts durations
FRAME_DURATION = FRAME_SAMPLES / SAMPLE_RATE  # [s] duration of a frame
UNIT_DURATION = FRAMES_PER_UNIT * FRAME_DURATION  # [s] unit in which the model predicts durations
MIN_SPEED = 0.5  # smallest factor on the speech rate that the model supports
MAX_SPEED = 2.0  # largest factor on the speech rate that the model supports
NOISE_SEED = 0  # seed of the noise in fricatives, the same for every phrase
PAD_ID = 0  # letter id that the model expects at both ends of a phrase
SPECTRAL_OUTPUTS = ("lh", "theta", "ln", "lr", "phi")  # names of the model's spectral outputs, in the synthesis's order

Floats32 = NDArray[np.float32]
_Array = NDArray[np.generic]


class _Session(Protocol):
    """ONNX model ready to run."""

    def run(self, names: list[str], inputs: Mapping[str, _Array], /) -> list[_Array]: ...


class _Synthesis(Protocol):
    """Signal processing of hibari: spectrum and pitch to samples."""

    def __call__(self, *outputs: _Array | np.random.Generator) -> Samples: ...


@dataclass(frozen=True, eq=False)
class Prediction:
    """Sound of a phrase with letter durations and pitch."""

    samples: Samples  # (m,) -1..1 at `SAMPLE_RATE`
    durations: NDArray[np.int64]  # (letters + 2,) in units of `UNIT_DURATION`, with the silence at both ends
    pitch: Floats32  # (frames,) [Hz], near 0 where unvoiced


@dataclass(frozen=True, eq=False)
class HibariModel:
    """Loaded model with its alphabet."""

    session: _Session
    synthesise: _Synthesis
    letter_ids: Mapping[str, int]
    duration_output: str

    def predict(self, letters: str, rates: Sequence[float], pitch: Floats32) -> Prediction:
        """Predict samples, letter durations and pitch of phoneme letters.

        Args:
            letters: of the model's alphabet.
            rates: speech rate of each letter, 1 is normal; limited to `MIN_SPEED` and `MAX_SPEED`.
            pitch: factor on the pitch, shape (1,), or (frames,) for each frame.

        Raises:
            EngineError: the model fails, or its durations do not add up to the sound.
        """
        ids = [PAD_ID, *(self.letter_ids[letter] for letter in letters), PAD_ID]
        speeds = np.clip(np.array([rates[0], *rates, rates[-1]], np.float32), MIN_SPEED, MAX_SPEED)
        inputs: dict[str, _Array] = {
            "ids": np.array([ids], np.int64),
            SPEED_INPUT: speeds,
            PITCH_INPUT: pitch[None, :],
        }
        try:
            *spectrum, f0, durations = self.session.run([*SPECTRAL_OUTPUTS, PITCH_OUTPUT, self.duration_output], inputs)
        except _runtime_errors() as error:
            raise EngineError(f"the model failed: {error}") from None
        generator = np.random.default_rng(NOISE_SEED)
        samples = self.synthesise(*(part[0] for part in spectrum), f0[0], generator)
        counted = int(durations.sum()) * FRAMES_PER_UNIT * FRAME_SAMPLES
        if len(durations) != len(ids) or counted != len(samples):
            raise EngineError(f"durations of {counted} samples do not fit a sound of {len(samples)}")
        return Prediction(samples, durations.astype(np.int64), f0[0].astype(np.float32))


@lru_cache(maxsize=1)
def find_package() -> Path | None:
    """Return the folder of hibari, or None without hibari or onnxruntime."""
    specs = [importlib.util.find_spec(name) for name in (PACKAGE_NAME, RUNTIME_NAME)]
    spec = specs[0]
    if spec is None or None in specs or not spec.submodule_search_locations:
        return None
    return Path(spec.submodule_search_locations[0])


@lru_cache(maxsize=1)
def find_installation_fault() -> str:
    """Return why hibari cannot be loaded, with a remedy, without loading it.

    The result is empty if its packages and files exist. A server's own process checks this alone, since a loaded voice
    takes 120 MB.
    """
    folder = find_package()
    if folder is None:
        return f"hibari-tts is not installed: {install_extra('voice')}"
    missing = [name for name in ASSET_NAMES if not (folder / "assets" / name).is_file()]
    return f"hibari-tts cannot be loaded: {folder / 'assets'} has no {', '.join(missing)}" if missing else ""


@lru_cache(maxsize=1)
def load_model() -> HibariModel:
    """Load the model once per process, with one thread.

    Raises:
        EngineError: the package is missing, or has a model of another kind.
    """
    folder = find_package()
    if folder is None:
        raise EngineError(find_installation_fault())
    try:
        model, vocabulary = (folder / "assets" / name for name in ASSET_NAMES)
        graph = edit_graph(model.read_bytes())
        letter_ids = json.loads(vocabulary.read_text(encoding="utf-8"))
        runtime = importlib.import_module(RUNTIME_NAME)
        synthesise = importlib.import_module(f"{PACKAGE_NAME}.dsp").synth
    except (OSError, ImportError, AttributeError, ProtobufError) as error:
        raise EngineError(f"hibari-tts cannot be loaded: {error}") from None
    options = runtime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 3  # errors alone
    try:
        session = runtime.InferenceSession(graph.model, options, providers=["CPUExecutionProvider"])
    except _runtime_errors() as error:
        raise EngineError(f"hibari-tts cannot be loaded: {error}") from None
    return HibariModel(session, synthesise, letter_ids, graph.duration_output)


@lru_cache(maxsize=1)
def _runtime_errors() -> tuple[type[Exception], ...]:
    """Return the exceptions of onnxruntime, whose only common class is `Exception`."""
    state = importlib.import_module(f"{RUNTIME_NAME}.capi.onnxruntime_pybind11_state")
    kinds = [kind for kind in vars(state).values() if isinstance(kind, type) and issubclass(kind, Exception)]
    return (RuntimeError, *kinds)
