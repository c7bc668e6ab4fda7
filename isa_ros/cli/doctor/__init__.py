"""What is on this host for isa_ros: packages, middleware, limits, kernels (`isa doctor`)."""
