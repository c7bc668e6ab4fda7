"""Supply circuits: named parts between a tank and the manifolds of actuators, as one network."""
