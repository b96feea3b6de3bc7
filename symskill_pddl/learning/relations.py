"""What becomes a predicate, before it has a name: places and contacts, episodes labelled with them, and the settings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from symskill_pddl.geometry import Array
from symskill_pddl.learning.articulation import ArticulationConfig, Joint
from symskill_pddl.learning.references import ReferenceConfig
from symskill_pddl.learning.report import LeftOut
from symskill_pddl.learning.segments import Episode, RestKey
from symskill_pddl.learning.shapes import Shape, ShapeConfig


@dataclass(frozen=True)
class PredicateConfig:
    """When poses count as different, and how wide predicates are."""

    references: ReferenceConfig = field(default_factory=ReferenceConfig)
    articulation: ArticulationConfig = field(default_factory=ArticulationConfig)
    free_shape: ShapeConfig = field(default_factory=ShapeConfig)
    """Rest poses of what moves freely."""
    joint_shape: ShapeConfig = field(default_factory=lambda: ShapeConfig(prior_m=0.006, prior_rad=float(np.radians(2.0))))
    """Rest poses of what is hinged or slides."""
    contact_shape: ShapeConfig = field(
        default_factory=lambda: ShapeConfig(
            floor_m=0.006, floor_rad=float(np.radians(4.0)), prior_m=0.006, prior_rad=float(np.radians(5.0))
        )
    )
    ratio: float = 2.5
    """A gap between clusters is at least this many times the gaps within."""
    free_gap_m: float = 0.12
    """Rests nearer than this are one place; a gap has to be `ratio` times as wide to separate two."""
    vertical_weight: float = 4.0
    """Heights count more than places on a support: two shelves are two predicates, two spots on a counter are one."""
    tilt_m_rad: float = 0.3
    """A tilt of one radian counts as this distance: what lies on its side is somewhere else."""
    static_gap_m: float = 0.5
    """An object that nobody moved widens a cluster if it rests within this of a member, at its height and tilt."""
    hinge_gap_rad: float = float(np.radians(18.0))
    """Rests of what is hinged that are nearer than this are one place: people open a door a little more or less."""
    slide_gap_m: float = 0.04
    """As `hinge_gap_rad`, for what slides."""
    contact_gap_m: float = 0.05
    """Grasps nearer than this, turns included, are one way to hold a thing."""
    contact_m_rad: float = 0.12
    """In that, one radian counts as this distance: about a hand's length from wrist to finger tips."""
    trim: float = 0.10
    """Fraction of a motion that is left out at both ends of the gripper's relative poses."""
    odd_of: int = 3
    """What a single demonstration shows, of a task with at least this many, is odd."""
    joints: Mapping[str, str] = field(default_factory=dict)
    """By type, 'free', 'revolute' or 'prismatic', where a person has said so."""
    symmetry: Mapping[str, Array] = field(default_factory=dict)
    """By type, an axis (3,) about which it looks the same, where a person has said so."""


@dataclass(frozen=True, eq=False)
class Place:
    """One object-at-reference predicate.

    Attributes
    ----------
    types : (str, str)
        The object's and the reference's type.
    shape : Shape
        Of `T_ref_obj`.
    joint : Joint or None
        If the object is hinged or slides in the reference's frame.
    coordinate : float
        Mean joint coordinate [rad] or [m]; 0 without a joint.
    demos : frozenset of str
        Demonstrations that showed it by moving something there or away.
    margin : float
        How clear the choice of the reference was, at least.
    held : bool
        The object is in the hand there, lifted off the reference.
    """

    types: tuple[str, str]
    shape: Shape
    joint: Joint | None
    coordinate: float
    demos: frozenset[str]
    margin: float
    held: bool = False


@dataclass(frozen=True, eq=False)
class Contact:
    """One gripper-in-object predicate.

    Attributes
    ----------
    closes : bool
        The fingers are commanded closed.
    held : bool
        They close on the object.
    fingers : (float, float) or None
        If `held`, between which apertures [m] they have hold of one.
    """

    type: str
    shape: Shape
    closes: bool
    held: bool
    articulated: bool
    demos: frozenset[str]
    fingers: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Label:
    """An episode in terms of predicates: indices into `Relations.places` and `contacts`, with the reference objects."""

    episode: Episode
    contact: int
    start: int | None
    start_ref: str | None
    end: int | None
    end_ref: str | None

    @property
    def ref(self) -> str | None:
        """The object in whose frame the motion is described."""
        return self.end_ref or self.start_ref


@dataclass(frozen=True, eq=False)
class Relations:
    """Predicates without names, and the labelled episodes."""

    places: tuple[Place, ...]
    contacts: tuple[Contact, ...]
    labels: tuple[Label, ...]
    left_out: tuple[LeftOut, ...]
    references: Mapping[RestKey, str] = field(default_factory=dict)
    """By `Rest.key`, the object that it is at."""
