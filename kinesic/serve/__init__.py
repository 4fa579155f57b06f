"""The live server: performs blocks as they arrive, over any transport."""
