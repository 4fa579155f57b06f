"""Draw welcome.png, three strokes of welcome.bml in simulation, and report.png, the report page."""

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image

from kinesic import Performer
from kinesic.body.config import CONFIGS
from kinesic.sim.film import write_still

DOCS = Path(__file__).resolve().parents[1]
STROKES = ("wave:stroke", "open:stroke", "there:stroke")
WINDOW = (1100, 1230)  # [pixels] size of the browser window
DRAWING_TIME = 10_000  # [ms] wait until the replay and the face are drawn
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
DRAWN = ("--headless", "--no-sandbox", "--hide-scrollbars", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


if __name__ == "__main__":
    performer = Performer("upper36", voice="auto")
    document = CONFIGS / "bml" / "welcome.bml"
    run = performer.perform(performer.plan(document, source="welcome.bml"))
    browser = next(filter(None, map(shutil.which, BROWSERS)))
    with TemporaryDirectory() as folder:
        stills = [Path(folder) / f"{k}.png" for k in range(len(STROKES))]
        for stroke, still in zip(STROKES, stills, strict=True):
            write_still(performer.robot, run.at(stroke).angles, still)
        row = np.concatenate([np.asarray(Image.open(still)) for still in stills], axis=1)
        Image.fromarray(row).save(DOCS / "pictures" / "welcome.png", optimize=True)
        page = run.report(Path(folder) / "report", film=False).page
        shot = Path(folder) / "page.png"
        size = f"--window-size={WINDOW[0]},{WINDOW[1]}"
        subprocess.run(
            [browser, *DRAWN, size, f"--timeout={DRAWING_TIME}", f"--screenshot={shot}", page.as_uri()], check=True
        )
        Image.open(shot).convert("RGB").save(DOCS / "pictures" / "report.png", optimize=True)
