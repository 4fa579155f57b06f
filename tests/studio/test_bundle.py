"""Built page of the package: up to date and small."""

import gzip
import hashlib
from pathlib import Path

import pytest

from kinesic.report.scene import SCENE_SCRIPTS, TEMPLATES_FOLDER
from kinesic.studio import page

CLIENT = Path(page.__file__).parent / "client"
MAX_PAGE_SIZE = 200_000  # [bytes] all files of the page, compressed


def test_script_bundle_of_the_studio_was_built_from_the_current_sources():
    if not CLIENT.is_dir():
        pytest.skip("an installed package has no sources")
    own = sorted((CLIENT / "src").rglob("*.ts"), key=lambda path: path.relative_to(CLIENT).as_posix())
    sources = [*own, *(TEMPLATES_FOLDER / name for name in SCENE_SCRIPTS)]
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()
    first = (page.PAGE_FOLDER / "studio.js").read_text(encoding="utf-8").partition("\n")[0]
    assert first == f"// kinesic studio, made from sources {digest}", "rebuild it with: make studio"


def test_compressed_studio_page_has_a_limited_size():
    assert sum(len(gzip.compress(path.read_bytes())) for path in page.PAGE_FOLDER.iterdir()) < MAX_PAGE_SIZE
