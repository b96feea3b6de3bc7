"""Every dialect says the same as `symbols`: nothing that can be reached is lost, and nothing is added."""

from dataclasses import replace
from itertools import product

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from random_domains import NO_LID, atoms, careless_kitchen, covered_egg, domains, kitchen, problems

from symskill_pddl.errors import InputError
from symskill_pddl.pddl import DIALECTS, exported, expressible, read_domain, write_domain
from symskill_pddl.pddl.dialect import fresh, requirements, unifiable
from symskill_pddl.symbols import Absent, Atom, Domain, Operator, Parameter, Predicate, Problem, Type

STACK = Operator(
    "stack",
    (Parameter("?a", "pan"), Parameter("?b", "pan")),
    frozenset(),
    frozenset({Atom("on", ("?a", "?b"))}),
    frozenset(),
)
PANS = Domain("pans", (Type("pan"),), (Predicate("on", ("pan", "pan")),), (STACK,))


def walk(domain, problem, seed_steps=6):
    """All states within a few steps, as sets of atoms."""
    objects = problem.object_types
    layer, seen = {problem.init}, {problem.init}
    steps = []
    for op in domain.operators:
        pools = [[o for o, t in objects.items() if domain.is_a(t, p.type)] for p in op.parameters]
        steps += [domain.ground(op, args, objects) for args in product(*pools) if len(set(args)) == len(args)]
    for _ in range(seed_steps):
        layer = {s.apply(state) for state in layer for s in steps if s.applicable(state)} - seen
        seen |= layer
        if len(seen) > 400:
            break
    return seen, steps


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_strips_reaches_the_same_states(data):
    domain = data.draw(domains())
    problem = data.draw(problems(domain))
    try:
        form = exported(domain, "strips")
        compiled = form.problem(problem)
    except InputError:
        assume(False)
    assert not any(op.absent for op in form.domain.operators)
    names = {p.name for p in domain.predicates}
    seen, _ = walk(domain, problem, 3)
    there, _ = walk(form.domain, compiled, 3)
    if len(seen) <= 400:
        assert {frozenset(a for a in state if a.predicate in names) for state in there} == seen


def test_the_complement_of_a_quantifier_is_true_where_the_quantifier_holds():
    """In every state that can be reached, not only at the start."""
    form = exported(kitchen(), "strips")
    (none,) = form.complements
    seen, _ = walk(form.domain, form.problem(covered_egg()), 12)
    assert len(seen) > 50
    for state in seen:
        covered = {a.args[1] for a in state if a.predicate == "lid-on-pan"}
        assert {a.args[0] for a in state if a.predicate == none.name} == {"pan-a", "pan-b", "pan-c", "pan-d"} - covered
    original, _ = walk(kitchen(), covered_egg(), 12)
    assert {frozenset(a for a in state if a.predicate != none.name) for state in seen} == original


def test_a_quantified_negative_becomes_one_predicate():
    form = exported(kitchen(), "strips")
    place = form.domain.operator("place-food")
    assert atoms("none-lid-on-pan ?pan") <= place.pre
    assert atoms("none-lid-on-pan ?pan") <= form.domain.operator("pick-lid").add
    assert atoms("none-lid-on-pan ?pan") <= form.domain.operator("place-lid").delete
    assert {a for a in form.problem(covered_egg()).init if a.predicate.startswith("none")} == atoms(
        "none-lid-on-pan pan-c, none-lid-on-pan pan-d"
    )


def test_strips_refuses_what_it_cannot_keep_and_names_the_operator():
    domain = careless_kitchen(at_most_one=False)
    with pytest.raises(InputError, match=r"operator 'place-lid': it adds .* use 'negative'"):
        exported(domain, "strips")
    assert "forall" in write_domain(domain, dialect="negative")
    assert expressible(domain) == DIALECTS[1:]
    assert expressible(kitchen()) == DIALECTS


def test_what_was_observed_is_stated_and_asked_for():
    domain = careless_kitchen(at_most_one=True)
    assert expressible(domain) == DIALECTS
    form = exported(domain, "strips")
    assert [(s.operator, str(s.effect), str(s.needs)) for s in form.stated] == [
        ("place-lid", "(lid-on-pan ?lid ?pan)", "(none-lid-on-pan ?pan)")
    ]
    assert form.domain == exported(kitchen(), "strips").domain
    assert not exported(kitchen(), "strips").stated
    text = write_domain(domain, dialect="strips", comments={"place-lid": ("skill place-lid",)})
    assert (
        "  ; skill place-lid\n"
        "  ; stated: at most one lid with (lid-on-pan ?lid ?pan) at a time, as in all demonstrations, so (none-lid-on-pan ?pan) "
        "is needed\n  (:action place-lid\n"
    ) in text
    for dialect in DIALECTS:
        text = write_domain(domain, dialect=dialect)
        assert read_domain(text) == exported(domain, dialect).domain
        assert dialect == "strips" or text == write_domain(careless_kitchen(at_most_one=False), dialect=dialect)


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(problems(careless_kitchen(at_most_one=True), 5))
def test_what_is_reached_under_a_stated_condition_is_reached_without(problem):
    domain = careless_kitchen(at_most_one=True)
    form = exported(domain, "strips")
    try:
        compiled = form.problem(problem)
    except InputError:  # two lids on a pan at the start
        assume(False)
    names = {p.name for p in domain.predicates}
    lids = {o for o, t in problem.objects if t == "lid"}
    steps = walk(domain, problem, 0)[1]
    layer, seen = {compiled.init}, {compiled.init}
    grounded = walk(form.domain, compiled, 0)[1]
    for _ in range(4):
        following = set()
        for state, (plain, step) in product(layer, zip(steps, grounded, strict=True)):
            assert (plain.name, plain.args) == (step.name, step.args)
            if step.applicable(state):
                before = frozenset(a for a in state if a.predicate in names)
                assert plain.applicable(before)
                after = step.apply(state)
                assert plain.apply(before) == frozenset(a for a in after if a.predicate in names)
                for pan in (o for o, t in problem.objects if t == "pan"):
                    on = {a.args[0] for a in after if a.predicate == "lid-on-pan" and a.args[1] == pan} & lids
                    assert len(on) + (Atom("none-lid-on-pan", (pan,)) in after) == 1
                following.add(after)
        layer = following - seen
        seen |= layer


