"""Probability that a frame of sound contains a human voice.

The network is Silero VAD 6.2 for 16 kHz (MIT, see configs/hearing/NOTICE), evaluated by NumPy alone: the magnitudes of
a short-time Fourier transform, four convolutions, one recurrent layer and one output. `docs/make/voice_activity.py`
converts its weights.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from kinesic.body.config import CONFIGS
from kinesic.body.utterance import Samples
from kinesic.files.array_file import read_arrays

WEIGHTS_FILE = CONFIGS / "hearing" / "voice_activity.npz"
MAX_WEIGHTS_SIZE = 4_000_000  # [bytes] largest size of the unpacked weights
VOICE_RATE = 16_000  # [Hz] sample rate of the network
FRAME_SIZE = 512  # [samples] size of a frame (32 ms), for which one probability is estimated
CONTEXT_SIZE = 64  # [samples] of the previous frame before each frame; as many mirrored samples follow the frame
WINDOW_SIZE = 256  # [samples] window of the Fourier transform
WINDOW_STEP = 128  # [samples] between the starts of two windows
FREQUENCY_COUNT = WINDOW_SIZE // 2 + 1  # frequencies of the Fourier transform
CONVOLUTION_STRIDES = (1, 2, 2, 1)  # time steps between the outputs of each convolution
STATE_SIZE = 128  # values of the hidden state and of the cell state


@dataclass(frozen=True, eq=False)
class VoiceNetwork:
    """Network weights as matrices in the layout `features @ weights`."""

    fourier: Samples  # (256, 258) windowed cosines, then sines
    convolutions: tuple[tuple[Samples, Samples], ...]  # kernel (3 inputs, outputs) and bias (outputs,) of each layer
    recurrent: Samples  # (256, 512) from features and hidden state to the four gates
    recurrent_bias: Samples  # (512,)
    output: Samples  # (128,)
    output_bias: float


@cache
def load_network() -> VoiceNetwork:
    """Load the weights of the voice detection network.

    Raises:
        ConfigError: the file is missing or damaged.
    """
    file = read_arrays(WEIGHTS_FILE, max_size=MAX_WEIGHTS_SIZE, kind="weights of the voice detector")
    arrays = {name: np.asarray(array, np.float32) for name, array in file.items()}
    return VoiceNetwork(
        arrays["fourier"],
        tuple((arrays[f"convolution_{layer}"], arrays[f"bias_{layer}"]) for layer in range(len(CONVOLUTION_STRIDES))),
        arrays["recurrent"],
        arrays["recurrent_bias"],
        arrays["output"],
        float(arrays["output_bias"][0]),
    )


class VoiceDetector:
    """Streaming voice detector with the state of one microphone."""

    def __init__(self) -> None:
        """Create a detector that has heard nothing."""
        self._network = load_network()
        self.reset()

    def reset(self) -> None:
        """Reset the network's state, for the start of a stream."""
        self._context = np.zeros(CONTEXT_SIZE, np.float32)
        self._hidden, self._cell = np.zeros(STATE_SIZE, np.float32), np.zeros(STATE_SIZE, np.float32)

    def probability(self, frame: Samples) -> float:
        """Return the probability of a voice in the next frame.

        Args:
            frame: (512,) samples in -1..1 at 16 kHz that follow the previous frame.
        """
        network = self._network
        features = self._magnitudes(np.asarray(frame, np.float32))
        for (kernel, bias), stride in zip(network.convolutions, CONVOLUTION_STRIDES, strict=True):
            padded = np.zeros((len(features) + 2, features.shape[1]), np.float32)
            padded[1:-1] = features
            rows = padded[_window_indices(len(features), stride, 3)]
            features = np.maximum(rows.reshape(len(rows), -1) @ kernel + bias, 0.0)
        gates = np.concatenate([features[0], self._hidden]) @ network.recurrent + network.recurrent_bias
        opening, keeping, candidate, showing = np.split(gates, 4)
        self._cell = _sigmoid(keeping) * self._cell + _sigmoid(opening) * np.tanh(candidate)
        self._hidden = _sigmoid(showing) * np.tanh(self._cell)
        return float(_sigmoid(np.maximum(self._hidden, 0.0) @ network.output + network.output_bias))

    def _magnitudes(self, frame: Samples) -> Samples:
        """Return the magnitudes (4, 129) of the short-time Fourier transform."""
        sound = np.concatenate([self._context, frame])
        self._context = frame[-CONTEXT_SIZE:]
        sound = np.concatenate([sound, sound[-2 : -CONTEXT_SIZE - 2 : -1]])  # reflected at its end
        spectra = sound[_window_indices(FRAME_SIZE, WINDOW_STEP, WINDOW_SIZE)] @ self._network.fourier
        return np.asarray(np.hypot(spectra[:, :FREQUENCY_COUNT], spectra[:, FREQUENCY_COUNT:]))


@cache
def _window_indices(size: int, step: int, width: int) -> NDArray[np.intp]:
    """Return the indices (m, width) of windows that start every `step`."""
    return np.arange(0, size, step)[:, None] + np.arange(width)


def _sigmoid(value: Samples) -> Samples:
    return np.asarray(1.0 / (1.0 + np.exp(-value)), np.float32)
