"""Draw notebook.png, the notebook view of a performance of welcome.bml."""

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from kinesic import Performer

PICTURE = Path(__file__).resolve().parents[1] / "pictures" / "notebook.png"
WINDOW = (1000, 940)  # [pixels] size of the browser window
DRAWING_TIME = 10_000  # [ms] wait until the replay and the face are drawn
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
DRAWN = (
    "--headless",
    "--no-sandbox",
    "--hide-scrollbars",
    "--disable-features=IsolateSandboxedIframes",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)


if __name__ == "__main__":
    run = Performer("upper22", style="joyful").perform("welcome")
    browser = next(filter(None, map(shutil.which, BROWSERS)))
    with TemporaryDirectory() as folder:
        page, shot = Path(folder) / "page.html", Path(folder) / "page.png"
        page.write_text(f'<meta charset="utf-8"><body style="font:14px sans-serif">{run._repr_html_()}', "utf-8")
        size = f"--window-size={WINDOW[0]},{WINDOW[1]}"
        subprocess.run(
            [browser, *DRAWN, size, f"--timeout={DRAWING_TIME}", f"--screenshot={shot}", page.as_uri()], check=True
        )
        Image.open(shot).convert("RGB").save(PICTURE, optimize=True)
