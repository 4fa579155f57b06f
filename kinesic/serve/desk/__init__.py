"""Query service of the server: reach, plans, exports, telemetry and documents."""
