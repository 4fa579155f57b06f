"""Answers questions of clients that move nothing: reaches, drafts of plans, the state of the robot, documents."""
