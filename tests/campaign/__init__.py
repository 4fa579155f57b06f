"""Campaign of random blocks: violations of limits, penetrations and exceptions, counted by independent code."""
