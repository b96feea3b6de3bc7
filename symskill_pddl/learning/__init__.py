"""From demonstrations to a library: segments, references, predicates, operators, skills, goals."""

from symskill_pddl.learning.config import LearnConfig, read_config
from symskill_pddl.learning.learn import LearnReport, added, learn, learn_reported
from symskill_pddl.learning.symbolic import Symbolic, learn_symbols

__all__ = ["LearnConfig", "LearnReport", "Symbolic", "added", "learn", "learn_reported", "learn_symbols", "read_config"]
