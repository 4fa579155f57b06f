from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import cache

import pytest

from kinesic.face.display import find_display_problem, open_offscreen_context
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import Preset

Gallery = Callable[[Preset, tuple[int, int]], AbstractContextManager[Portrait]]


@pytest.fixture(scope="session")
def drawable() -> None:
    """Skip the test with a reason if no picture can be drawn."""
    reason = find_display_problem()
    if reason is not None:
        pytest.skip(reason)


@pytest.fixture(scope="session")
def portrait(drawable: None) -> Iterator[Portrait]:
    """Portrait of the female head, 256 x 256 pixels, preset normal."""
    with Portrait("female", size=(256, 256)) as opened:
        yield opened


@pytest.fixture(scope="module")
def gallery(drawable: None) -> Iterator[Gallery]:
    """Portraits of the female head by preset and size.

    All use one context.
    """
    with open_offscreen_context() as context:

        @cache
        def portrait(preset: Preset, size: tuple[int, int]) -> Portrait:
            return Portrait(preset=preset, size=size, context=context)

        @contextmanager
        def opened(preset: Preset, size: tuple[int, int]) -> Iterator[Portrait]:
            with context:
                yield portrait(preset, size)

        yield opened
