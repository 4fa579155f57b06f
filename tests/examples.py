"""Number of random examples per property test: all in `make soak`, fewer elsewhere."""

from hypothesis import settings

SAMPLE_FRACTION = 0.1  # fraction of the examples that runs outside the soak


def examples(most: int, **others) -> settings:
    """Return Hypothesis settings without deadline for a number of soak examples."""
    soaked = settings.get_current_profile_name() == "soak"
    return settings(max_examples=most if soaked else round(SAMPLE_FRACTION * most), deadline=None, **others)
