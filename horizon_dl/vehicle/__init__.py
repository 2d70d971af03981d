"""The autopilot: messages, lines, telemetry, and its attitudes in time."""
