"""From demonstrations to a library: segments, references, predicates, operators, skills, goals."""

from symskill_pddl.learning.learn import LearnConfig, LearnReport, added, learn, learn_reported

__all__ = ["LearnConfig", "LearnReport", "added", "learn", "learn_reported"]
