"""
Private wire of the lockstep: per tick, one step message to all and one answer from each.

Both are sent as std_msgs/UInt8MultiArray whose bytes are made here, without rclpy's encoder:
the 16 bytes before the array are fixed except for its length. Every message has the run's id,
so that messages of two coordinators in one domain are not mixed up. Little endian, unpadded;
the layout is an implementation detail of one version of this package, and a message with
another `VERSION` is refused.

Any process of the domain can send to the wire, so that all bytes are checked: what is not a
message is a `WireError`, and both ends discard it.
"""
