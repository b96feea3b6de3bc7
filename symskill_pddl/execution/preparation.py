"""A plan's step made ready: what the monitor watches, and the skill bound to the step's objects."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from symskill_pddl.execution.around import Obstacles, Strangers
from symskill_pddl.execution.belief import Belief
from symskill_pddl.execution.body import Body
from symskill_pddl.execution.config import ExecutionConfig
from symskill_pddl.execution.deliberation import Deliberation, Planned
from symskill_pddl.execution.monitor import Watch
from symskill_pddl.execution.recovery import goal_phase, goal_shift, key_of, later_leg, way_in
from symskill_pddl.execution.runner import SkillRun
from symskill_pddl.library import Library
from symskill_pddl.skills import Skill
from symskill_pddl.symbols import GroundOperator, State


class Preparation:
    """Makes the steps of one run ready, one after another."""

    def __init__(
        self,
        library: Library,
        config: ExecutionConfig,
        extents: Mapping[str, tuple[float, float, float]],
        rng: np.random.Generator,
        body: Body,
        belief: Belief,
        mind: Deliberation,
    ) -> None:
        self._library, self._config, self._extents, self._rng = library, config, extents, rng
        self._body, self._belief, self._mind = body, belief, mind

    def ready(self, planned: Planned, index: int, blind: bool = False) -> tuple[Watch, SkillRun, int]:
        """What the monitor watches; the skill bound to its objects, resampled if the step has failed before; how often it has."""
        step, config = planned.steps[index], self._config
        learned = self._library.learned(step.name)
        skill = self._library.skills[learned.skill]
        binding = dict(zip((p.name for p in learned.operator.parameters), step.args, strict=True))
        first = 0 if self.bound(step) else self._begin_otherwise(step, skill, binding, planned.assumed)
        state = self._body.state
        attempt = self._belief.failures.count(key_of(step))
        shift = None
        if attempt and config.resample:
            radius = min(config.sample_most, attempt * config.sample_growth)
            shift = goal_shift(step, skill, binding, self._library.classifiers, self._body.scene, self._rng, radius)
        avoided, strange = self._obstacles(step)
        run = SkillRun(
            skill,
            binding,
            self._body.scene,
            config.motion,
            shift=shift,
            first=first,
            awaited=self._awaited(step, skill, binding) if learned.kind == "move" and not blind else None,
            obstacles=avoided,
            strange=strange,
        )
        # what is hinged or slides cannot be dropped, and the hand may let go of it and push on
        hinged_s = learned.duration_s[1] if learned.kind == "move" else 0.0
        watch = Watch(
            step=step,
            index=index,
            later=planned.steps[index + 1 :],
            gripper=self._belief.gripper,
            start_s=self._body.now,
            start_state=state,
            inherited=self._belief.pending(state),
            assumed=planned.assumed,
            phases=run.phases,
            exit_s=skill.phases[-1].duration_s,
            budget_s=config.budget_factor * learned.duration_s[1] + config.budget_margin_s,
            grace_s=config.grace_s + hinged_s,
            stall_s=config.stall_s,
            blocked_s=config.blocked_s,
            still_speed=config.still_speed,
            still_turn=config.still_turn,
        )
        return watch, run, attempt

    def bound(self, step: GroundOperator) -> bool:
        """Whether the hand holds what is hinged or slides: neither goes anywhere else, and back would undo what is done."""
        return self._library.learned(step.name).kind == "move" and self._body.scene.gripper_closed

    def _obstacles(self, step: GroundOperator) -> tuple[Obstacles | None, Strangers | None]:
        """What the hand flows around: things of types that were shown, and others, which the whole hand keeps away from."""
        config = self._config.motion
        if not (config.avoid and self._extents):
            return None, None
        spared = frozenset(step.args) | self._belief.held(self._body.state)
        objects, shown = self._body.scene.objects, {t.name for t in self._library.types}
        known = {kind: half for kind, half in self._extents.items() if kind in shown}
        other = {kind: half for kind, half in self._extents.items() if kind not in shown}
        avoided = Obstacles(objects, known, spared, config, self._body.velocities)
        if not any(kind in other for kind in objects.values()):
            return avoided, None
        return avoided, Strangers(objects, other, spared, config, self._body.velocities)

    def _awaited(self, step: GroundOperator, skill: Skill, binding: Mapping[str, str]) -> tuple[int, Callable[[], bool]] | None:
        """The phase that brings what is hinged or slides to its place, and whether it is there."""
        effects = frozenset(a for a in step.add if len(a.args) > 1 and a.predicate not in self._belief.gripper)
        found = [goal_phase(skill, binding, a.args[-1], grasp=False) for a in effects]
        places = [place for place in found if place is not None]
        return (max(places), lambda: effects <= self._body.state) if places else None

    def _begin_otherwise(self, step: GroundOperator, skill: Skill, binding: Mapping[str, str], assumed: State) -> int:
        """A step that was blocked from where it began is begun elsewhere, or with a later phase; the phase to begin with."""
        blocked = self._belief.blocked.get(key_of(step))
        if blocked is None or not step.pre <= self._body.state | assumed:
            return 0
        first = later_leg(skill, blocked)
        begin = None if first else way_in(skill, binding, self._body.scene)
        if begin is not None:
            self._mind.begin_at(begin, f"{step} was blocked from where it began")
        return first
