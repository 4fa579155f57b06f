from collections.abc import Iterator

import pytest

from kinesic.face.display import available
from kinesic.face.portrait import Portrait


@pytest.fixture(scope="session")
def drawable() -> None:
    """Skips where nothing can be drawn, saying why."""
    reason = available()
    if reason is not None:
        pytest.skip(reason)


@pytest.fixture(scope="session")
def portrait(drawable: None) -> Iterator[Portrait]:
    """The female head at 256 x 256 in preset normal."""
    with Portrait("female", size=(256, 256)) as opened:
        yield opened
