"""Facts in TOML, robots, servos, gestures, styles, and example BML."""
