"""Logs: attitudes over time, ROS bags, and the clocks that films and logs share."""
