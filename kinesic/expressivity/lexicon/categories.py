"""Categories of the gestures that come with kinesic."""

from typing import Literal, get_args

Category = Literal["beat", "deictic", "iconic", "metaphoric", "emblem", "adaptor", "emotion", "rest"]
GESTURE_CATEGORIES: tuple[str, ...] = tuple(sorted(get_args(Category)))  # all categories in alphabetical order
