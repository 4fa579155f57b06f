"""The bundle that the package carries: made from the sources that are here, and small."""

import gzip
import hashlib
from pathlib import Path

import pytest

from kinesic.report.scene import SCENE_SCRIPTS, TEMPLATES
from kinesic.studio import page

CLIENT = Path(page.__file__).parent / "client"
MOST = 200_000  # [bytes] of all that the page loads, as browsers may get it compressed


def test_the_bundle_is_made_from_these_sources():
    if not CLIENT.is_dir():
        pytest.skip("an installed package has no sources")
    sources = [*sorted((CLIENT / "src").iterdir()), *(TEMPLATES / name for name in SCENE_SCRIPTS)]
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()
    first = (page.PAGE / "studio.js").read_text(encoding="utf-8").partition("\n")[0]
    assert first == f"// kinesic studio, made from sources {digest}", "make studio makes it anew"


def test_the_page_is_small():
    assert sum(len(gzip.compress(path.read_bytes())) for path in page.PAGE.iterdir()) < MOST
