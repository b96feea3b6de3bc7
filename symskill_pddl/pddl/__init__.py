"""PDDL text: writing (in dialects), reading, names, plans, and comparing an edited domain with the learned one."""

from symskill_pddl.pddl.check import Binding, Comparison, Finding, Severity, compare
from symskill_pddl.pddl.dialect import DIALECTS, Exported, exported, expressible
from symskill_pddl.pddl.export import write_domain, write_problem
from symskill_pddl.pddl.names import Names, load_names, load_renames
from symskill_pddl.pddl.parse import read_atoms, read_domain, read_problem
from symskill_pddl.pddl.plan import Read, printed_plans, read_plan, read_plans, write_plan
from symskill_pddl.pddl.task import Task, read_task
from symskill_pddl.pddl.validate import validate_plan

__all__ = [
    "DIALECTS",
    "Binding",
    "Comparison",
    "Exported",
    "Finding",
    "Names",
    "Read",
    "Severity",
    "Task",
    "compare",
    "exported",
    "expressible",
    "load_names",
    "load_renames",
    "printed_plans",
    "read_atoms",
    "read_domain",
    "read_plan",
    "read_plans",
    "read_problem",
    "read_task",
    "validate_plan",
    "write_domain",
    "write_plan",
    "write_problem",
]
