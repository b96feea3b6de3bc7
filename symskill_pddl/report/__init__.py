"""Pages for people: one self-contained HTML file from a trace, a library, or the results of an evaluation."""

from symskill_pddl.report.page import library_page, results_page, run_page, write_page
from symskill_pddl.report.predicate import predicate_svg
from symskill_pddl.report.skill import skill_pictures

__all__ = ["library_page", "predicate_svg", "results_page", "run_page", "skill_pictures", "write_page"]
