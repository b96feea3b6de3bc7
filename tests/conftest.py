"""What holds for all tests: their outcome depends neither on the clock nor on chance."""

from hypothesis import HealthCheck, settings

# the same examples in every run, for as long as they take; `pytest --hypothesis-profile=wide` looks for others
settings.register_profile("steady", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("wide", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("steady")
