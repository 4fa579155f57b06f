"""Synchrony of scene and voice in the page of examples/threejs."""

import functools
import threading
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from shutil import copytree

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.body.utterance import Sound
from kinesic.controller.soundtrack import write_wav
from kinesic.face.assets.action_units import compute_shape_weights
from kinesic.face.assets.body import load_figure
from kinesic.report.gltf.scene import KEY_FRAME_RATE, SceneMotion, write_scene
from kinesic.studio import page as studio_page

from ...chromium import binary, opened

THREE = Path(studio_page.__file__).parent / "client" / "node_modules" / "three"
EXAMPLE = Path(__file__).parents[3] / "examples" / "threejs"
DURATION = 1.0  # [s] duration of the sound and the motion
RATE = 44100  # [Hz] sample rate of the sound
TONE_FREQUENCY = 2100.0  # [Hz] ten periods in the 210 samples of a measurement
AMPLITUDES = (0.1, 0.9)  # loudness of the tone at the beginning and end, which tells the time
MEDIAN_DRIFT = 0.02  # [s] largest median time between sound and lips
MAX_DRIFT = 0.05  # [s] largest time between sound and lips in nine of ten frames
# Time by the tone's loudness, as it passes through the audio graph, and time by the jaw, at each drawn frame.
RECORD_SCRIPT = """(async () => {
  const { shown } = await import("./player.js");
  const context = shown.output.context, tap = context.createAnalyser(), samples = new Float32Array(256);
  tap.fftSize = 256;
  tap.connect(shown.output);
  shown.output = tap;
  let face = null;
  shown.body.traverse((node) => { if (node.morphTargetDictionary?.jawOpen !== undefined) face ??= node; });
  const jaw = face.morphTargetDictionary.jawOpen, lips = Array.from({ length: 400 }, (_, k) => k * 10);
  const place = () => lips.map((k) => face.getVertexPosition(k, face.position.clone()).y);
  window.rows = [], window.before = place();
  const update = shown.update.bind(shown);
  shown.update = () => {
    const time = update();
    tap.getFloatTimeDomainData(samples);
    if (!shown.ended) {
      const power = samples.slice(-210).reduce((sum, sample) => sum + sample * sample, 0) / 210;
      rows.push([Math.sqrt(2 * power), face.morphTargetInfluences[jaw], context.outputLatency || 0]);
    } else if (rows.length) {
      window.after ??= place();
    }
    return time;
  };
})()"""

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(binary() is None, reason="no Chromium: apt-get install chromium"),
    pytest.mark.skipif(not THREE.is_dir(), reason="no three.js here: make studio"),
]


class QuietHandler(SimpleHTTPRequestHandler):
    """Serve files without a log."""

    def log_message(self, *words: object) -> None:
        """Print nothing."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Copy the example into a folder with an installed three.js."""
    folder = tmp_path_factory.mktemp("threejs") / "page"
    copytree(EXAMPLE, folder, ignore=lambda *_: ["node_modules"])
    (folder / "node_modules").mkdir()
    (folder / "node_modules" / "three").symlink_to(THREE)
    return folder


@pytest.fixture(scope="module")
def address(folder: Path) -> Iterator[str]:
    """Serve the page's folder on a port of this machine."""
    with ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(QuietHandler, directory=str(folder))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/index.html"
        server.shutdown()


def write_ramps(folder: Path) -> None:
    """Write a steadily opening jaw and a tone of equally rising loudness."""
    human = Robot.load("human")
    times = np.arange(round(DURATION * KEY_FRAME_RATE) + 1) / KEY_FRAME_RATE
    angles = np.tile(human.skeleton.rest, (len(times), 1))
    write_scene(human, SceneMotion(times, angles, [{"26": time / DURATION} for time in times]), folder / "ramp.glb")
    sampled = np.arange(round(DURATION * RATE)) / RATE
    loudness = np.interp(sampled, (0.0, DURATION), AMPLITUDES)
    tone = loudness * np.sin(2 * np.pi * TONE_FREQUENCY * sampled)
    write_wav(Sound.of(RATE, tone), folder / "ramp.wav")


@pytest.mark.soak
def test_threejs_page_opens_the_jaw_in_step_with_the_voice(folder: Path, address: str):
    write_ramps(folder)
    with opened(f"{address}?scene=ramp.glb&voice=ramp.wav") as page:
        page.until("document.querySelector('#play:enabled') !== null || document.querySelector('#message')?.innerText")
        assert page.value("message.innerText") == ""
        page.value(RECORD_SCRIPT)
        with page.undrawn():
            page.click("#play")
            page.until("window.after !== undefined")
        rows, before, after = (page.value(name) for name in ("rows", "before", "after"))
    loudness, jaw, latency = np.array(rows).T
    assert np.subtract(before, after).max() > 0.005, "the chin sinks [m]"
    heard = loudness > AMPLITUDES[0]
    assert heard.sum() >= 5
    assert jaw[heard].max() > 0.3
    widest = np.subtract(*AMPLITUDES[::-1])
    by_sound = DURATION * (loudness[heard] - AMPLITUDES[0]) / widest - latency[heard]
    drift = np.abs(DURATION * jaw[heard] / jaw_opening() - by_sound)
    assert np.median(drift) < MEDIAN_DRIFT
    assert np.quantile(drift, 0.9) < MAX_DRIFT


def test_threejs_page_reports_a_missing_scene(address: str):
    with opened(f"{address}?scene=none.glb") as page:
        page.until("document.querySelector('#message')?.innerText")
        assert "404" in page.value("message.innerText")
        assert page.value("play.disabled") is True


def jaw_opening() -> float:
    """Return the weight of the jaw's shape for the widest opening."""
    mesh = load_figure().mesh
    return float(compute_shape_weights(mesh, {"26": 1.0})[list(mesh.shapes).index("jawOpen")])
