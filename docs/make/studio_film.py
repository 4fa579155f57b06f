"""Film a newcomer's tour, studio_tour.webp, and draw the studio and its gesture editor, light and dark."""

import base64
import io
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, sleep

from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests import chromium  # noqa: E402 - the film shows the actions of a test
from tests.studio.newcomer import STATE, before_the_studio, make_and_perform  # noqa: E402

DOCS = ROOT / "docs"
WINDOW = (1280, 807)  # [pixels] size of the browser window, with 87 for its toolbar
FILM_SIZE = (960, 540)  # [pixels] width and height of the film
ACTION_TIME = 1600  # [ms] display time of one action and its caption
MIN_FRAME_TIME = 125  # [ms] shortest time between two frames of the performance
FULL_QUALITY_DELAY = 1500  # [ms] wait until the page is drawn in full quality
PICTURE_TIME = 2.2  # [s] performance time of the greeting in the picture
FILMED_TIME = 9.0  # [s] length of the filmed performance
MAX_WAIT = 240.0  # [s] longest wait for the browser on a busy machine
INK, PAPER, POINTER = "#23262d", "#fbfaf7", "#b4430f"


def picture(page: chromium.Page) -> Image.Image:
    """Return a picture of the page."""
    return Image.open(io.BytesIO(base64.b64decode(page.call("Page.captureScreenshot", format="png")["data"]))).convert(
        "RGB"
    )


def titled(shown: Image.Image, title: str, where: tuple[float, float] | None) -> Image.Image:
    """Draw one film frame from page, pointer and caption."""
    frame = shown.copy()
    pen = ImageDraw.Draw(frame)
    if where is not None:
        x, y = where
        pen.ellipse((x - 15, y - 15, x + 15, y + 15), outline=POINTER, width=5)
    font = ImageFont.load_default(size=26)
    wide = pen.textlength(title, font=font)
    x, y = (frame.width - wide) / 2, frame.height - 64
    pen.rounded_rectangle((x - 18, y - 8, x + wide + 18, y + 40), radius=10, fill=INK)
    pen.text((x, y), title, fill=PAPER, font=font)
    return frame.resize(FILM_SIZE, Image.Resampling.LANCZOS)


def performance(page: chromium.Page) -> Iterator[tuple[Image.Image, int]]:
    """Record frames of a performance, each with its duration [ms].

    A busy machine gives fewer and longer frames.
    """
    page.until(f"{STATE}.mode === 'robot'")
    begun = monotonic()
    while (taken := monotonic()) - begun < FILMED_TIME:
        frame = titled(picture(page), "simulated servos perform it", None)
        sleep(max(0.0, taken + MIN_FRAME_TIME / 1000 - monotonic()))
        yield frame, round(1000 * (monotonic() - taken))


def in_both_schemes(page: chromium.Page, name: str) -> None:
    """Save pictures of the page in the light and dark colour schemes."""
    for scheme, path in (("dark", f"{name}_dark.png"), ("light", f"{name}.png")):
        page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        page.value(f"new Promise(done => setTimeout(done, {FULL_QUALITY_DELAY}))")
        picture(page).quantize(256, kmeans=2).save(DOCS / "pictures" / path, optimize=True)


if __name__ == "__main__":
    chromium.MAX_WAIT = MAX_WAIT
    frames, times = list[Image.Image](), list[int]()
    with (
        TemporaryDirectory() as folder,
        before_the_studio(Path(folder), f"--window-size={WINDOW[0]},{WINDOW[1]}") as person,
    ):

        def film(what: str, where: tuple[float, float] | None) -> None:
            """Store a film frame of the page before an action."""
            frames.append(titled(picture(person.page), f"{len(frames) + 1}. {what}", where))
            times.append(ACTION_TIME)
            if what.startswith("Save the gesture"):
                in_both_schemes(person.page, "studio_gesture")

        slider = "document.querySelector('#time')"
        person.page.value(f"{slider}.value = {PICTURE_TIME}, {slider}.dispatchEvent(new Event('input'))")
        person.sees("s.report !== null")
        in_both_schemes(person.page, "studio")
        person.page.value(f"{slider}.value = 0, {slider}.dispatchEvent(new Event('input'))")
        person.films = film
        make_and_perform(person)
        for frame, duration in performance(person.page):
            frames.append(frame)
            times.append(duration)
    film = DOCS / "pictures" / "studio_tour.webp"
    frames[0].save(film, save_all=True, append_images=frames[1:], duration=times, loop=0, quality=45, method=6)
