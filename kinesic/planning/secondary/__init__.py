"""Secondary motion: what a body does beneath all that is asked of it, while it gestures and speaks, too."""
