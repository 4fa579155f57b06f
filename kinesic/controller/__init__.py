"""The straight line from BML to the sinks, and the one loop."""
