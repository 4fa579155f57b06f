"""Built-in TOML files: robots, servos, gestures and styles, with example BML."""
