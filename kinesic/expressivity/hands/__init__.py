"""Hand motion: stroke keys, holds, and transitions between gestures."""
