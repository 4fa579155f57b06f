"""Labels for failing cases in tests that check many cases.

A separate test for each case would cost more than the check itself.
"""

from types import TracebackType


class about:  # noqa: N801 - read as a word before a case, as pytest.raises is
    """Add the name of the case to any failure inside the `with` block."""

    def __init__(self, case: object) -> None:
        self._case = case

    def __enter__(self) -> None:
        pass

    def __exit__(
        self, _: type[BaseException] | None, error: BaseException | None, _where: TracebackType | None
    ) -> None:
        if error is not None:
            error.add_note(f"case: {self._case}")
