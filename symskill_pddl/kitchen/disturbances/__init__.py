"""What may go wrong on purpose: `NAME[:ARGUMENTS]@WHEN`, for example `close-door@op=2` or `push:20N,0.5s@p=0.01`.

A kind is a generator over a kitchen's control periods (in `hand`, `things` or `sight`) and a line in the table of `kinds`.
The text is read by `spec`, and `running` says when it happens.
"""

from symskill_pddl.kitchen.disturbances.kind import Kind
from symskill_pddl.kitchen.disturbances.kinds import ANY, KINDS
from symskill_pddl.kitchen.disturbances.running import Running
from symskill_pddl.kitchen.disturbances.spec import Disturbance, parse_disturbance

__all__ = ["ANY", "KINDS", "Disturbance", "Kind", "Running", "parse_disturbance"]
