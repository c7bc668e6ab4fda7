"""Adapters to rclpy and DDS: waiting, publishing, QoS, environment."""
