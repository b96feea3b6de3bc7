"""Skills: stable twist fields over SE(3), learned from a few demonstrations. Arrays in, twist out."""

from symskill_pddl.skills.config import FitConfig
from symskill_pddl.skills.field import Field
from symskill_pddl.skills.following import rollout
from symskill_pddl.skills.obstacles import Superellipsoids, box, ellipsoid, modulate
from symskill_pddl.skills.orientation import OrientationField
from symskill_pddl.skills.position import PositionField
from symskill_pddl.skills.skill import Phase, Skill
from symskill_pddl.skills.split import FitReport, fit_fields, fit_phases, fit_reported
from symskill_pddl.skills.stability import Certificate
from symskill_pddl.skills.trajectory import Trajectory
from symskill_pddl.skills.warm import warm

__all__ = [
    "Certificate",
    "Field",
    "FitConfig",
    "FitReport",
    "OrientationField",
    "Phase",
    "PositionField",
    "Skill",
    "Superellipsoids",
    "Trajectory",
    "box",
    "ellipsoid",
    "fit_fields",
    "fit_phases",
    "fit_reported",
    "modulate",
    "rollout",
    "warm",
]
