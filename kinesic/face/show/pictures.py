"""Lazily drawn pictures of a film that would not fit into memory."""

from collections.abc import Callable, Sequence
from typing import overload

from kinesic.body.arrays import Picture


class LazyPictures(Sequence[Picture]):
    """Sequence that draws a picture on each access."""

    def __init__(self, count: int, draw: Callable[[int], Picture]) -> None:
        """Create a sequence without drawing anything.

        Args:
            count: number of pictures.
            draw: returns the picture of an index, 0 to count - 1.
        """
        self._count, self._draw = count, draw

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, index: int) -> Picture: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Picture]: ...

    def __getitem__(self, index: int | slice) -> Picture | Sequence[Picture]:
        if isinstance(index, slice):
            return [self[k] for k in range(self._count)[index]]
        return self._draw(range(self._count)[index])
