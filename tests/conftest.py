"""Settings of all tests."""

from hypothesis import settings

# The first call of a kernel compiles it, which no deadline allows for; the same examples on
# every run, so that a failure is reproducible.
settings.register_profile('isa_ros', deadline=None, derandomize=True)
settings.load_profile('isa_ros')
