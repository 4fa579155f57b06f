"""Draw study.png, the participant's page of the face study with one of its faces."""

import base64
import io
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from kinesic.studies.perception.design import list_stimuli  # noqa: E402
from kinesic.studies.perception.page import draw_stimuli, write_study_page  # noqa: E402
from tests import chromium  # noqa: E402 - the picture is taken in the browser of the tests

STIMULUS = "female-4-high-wrinkled-image"
WINDOW = (1000, 1150)  # [pixels] size of the browser window


if __name__ == "__main__":
    stimulus = next(stimulus for stimulus in list_stimuli() if stimulus.id == STIMULUS)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "index.html"
        write_study_page(file)
        list(draw_stimuli([stimulus], Path(folder) / "stimuli"))
        with chromium.opened(file.as_uri(), f"--window-size={WINDOW[0]},{WINDOW[1]}") as page:
            page.until("document.readyState === 'complete' && typeof state === 'object'")
            page.value(f"state.order[0] = '{stimulus.code}'")
            page.click("#begin")
            page.until("document.querySelectorAll('fieldset').length === 5")
            data = page.call("Page.captureScreenshot", format="png")["data"]
    picture = Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")
    picture.save(ROOT / "docs" / "pictures" / "study.png", optimize=True)
