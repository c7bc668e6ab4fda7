"""What the nodes use of rclpy and DDS: waiting, publishing, QoS, environment."""
