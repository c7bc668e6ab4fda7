"""Measurements that isa_ros did not record: read by a mapping, compared, simulated again."""
