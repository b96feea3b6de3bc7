"""`Belief`: what a run remembers between steps. Atoms and ground steps only."""

from __future__ import annotations

from collections import Counter

from symskill_pddl.execution.monitor import Blame, OverTime, Stalled, Verdict, Violation, Watch
from symskill_pddl.execution.recovery import FailureMemory, StepKey, key_of
from symskill_pddl.symbols import GRIPPER_OPEN, Atom, GroundOperator, State


class Belief:
    """Failures, grasps, owed deletes and assumptions.

    Parameters
    ----------
    gripper : frozenset of str
        Predicates that relate the end effector to an object.
    """

    def __init__(self, gripper: frozenset[str]) -> None:
        self.gripper = gripper
        self.failures = FailureMemory()
        self.assumptions: Counter[Atom] = Counter()
        """How often each atom was planned with without being observed."""
        self.blocked: dict[StepKey, int] = {}
        """Steps that were held up the last time, and in which phase: they begin otherwise. Every other time."""
        self._acquired: dict[Atom, GroundOperator] = {}
        self._pending: State = frozenset()

    def held(self, state: State) -> frozenset[str]:
        """The objects that gripper relations speak of."""
        return frozenset(a.args[0] for a in state if a.predicate in self.gripper and a.args)

    def empty_fist(self, state: State) -> bool:
        """The fingers are closed on nothing: a state that no operator starts from."""
        return Atom(GRIPPER_OPEN) not in state and not self.held(state)

    def pending(self, state: State) -> State:
        """Deletes that are still owed: the object is in the hand and has not left its place."""
        held = self.held(state)
        self._pending = frozenset(a for a in self._pending & state if a.args and a.args[0] in held)
        return self._pending

    def goal_reached(self, goal: State, state: State) -> bool:
        """The goal holds, and what it speaks of is not in the closed hand, unless the goal says so."""
        if not goal <= state:
            return False
        spoken = {name for a in goal for name in a.args} - self.held(goal)
        return Atom(GRIPPER_OPEN) in state or not self.held(state) & spoken

    def succeeded(self, watch: Watch) -> None:
        """A step has had its effects: forget its failures.

        A grasp has proven itself only when the step that lets go of the object has succeeded, so a step that acquired one
        keeps its failures until then. Otherwise a grasp that is always lost on the way would be tried the same way for ever.
        """
        step = watch.step
        self.blocked.pop(key_of(step), None)
        self._pending = watch.pending
        gained = [a for a in step.add if a.predicate in self.gripper]
        for atom in gained:
            self._acquired[atom] = step
        if not gained:
            self.failures = self.failures.clear(key_of(step))
        for atom in step.delete:
            if atom in self._acquired:
                self.failures = self.failures.clear(key_of(self._acquired.pop(atom)))

    def jumped(self) -> None:
        """Steps were passed over: nothing is owed."""
        self._pending = frozenset()

    def held_up(self, step: GroundOperator, stage: int) -> None:
        """The step's motion was blocked in a phase. Twice in a row is no reason to begin otherwise once more."""
        key = key_of(step)
        if self.blocked.pop(key, None) is None:
            self.blocked[key] = stage

    def slipped_off(self, watch: Watch, verdict: Verdict) -> bool:
        """Whether the open hand has lost what it pushes: nothing held on to it, and no fingers let go of it."""
        if not (isinstance(verdict, Violation) and verdict.blame is Blame.OWN):
            return False
        return Atom(GRIPPER_OPEN) in watch.start_state and any(a.predicate in self.gripper for a in verdict.atoms)

    def blame(self, watch: Watch, verdict: Verdict) -> None:
        """Enter a verdict into the failure memory."""
        guilty: list[GroundOperator] = []
        match verdict:
            case Violation(atoms=atoms) if self.slipped_off(watch, verdict):
                # got hold of badly, or pushed badly: nobody can tell which
                guilty = [watch.step, *(self._acquired[a] for a in atoms if a in self._acquired)]
            case Stalled() | OverTime() | Violation(blame=Blame.OWN):
                guilty = [watch.step]
            case Violation(blame=Blame.ACQUIRING, atoms=atoms):
                guilty = [self._acquired[a] for a in atoms if a in self._acquired]
            case _:
                pass
        for step in guilty:
            self.failures = self.failures.blame(key_of(step))
