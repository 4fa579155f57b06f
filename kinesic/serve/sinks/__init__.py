"""Real-time outputs (sinks) of the server, and enabling of servo torque (arming)."""
