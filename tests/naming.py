"""Names the case that fails where one test looks at many: a test for each would cost more than what it looks at."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def about(case: object) -> Iterator[None]:
    """Whatever fails inside is shown with its case."""
    try:
        yield
    except Exception as error:
        error.add_note(f"case: {case}")
        raise
