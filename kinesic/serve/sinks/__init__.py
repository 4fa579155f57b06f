"""Who performs for a server: the twin and servos in real time, and how servos are armed."""
