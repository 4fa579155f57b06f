"""Real-time sinks of the server, and arming (enabling of torque) of servos."""
