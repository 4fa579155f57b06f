"""Film studio_session.webp: a newcomer makes a greeting of 20 s, as the browser shows it."""

import base64
import io
import json
import sys
from bisect import bisect_right
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event, Thread
from time import monotonic, sleep

from PIL import Image, ImageDraw, ImageFont
from websockets.sync.client import connect

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests import chromium  # noqa: E402 - the film shows the actions of a test
from tests.studio.newcomer import STATE, opened_studio, write_greeting  # noqa: E402

FILM_FILE = ROOT / "docs" / "pictures" / "studio_session.webp"
WINDOW = (1280, 807)  # [pixels] size of the browser window, with 87 for its toolbar
FILM_SIZE = (800, 450)  # [pixels] width and height of the film
FRAME_RATE = 4.0  # [Hz] frame rate of the film
MAX_STILL_TIME = 1.5  # [s] longest time without a change; the film leaves out longer waits
POINTER_TIME = 0.8  # [s] duration of a pointer movement
POINTER_STEPS = 8  # pointer positions of a movement
TYPING_INTERVAL = 0.05  # [s] between two typed words
MAX_WAIT = 600.0  # [s] longest wait for the browser on a busy machine
QUALITY = 35  # WebP quality, 0 to 100
INK, PAPER, POINTER = "#23262d", "#fbfaf7", "#b4430f"

Point = tuple[float, float]


class ScreenRecorder:
    """Frames of the page with their times [s], as the browser sends them."""

    def __init__(self, address: str) -> None:
        self.frames: list[tuple[float, bytes]] = []
        self._address, self._ended = address, Event()
        self._thread = Thread(target=self._record)
        self._thread.start()

    def _record(self) -> None:
        with connect(self._address, max_size=None) as connection:
            number = 1
            begin = {"format": "jpeg", "quality": 90, "maxWidth": WINDOW[0], "maxHeight": WINDOW[1]}
            connection.send(json.dumps({"id": number, "method": "Page.startScreencast", "params": begin}))
            while not self._ended.is_set():
                try:
                    message = json.loads(connection.recv(timeout=1.0))
                except TimeoutError:
                    continue
                if message.get("method") != "Page.screencastFrame":
                    continue
                frame = message["params"]
                self.frames.append((monotonic(), base64.b64decode(frame["data"])))
                number += 1
                seen = {"sessionId": frame["sessionId"]}
                connection.send(json.dumps({"id": number, "method": "Page.screencastFrameAck", "params": seen}))

    def end(self) -> None:
        """Stop the recording."""
        self._ended.set()
        self._thread.join()


@contextmanager
def recorded(page: chromium.Page) -> Iterator[ScreenRecorder]:
    """Record the screen of a page within the context."""
    target = page.call("Target.getTargetInfo")["targetInfo"]["targetId"]
    flags = (f"--window-size={WINDOW[0]},{WINDOW[1]}",)
    recorder = ScreenRecorder(f"{chromium.browser(*flags).address}page/{target}")
    try:
        yield recorder
    finally:
        recorder.end()


class Captions:
    """Actions with their times, and the path of the pointer."""

    def __init__(self) -> None:
        self.texts: list[tuple[float, str]] = []
        self.places: list[tuple[float, Point]] = [(monotonic(), (WINDOW[0] / 2, WINDOW[1] / 2))]

    def act(self, what: str, where: Point | None) -> None:
        """Show an action, and move the pointer to its place."""
        self.texts.append((monotonic(), f"{len(self.texts) + 1}. {what}"))
        if where is None:
            return
        (x, y), begun = self.places[-1][1], monotonic()
        for step in range(1, POINTER_STEPS + 1):
            part = step / POINTER_STEPS
            ease = part * part * (3.0 - 2.0 * part)
            place = (x + ease * (where[0] - x), y + ease * (where[1] - y))
            self.places.append((begun + part * POINTER_TIME, place))
        sleep(POINTER_TIME)

    def at(self, time: float) -> tuple[str, Point]:
        """Return caption and pointer position at a time [s]."""
        text = bisect_right(self.texts, time, key=lambda each: each[0]) - 1
        place = max(0, bisect_right(self.places, time, key=lambda each: each[0]) - 1)
        return self.texts[text][1] if text >= 0 else "", self.places[place][1]


def draw(data: bytes, caption: str, pointer: Point) -> Image.Image:
    """Draw one film frame: page, pointer and caption."""
    frame = Image.open(io.BytesIO(data)).convert("RGB")
    pen = ImageDraw.Draw(frame)
    x, y = pointer
    pen.polygon([(x, y), (x, y + 24), (x + 6, y + 18), (x + 16, y + 18)], fill=POINTER, outline=PAPER)
    font = ImageFont.load_default(size=26)
    wide = pen.textlength(caption, font=font)
    x, y = (frame.width - wide) / 2, frame.height - 52
    if caption:
        pen.rounded_rectangle((x - 18, y - 6, x + wide + 18, y + 40), radius=10, fill=INK)
        pen.text((x, y), caption, fill=PAPER, font=font)
    return frame.resize(FILM_SIZE, Image.Resampling.LANCZOS)


def cut(recorder: ScreenRecorder, captions: Captions) -> Iterator[tuple[Image.Image, float]]:
    """Yield drawn frames with their durations [s], without long waits."""
    changes = sorted({time for time, _ in (*recorder.frames, *captions.texts, *captions.places)})
    times = [time for time, _ in recorder.frames]
    shown, duration = -1.0, 0.0
    for time, following in pairwise((*changes, changes[-1] + MAX_STILL_TIME)):
        duration += min(following - time, MAX_STILL_TIME)
        at = bisect_right(times, time) - 1
        if at < 0 or duration < 1.0 / FRAME_RATE:
            continue
        caption, pointer = captions.at(time)
        yield draw(recorder.frames[at][1], caption, pointer), duration
        shown, duration = time, 0.0
    assert shown >= 0.0, "the browser has sent no frame"


if __name__ == "__main__":
    chromium.MAX_WAIT = MAX_WAIT
    flags = (f"--window-size={WINDOW[0]},{WINDOW[1]}",)
    captions = Captions()
    with TemporaryDirectory() as folder, opened_studio(Path(folder), "--no-sound", flags=flags) as person:
        person.films, person.typing_interval = captions.act, TYPING_INTERVAL
        with recorded(person.page) as recorder:
            sleep(MAX_STILL_TIME)
            write_greeting(person)
            person.click("#perform", "Perform")
            person.sees("s.performs")
            captions.act("the simulated robot performs it", None)
            duration = person.page.value(f"{STATE}.draft.duration")
            person.page.until("document.querySelector('#performing').textContent.startsWith('Finished')")
    frames, durations = zip(*cut(recorder, captions), strict=True)
    milliseconds = [round(1000 * each) for each in durations]
    frames[0].save(
        FILM_FILE,
        save_all=True,
        append_images=frames[1:],
        duration=milliseconds,
        loop=0,
        quality=QUALITY,
        method=4,
    )
    size = FILM_FILE.stat().st_size / 1000
    line = f"performance of {duration:.1f} s, film of {sum(durations):.0f} s, {len(frames)} frames, {size:.0f} kB"
    sys.stdout.write(f"{line}\n")
