"""From demonstrations to a library: segments, references, predicates, operators, skills, goals."""

from symskill_pddl.learning.learn import LearnConfig, LearnReport, added, learn, learn_reported
from symskill_pddl.learning.symbolic import SymbolConfig, Symbolic, learn_symbols

__all__ = ["LearnConfig", "LearnReport", "SymbolConfig", "Symbolic", "added", "learn", "learn_reported", "learn_symbols"]
