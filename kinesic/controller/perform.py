"""Deprecated aliases of functions that moved to other modules."""

import warnings
from importlib import import_module

NEW_PATHS = {  # name of a function -> its new import path
    "dry_run": "kinesic.controller.dry_run.dry_run",
    "dry_runs": "kinesic.controller.dry_run.dry_runs",
    "perform": "kinesic.performer.perform",
    "plan": "kinesic.session.plan.plan",
    "set_up": "kinesic.session.setup.set_up",
}


def __getattr__(name: str) -> object:
    """Return a moved function by its old name, with a deprecation warning."""
    if name not in NEW_PATHS:
        raise AttributeError(f"module {__name__} has no attribute {name}")
    module, new_name = NEW_PATHS[name].rsplit(".", 1)
    warnings.warn(f"{__name__}.{name} is deprecated: use {NEW_PATHS[name]}", DeprecationWarning, stacklevel=2)
    value: object = getattr(import_module(module), new_name)
    return value
