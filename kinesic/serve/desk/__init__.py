"""Query service of the server: inverse kinematics, plans, exports, telemetry and documents."""
