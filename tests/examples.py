"""How many examples of a theorem are tried: `make soak` tries all that are worth it, every other run some of them."""

from hypothesis import settings

SHARE = 0.4  # of the examples, where nobody asks for the soak


def examples(most: int, **others) -> settings:
    """The settings of a theorem that the soak tries on so many examples; no example has a deadline."""
    soaked = settings.get_current_profile_name() == "soak"
    return settings(max_examples=most if soaked else round(SHARE * most), deadline=None, **others)
