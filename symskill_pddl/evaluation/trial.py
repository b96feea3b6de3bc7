"""One episode: from its task and seed to a problem, and from the problem to an outcome."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symskill_pddl.abstraction import abstract, one_place
from symskill_pddl.arena import Disturbed, OpenEpisode
from symskill_pddl.evaluation.goals import goal_atoms, resting_atoms
from symskill_pddl.evaluation.posed import placed, unlike
from symskill_pddl.evaluation.results import EpisodeResult, count
from symskill_pddl.execution.config import ExecutionConfig
from symskill_pddl.execution.executor import execute
from symskill_pddl.execution.lines import Header, NoteLine
from symskill_pddl.execution.outcome import Category, Cause, Outcome
from symskill_pddl.execution.recovery import Assumption, nearest_symbols
from symskill_pddl.execution.trace import TraceWriter
from symskill_pddl.library import Library
from symskill_pddl.pddl import Names, read_atoms
from symskill_pddl.planning import Planner
from symskill_pddl.symbols import Domain, Problem, State
from symskill_pddl.worlds import DEFAULT, arena_named, check_seed, check_task

JUDGE = "judge disagrees"
"""Category of a run whose goal atoms hold and whose judge, who sees the simulator's own state, saw no success."""


@dataclass(frozen=True, eq=False)
class Episode:
    """An episode, as a problem.

    Attributes
    ----------
    world : OpenEpisode
    name : str
        Of its world, as for `worlds.arena_named`.
    domain : Domain
        The library's, under the library's own names.
    problem : Problem
        Objects of the types that the library knows, the atoms of the first scene and the assumed ones, and the goal.
    assumed : tuple of Assumption
        Atoms that stand in for objects in no known relation: the nearest one each (a door between its known places). The
        executor makes its own assumptions from what it sees then.
    judged : bool
        Whether the task's judge can say if this goal was reached; not so for a goal that the caller stated.
    notes : tuple of str
        How the first scene differs from the problem that the caller posed.
    """

    world: OpenEpisode
    name: str
    domain: Domain
    problem: Problem
    judged: bool
    assumed: tuple[Assumption, ...] = ()
    notes: tuple[str, ...] = ()


def prepare(
    library: Library,
    task: str,
    seed: int,
    *,
    world: str = DEFAULT,
    goal: str | None = None,
    posed: Problem | None = None,
    disturbances: Sequence[str] = (),
    domain_name: str = "learned",
) -> Episode:
    """Draw an episode and read its first scene.

    Parameters
    ----------
    world : str
        Which arena it is in, as for `arena.arena_named`.
    goal : str, optional
        ``(atom object ...) ...`` instead of the learned goal of the task; names as in the library or as exported.
    posed : Problem, optional
        Its objects and its goal instead of the task's; see `posed.placed`. The initial state is what the robot sees.

    Raises
    ------
    InputError
        Unknown world, task or disturbance, a negative seed, no learned goal, or a goal or problem that does not fit the
        library or the scene.
    """
    arena = arena_named(world)
    check_task(arena, task)
    check_seed(seed)
    for spec in disturbances:
        arena.check_disturbance(spec)
    opened = arena.open(task, seed, disturbances)
    scene = opened.observe()
    domain = library.domain(domain_name)
    known = {t.name for t in library.types}
    objects = {name: kind for name, kind in scene.objects.items() if kind in known}
    own = placed(posed, domain, objects) if posed is not None else None
    if own is not None:
        objects = own.object_types
    seen = one_place(abstract(scene, library.classifiers, gripper=library.gripper), library.classifiers)
    init = frozenset(atom for atom in seen if all(a in objects for a in atom.args))
    if goal is not None:
        atoms = stated_goal(goal, domain, objects)
    elif own is not None:
        atoms = own.goal
    elif opened.placements:
        atoms = resting_atoms(library, opened.placements, objects)
    else:
        atoms = goal_atoms(library, opened.goals, objects)
    nearest = nearest_symbols(scene, init, library.classifiers, objects).values()
    # what is only assumed may not fulfil the goal
    assumed = tuple(best for options in nearest if (best := next((a for a in options if a.atom not in atoms), None)) is not None)
    init |= {a.atom for a in assumed}
    problem = Problem(f"{task}-{seed}".lower(), domain.name, tuple(objects.items()), init, atoms)
    notes = unlike(own.init, init) if own is not None else ()
    return Episode(opened, world, domain, problem, goal is None and own is None, assumed, notes)


def stated_goal(text: str, domain: Domain, objects: dict[str, str]) -> State:
    """Goal atoms from text, by exported names or by the library's own.

    Raises
    ------
    InputError
        No atom, an unknown predicate or object, wrong number or types of arguments.
    """
    names = Names.of(domain, objects)
    exported = names.domain(domain)
    types = {names.objects[name]: names.types.get(kind, kind) for name, kind in objects.items()}
    # an object may also be called what it is called in the scene, unless that is another thing's exported name
    types |= {name: names.types.get(kind, kind) for name, kind in objects.items() if name not in types}
    return names.inverse().atoms(read_atoms(text, exported, types, "--goal"))


def run_episode(
    library: Library,
    episode: Episode,
    seed: int,
    planner: Planner,
    *,
    domain: Domain | None = None,
    monitor: bool = True,
    config: ExecutionConfig | None = None,
    trace: TraceWriter | None = None,
    library_checksum: str = "",
    on_event: Callable[[Any], None] | None = None,
) -> tuple[EpisodeResult, Outcome]:
    """Execute an episode. It is a success if its judge says so, or, where the goal was stated, if the goal atoms hold."""
    world, problem = episode.world, episode.problem
    disturbed = world if isinstance(world, Disturbed) else None
    told = 0

    def heard(line: Any) -> None:
        nonlocal told
        if on_event is not None:
            on_event(line)
        for time, text in disturbed.events[told:] if disturbed is not None else ():
            told += 1
            note = NoteLine(time=time, text=f"disturbance {text}")
            if trace is not None:
                trace.write(note)
            if on_event is not None:
                on_event(note)

    outcome = execute(
        world,
        library,
        domain or episode.domain,
        problem.goal,
        planner,
        config,
        objects=problem.object_types,
        extents=world.extents,
        rng=np.random.default_rng([seed, 2]),
        trace=trace,
        header=Header(
            # traces of the default world are as they were when there was no other
            world="" if episode.name == DEFAULT else episode.name,
            task=world.task,
            seed=seed,
            library=library_checksum,
            planner=planner.name,
        ),
        on_event=heard,
        on_step=(lambda index, _step: disturbed.notify_step(index)) if disturbed is not None else None,
        monitor=monitor,
    )
    success = world.succeeded() if episode.judged else outcome.success
    category, cause, reason = str(outcome.category), str(outcome.cause or ""), outcome.reason
    if outcome.success and not success:
        category, cause, reason = JUDGE, str(Cause.PERCEPTION), "the goal atoms hold, the judge sees no success"
    elif success:
        category, cause = str(Category.SUCCESS), ""
    return (
        EpisodeResult(
            seed=seed,
            success=success,
            category=category,
            cause=cause,
            troubles=count(outcome.troubles),
            disturbances=len(disturbed.events) if disturbed is not None else 0,
            touched_s=disturbed.touched_s if disturbed is not None else 0.0,
            reason=reason,
            replans=outcome.replans,
            recoveries=len(outcome.recoveries),
            steps=len(outcome.steps),
            time_s=round(outcome.time_s, 3),
        ),
        outcome,
    )
