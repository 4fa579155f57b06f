"""Finds joint angles for a reach."""

from typing import Literal

KERNEL: Literal["compiled", "numpy"] = "numpy"  # which implementation runs
