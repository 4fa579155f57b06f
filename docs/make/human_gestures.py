"""Draw human-gestures.png, strokes of the human model, and human-page.png, a replay in a report."""

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from page_pictures import BROWSERS, DRAWING_TIME, DRAWN
from PIL import Image

from kinesic import Performer
from kinesic.body.config import CONFIGS
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import Show, key_postures, plan_gesture
from kinesic.studies.gestures.portraits import TURNTABLE_FRAMES, draw_turntable
from kinesic.studies.gestures.sheet import MAX_POSTURES, draw_portraits

DOCS = Path(__file__).resolve().parents[1]
STRIP_GESTURE = "greet_wave"  # gesture of the strip of key postures
TURNTABLE_GESTURE = "count_two"  # gesture that is shown from all sides
VIEW_COUNT = 6  # number of views around the robot
WINDOW = (1000, 1100)  # [pixels] size of the browser window
STAGE = (25, 512, 960, 960)  # [pixels] left, top, right and bottom edge of the replay in the page
HUMAN = set_up("human")


def shown(name: str) -> Show:
    """Plan a gesture alone and return its key postures."""
    form = next(form for form in HUMAN.lexicon.forms if form.id == name)
    return key_postures(form, plan_gesture(form, HUMAN), MAX_POSTURES)


def draw_gestures(folder: Path) -> Image.Image:
    """Draw a strip of key postures above views from all sides."""
    strip = Image.open(draw_portraits(shown(STRIP_GESTURE), HUMAN.robot, folder / "strip.png")).convert("RGB")
    turned = shown(TURNTABLE_GESTURE)
    views = draw_turntable(HUMAN.robot, turned.postures[turned.stroke], turned.faces[turned.stroke])[
        :: TURNTABLE_FRAMES // VIEW_COUNT
    ]
    row = Image.fromarray(np.concatenate(views, axis=1))
    row = row.resize((strip.width, round(row.height * strip.width / row.width)), Image.Resampling.LANCZOS)
    return Image.fromarray(np.concatenate([np.asarray(strip), np.asarray(row)]))


def draw_page(folder: Path) -> Image.Image:
    """Draw a report's replay of the welcome on the human model."""
    performer = Performer("human", voice="auto")
    run = performer.perform(performer.plan(CONFIGS / "bml" / "welcome.bml", source="welcome.bml"))
    page, shot = run.report(folder / "report", film=False).page, folder / "page.png"
    browser = next(filter(None, map(shutil.which, BROWSERS)))
    size = f"--window-size={WINDOW[0]},{WINDOW[1]}"
    subprocess.run(
        [browser, *DRAWN, size, f"--timeout={DRAWING_TIME}", f"--screenshot={shot}", page.as_uri()], check=True
    )
    return Image.open(shot).convert("RGB").crop(STAGE)


with TemporaryDirectory() as place:
    draw_gestures(Path(place)).quantize(200).save(DOCS / "pictures" / "human-gestures.png", optimize=True)
    draw_page(Path(place)).quantize(200).save(DOCS / "pictures" / "human-page.png", optimize=True)
