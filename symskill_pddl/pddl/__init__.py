"""PDDL text: writing (in dialects), reading, names, plans, and comparing an edited domain with the learned one."""

from symskill_pddl.pddl.check import Binding, Comparison, Finding, Severity, compare
from symskill_pddl.pddl.dialect import DIALECTS, Exported, exported, expressible
from symskill_pddl.pddl.export import write_domain, write_problem
from symskill_pddl.pddl.names import Names, load_names, load_renames
from symskill_pddl.pddl.parse import read_atoms, read_domain, read_problem
from symskill_pddl.pddl.plan import read_plan, write_plan

__all__ = [
    "DIALECTS",
    "Binding",
    "Comparison",
    "Exported",
    "Finding",
    "Names",
    "Severity",
    "compare",
    "exported",
    "expressible",
    "load_names",
    "load_renames",
    "read_atoms",
    "read_domain",
    "read_plan",
    "read_problem",
    "write_domain",
    "write_plan",
    "write_problem",
]
