"""Names the case that fails where one test looks at many: a test for each would cost more than what it looks at."""

from types import TracebackType


class about:  # noqa: N801 - read as a word before a case, as pytest.raises is
    """Whatever fails inside is shown with its case."""

    def __init__(self, case: object) -> None:
        self._case = case

    def __enter__(self) -> None:
        pass

    def __exit__(
        self, _: type[BaseException] | None, error: BaseException | None, _where: TracebackType | None
    ) -> None:
        if error is not None:
            error.add_note(f"case: {self._case}")
