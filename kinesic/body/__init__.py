"""What the robot is and what it can be told."""
