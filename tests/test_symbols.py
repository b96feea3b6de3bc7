from dataclasses import replace

import pytest
from random_domains import atoms, covered_egg, kitchen

from symskill_pddl.errors import InputError
from symskill_pddl.symbols import (
    Absent,
    Atom,
    Domain,
    Operator,
    Parameter,
    Plan,
    Predicate,
    Type,
    check_domain,
    check_problem,
    validate,
)

GOOD = (
    ("pick-lid", ("lid-a", "pan-a")),
    ("place-lid", ("lid-a", "pan-c")),
    ("pick-food", ("egg", "pan-a")),
)


def test_an_action_deletes_before_it_adds():
    op = Operator("swap", (), frozenset(), atoms("p"), atoms("p, q"))
    step = Domain("d", (), (Predicate("p"), Predicate("q")), (op,)).ground(op, (), {})
    assert step.apply(atoms("q")) == atoms("p")


def test_protected_is_what_is_maintained_and_not_deleted():
    op = kitchen().operator("pick-food")
    assert op.protected == frozenset()
    assert replace(op, maintain=op.maintain | atoms("gripper-holds-food ?food")).protected == atoms("gripper-holds-food ?food")


def test_absent_expands_over_every_object_of_the_type():
    domain, problem = kitchen(), covered_egg()
    step = domain.ground(domain.operator("pick-food"), ("egg", "pan-a"), problem.object_types)
    assert step.absent == atoms("lid-on-pan lid-a pan-a, lid-on-pan lid-b pan-a")
    assert not step.applicable(problem.init)
    assert step.applicable(problem.init - atoms("lid-on-pan lid-a pan-a"))


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (("egg",), "takes 2 arguments"),
        (("egg", "wok"), "unknown object 'wok'"),
        (("lid-a", "pan-a"), "needs a food for \\?food, 'lid-a' is a lid; objects that fit: egg"),
    ],
)
def test_grounding_refuses(args, message):
    domain = kitchen()
    with pytest.raises(InputError, match=message):
        domain.ground(domain.operator("pick-food"), args, covered_egg().object_types)


def test_distinct_parameters_take_distinct_objects():
    op = Operator("stack", (Parameter("?a", "pan"), Parameter("?b", "pan")), frozenset(), frozenset(), frozenset())
    with pytest.raises(InputError, match="different object"):
        kitchen().ground(op, ("pan-a", "pan-a"), covered_egg().object_types)


def test_is_a_follows_the_parents_and_survives_a_cycle():
    domain = Domain("d", (Type("egg", "food"), Type("food"), Type("x", "y"), Type("y", "x")), (), ())
    assert domain.is_a("egg", "food")
    assert domain.is_a("egg", "object")
    assert not domain.is_a("food", "egg")
    assert not domain.is_a("x", "food")


@pytest.mark.parametrize(
    "make",
    [
        lambda: Parameter("food", "food"),
        lambda: Operator("o", (Parameter("?a", "t"), Parameter("?a", "t")), frozenset(), frozenset(), frozenset()),
        lambda: Operator("o", (), atoms("p ?x"), frozenset(), frozenset()),
        lambda: Operator("o", (), frozenset(), frozenset(), frozenset(), absent=frozenset({Absent(Atom("p", ("?x",)))})),
        lambda: Domain("d", (Type("a"), Type("a")), (), ()),
        lambda: Domain("d", (Type("a", "b"),), (), ()),
        lambda: kitchen().operator("fry"),
        lambda: kitchen().predicate("fried"),
    ],
)
def test_what_is_wrong_is_refused(make):
    with pytest.raises(InputError):
        make()


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        (GOOD[2:], "plan step 1 .* forbids \\(lid-on-pan lid-a pan-a\\)"),
        (GOOD[1:], "plan step 1 .* needs \\(gripper-holds-lid lid-a\\)"),
        ((*GOOD[:1], ("fry", ())), "plan step 2: unknown operator 'fry'"),
        (GOOD, "ends without the goal \\(food-in-pan egg pan-b\\)"),
    ],
)
def test_validate_says_where_a_plan_fails(steps, message):
    with pytest.raises(InputError, match=message):
        validate(kitchen(), covered_egg(), Plan(steps))


def test_validate_takes_a_good_plan():
    validate(kitchen(), replace(covered_egg(), goal=atoms("gripper-holds-food egg")), Plan(GOOD))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"predicates": ()}, "unknown predicate"),
        ({"types": (Type("food"), Type("lid"))}, "unknown type 'pan'"),
        ({"predicates": (*kitchen().predicates[1:], Predicate("food-in-pan", ("food",)))}, "takes 1 arguments, got 2"),
        (
            {"predicates": (*kitchen().predicates[1:], Predicate("food-in-pan", ("lid", "pan")))},
            "needs the type lid where",
        ),
    ],
)
def test_an_ill_formed_domain_is_refused(change, message):
    check_domain(kitchen())
    with pytest.raises(InputError, match=message):
        check_domain(replace(kitchen(), **change))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"objects": (("egg", "meal"),)}, "unknown type 'meal'"),
        ({"objects": (("egg", "food"), ("egg", "food"))}, "twice"),
        ({"goal": atoms("food-in-pan egg wok")}, "goal: .* unknown object 'wok'"),
        ({"init": atoms("gripper-holds-food lid-a")}, "init: .* needs the type food"),
    ],
)
def test_an_ill_formed_problem_is_refused(change, message):
    check_problem(kitchen(), covered_egg())
    with pytest.raises(InputError, match=message):
        check_problem(kitchen(), replace(covered_egg(), **change))


def pair_up(distinct):
    xy = (Parameter("?x", "object"), Parameter("?y", "object"))
    op = Operator("greet", xy, frozenset(), frozenset({Atom("met", ("?x", "?y"))}), frozenset(), distinct=distinct)
    return Domain("d", (), (Predicate("met", ("object", "object")),), (op,))


def test_parameters_may_coincide_where_nothing_says_otherwise():
    free, objects = pair_up(frozenset()), {"home": "object", "away": "object"}
    assert free.ground(free.operators[0], ("home", "home"), objects).add == {Atom("met", ("home", "home"))}
    learned = pair_up(None)
    with pytest.raises(InputError, match=r"different objects for \?x and \?y"):
        learned.ground(learned.operators[0], ("home", "home"), objects)
    assert pair_up(frozenset({("?x", "?y")})) == learned
    with pytest.raises(InputError, match="in their order"):
        pair_up(frozenset({("?y", "?x")}))
