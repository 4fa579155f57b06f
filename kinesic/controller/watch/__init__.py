"""Clearance watch: slow or stop robots whose tracking errors threaten collisions."""
