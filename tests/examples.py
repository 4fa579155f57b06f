"""Number of examples per theorem: all in `make soak`, some in other runs."""

from hypothesis import settings

SAMPLE_FRACTION = 0.15  # fraction of the examples that runs outside the soak


def examples(most: int, **others) -> settings:
    """Return hypothesis settings for a number of soak examples, without deadline."""
    soaked = settings.get_current_profile_name() == "soak"
    return settings(max_examples=most if soaked else round(SAMPLE_FRACTION * most), deadline=None, **others)
