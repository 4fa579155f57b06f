"""Multiprocessing context of planners, whose modules are imported once."""

from collections.abc import Callable, Sequence

from kinesic.child import ProcessContext, child_context
from kinesic.planning.setup import Setup
from kinesic.serve import planner
from kinesic.session import setup as session_setup


def planning_context(make_setup: Callable[[], Setup], tables: Sequence[str] = ()) -> ProcessContext:
    """Return a multiprocessing context that inherits no threads of the server.

    Args:
        make_setup: its module is imported once for all processes.
        tables: further modules that are imported once for all processes.
    """
    return child_context(
        planner.__name__, session_setup.__name__, make_setup.__module__, planner.TEXT_TABLES_MODULE, *tables
    )
