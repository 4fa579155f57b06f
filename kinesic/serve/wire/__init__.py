"""Transports, message framing, access control and quotas of client connections."""
