"""From a handful of robot demonstrations to a PDDL domain that any planner can solve and a robot can execute."""

__version__ = "0.1.0"
