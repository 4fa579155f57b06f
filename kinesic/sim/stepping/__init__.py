"""Steps the twin's physics, and keeps what each step did."""
