"""HiGHS, the solver of linear programs, without its output."""

import highspy


class QuietHighs(highspy.Highs):
    """HiGHS solver that prints nothing.

    `highspy.Highs` prints a line when its constructor enables callbacks, before any option can be set.
    """

    def __init__(self) -> None:
        """Create a solver without output."""
        super().__init__()  # type: ignore[no-untyped-call]  # highspy annotates no methods

    def enableCallbacks(self) -> None:  # noqa: N802 - the name is that of HiGHS
        """Turn the output off before callbacks are enabled."""
        self.setOptionValue("output_flag", False)
        super().enableCallbacks()  # type: ignore[no-untyped-call]  # highspy annotates no methods