def test_an_operator_that_puts_a_second_beside_the_first_is_refused_in_spite_of_the_observation():
    domain = careless_kitchen(at_most_one=True)
    place = domain.operator("place-lid")
    stacks = replace(
        place, name="stack-lid", parameters=(*place.parameters, Parameter("?under", "lid")), pre=atoms("lid-on-pan ?under ?pan")
    )
    with pytest.raises(InputError, match=r"operator 'stack-lid': it adds .* use 'negative'"):
        exported(replace(domain, operators=(*domain.operators, stacks)), "strips")


def test_strips_refuses_a_blind_delete():
    blind = replace(kitchen().operator("pick-lid"), pre=atoms("gripper-open"))
    domain = replace(kitchen(), operators=(*kitchen().operators[1:], blind))
    with pytest.raises(InputError, match=r"operator 'pick-lid': it deletes .* without requiring it"):
        exported(domain, "strips")


def test_strips_refuses_a_start_with_two_lids_on_one_pan():
    form = exported(kitchen(), "strips")
    crowded = replace(covered_egg(), init=covered_egg().init | atoms("lid-on-pan lid-b pan-a"))
    with pytest.raises(InputError, match="hold together"):
        form.problem(crowded)


def test_strips_refuses_a_quantifier_with_a_variable_twice():
    twice = Absent(Atom("on", ("?x", "?x")), (Parameter("?x", "pan"),))
    with pytest.raises(InputError, match=r"operator 'stack'.*stands there twice"):
        exported(replace(PANS, operators=(replace(STACK, absent=frozenset({twice})),)), "strips")


def test_strips_refuses_a_narrow_quantifier_over_a_wide_effect():
    no_lid = Absent(Atom("here", ("?l",)), (Parameter("?l", "lid"),))
    domain = Domain(
        "d",
        (Type("thing"), Type("lid", "thing")),
        (Predicate("here", ("thing",)),),
        (
            Operator("bring", (Parameter("?t", "thing"),), frozenset(), atoms("here ?t"), frozenset()),
            Operator(
                "go",
                (),
                frozenset(),
                frozenset(),
                frozenset(),
                absent=frozenset({no_lid}),
            ),
        ),
    )
    with pytest.raises(InputError, match=r"operator 'bring'.*cannot tell whether"):
        exported(domain, "strips")


def test_distinct_objects_are_said_where_two_parameters_could_be_one():
    assert unifiable(PANS, STACK) == (("?a", "?b"),)
    form = exported(PANS, "strips")
    assert Atom("different", ("?a", "?b")) in form.domain.operator("stack").pre
    problem = form.problem(Problem("p", "pans", (("x", "pan"), ("y", "pan")), frozenset(), frozenset()))
    assert problem.init == atoms("different x y, different y x")
    assert "(not (= ?a ?b))" in write_domain(PANS, dialect="negative")
    assert ":equality" in requirements(exported(PANS, "negative"))
    assert ":equality" not in requirements(exported(kitchen(), "negative"))


def test_new_predicates_never_take_a_name_that_is_there():
    assert fresh("pan", kitchen()) == "pan-2"
    taken = replace(kitchen(), predicates=(*kitchen().predicates, Predicate("none-lid-on-pan", ("pan",))))
    form = exported(taken, "strips")
    assert form.complements[0].name == "none-lid-on-pan-2"


def test_requirements_are_those_used():
    plain = replace(kitchen(), operators=tuple(replace(o, absent=frozenset()) for o in kitchen().operators))
    assert requirements(exported(plain, "negative")) == (":strips", ":typing")
    assert requirements(exported(kitchen(), "strips")) == (":strips", ":typing")
    assert requirements(exported(kitchen(), "costs")) == (
        ":strips",
        ":typing",
        ":negative-preconditions",
        ":universal-preconditions",
        ":action-costs",
    )
    single = replace(plain, operators=(replace(plain.operator("pick-food"), absent=frozenset({Absent(Atom("gripper-open"))})),))
    assert requirements(exported(single, "negative")) == (":strips", ":typing", ":negative-preconditions")
    assert requirements(exported(Domain("d", (), (Predicate("p"),), ()), "strips")) == (":strips",)


def test_an_unknown_dialect_lists_those_there_are():
    with pytest.raises(InputError, match="unknown dialect 'adl'; there are: costs, negative, strips, temporal"):
        exported(kitchen(), "adl")
    assert set(DIALECTS) == {"strips", "negative", "costs", "temporal"}


def test_the_same_condition_is_compiled_once():
    assert len(exported(kitchen(), "strips").complements) == 1
    assert NO_LID in kitchen().operator("pick-food").absent
