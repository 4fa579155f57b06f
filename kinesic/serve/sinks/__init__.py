"""Real-time sinks of the server, and arming of servos."""
