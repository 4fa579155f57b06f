"""Why a call of a tool fails: it is refused, or the robot does not answer."""


class RefusedError(ValueError):
    """A call is not carried out and nothing moves; the text names the reason and the remedy."""


class RobotError(RuntimeError):
    """The server is gone or did not answer in time; the text says which of both, and the remedy."""
