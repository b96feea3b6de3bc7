"""A person edits the exported text; `compare` says what that means."""

import re
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_domains import careless_kitchen, domains, kitchen

from symskill_pddl.errors import InputError
from symskill_pddl.pddl import DIALECTS, Names, compare, read_domain, write_domain
from symskill_pddl.pddl.edit import undone
from symskill_pddl.symbols import Absent, Plan

TEXT = write_domain(kitchen(), dialect="costs")


def edited(*changes, dialect="costs", names=None):
    text = TEXT if names is None else write_domain(names.domain(kitchen()), dialect=dialect)
    for before, after in changes:
        assert text.count(before) >= 1, before
        text = text.replace(before, after, 1)
    return compare(kitchen(), read_domain(text), dialect=dialect, names=names)


def lines(comparison):
    return [str(f) for f in comparison.findings]


@settings(max_examples=40, deadline=None)
@given(st.data(), st.sampled_from(DIALECTS))
def test_an_export_that_nobody_touched_has_no_findings(data, dialect):
    domain = data.draw(domains(quantified=dialect != "strips"))
    comparison = compare(domain, read_domain(write_domain(domain, dialect=dialect)), dialect=dialect)
    assert comparison.findings == ()
    assert [(b.action, b.operator) for b in comparison.bindings] == [(o.name, o.name) for o in domain.operators]


@pytest.mark.parametrize("dialect", DIALECTS)
def test_what_the_dialect_states_is_no_edit(dialect):
    learned = careless_kitchen(at_most_one=True)
    written = read_domain(write_domain(learned, dialect=dialect))
    comparison = compare(learned, written, dialect=dialect)
    assert comparison.findings == ()
    needs = undone(comparison, learned, written).domain.operator("place-lid").absent
    assert {str(a.atom) for a in needs} == ({"(lid-on-pan ?any ?pan)"} if dialect == "strips" else set())


def test_a_quantified_variable_may_be_called_anything():
    assert (
        edited(
            ("(forall (?other - lid) (not (lid-on-pan ?other ?pan)))", "(forall (?l - lid) (not (lid-on-pan ?l ?pan)))")
        ).findings
        == ()
    )


ALLOWED = {
    "more to need": (
        (":precondition (and\n      (gripper-open)", ":precondition (and (gripper-holds-lid ?lid) (gripper-open)"),
        "also needs",
    ),
    "a cost": (("(total-cost) 250", "(total-cost) 900"), "its cost was 250, is 900"),
    "reordered parameters": ((":parameters (?lid - lid ?pan - pan)", ":parameters (?pan - pan ?lid - lid)"), "bound by name"),
    "less to need": (
        ("      (gripper-open)\n      (lid-on-pan ?lid ?pan))", "      (lid-on-pan ?lid ?pan))"),
        "no longer needs \\(gripper-open",
    ),
    "less forbidden": (("\n      (forall (?other - lid) (not (lid-on-pan ?other ?pan)))", ""), "no longer forbids"),
    "a new type": (("    pan - object\n", "    pan - object\n    wok - pan\n"), "type 'wok': added"),
    "a new predicate": (("    (gripper-open)\n", "    (gripper-open)\n    (hot ?pan - pan)\n"), "nothing perceives it"),
    "a subtype": (("?food - food ?pan - pan)\n    :pre", "?food - food ?pan - wok)\n    :pre"), "was a pan, is a wok"),
}


@pytest.mark.parametrize("name", ALLOWED)
def test_what_a_person_may_change(name):
    change, message = ALLOWED[name]
    more = [("    pan - object\n", "    pan - object\n    wok - pan\n")] if name == "a subtype" else []
    comparison = edited(*more, change)
    assert comparison.runs, lines(comparison)
    assert len(comparison.bindings) == 4
    assert any(re.search(message, line) for line in lines(comparison)), lines(comparison)


FORBIDDEN = {
    "a new effect": (
        ("(gripper-holds-lid ?lid)\n      (not", "(gripper-holds-lid ?lid)\n (lid-on-pan ?lid ?pan) (not"),
        "adds .*no demonstration",
    ),
    "a lost effect": (("(gripper-holds-lid ?lid)\n      (not", "(not"), "no longer adds"),
    "a new delete": (
        ("(gripper-holds-food ?food)\n      (not", "(gripper-holds-food ?food)\n (not (gripper-holds-food ?food)) (not"),
        "deletes",
    ),
    "a signature": (("(gripper-holds-lid ?lid - lid)", "(gripper-holds-lid ?lid - object)"), "was 'lid', is 'object'"),
}


@pytest.mark.parametrize("name", FORBIDDEN)
def test_what_makes_an_action_lie(name):
    change, message = FORBIDDEN[name]
    comparison = edited(change)
    assert not comparison.runs
    assert any(line.startswith("error") and re.search(message, line) for line in lines(comparison)), lines(comparison)


def test_an_action_with_a_changed_effect_is_not_bound():
    comparison = edited(FORBIDDEN["a new effect"][0])
    assert "pick-lid" not in {b.action for b in comparison.bindings}
    with pytest.raises(InputError, match="'pick-lid', which no skill belongs to"):
        comparison.plan(Plan((("pick-lid", ("a", "b")),)))


def test_an_added_action_has_no_skill():
    fry = "(:action fry :parameters (?food - food) :precondition (gripper-open) :effect (gripper-holds-food ?food))\n)"
    text = TEXT.rstrip().removesuffix(")") + fry
    comparison = compare(kitchen(), read_domain(text), dialect="costs")
    assert lines(comparison) == [
        "error: action 'fry': no skill belongs to it; skills there are: pick-food, pick-lid, place-food, place-lid"
    ]


def test_a_removed_action_is_a_note():
    domain = read_domain(TEXT)
    comparison = compare(kitchen(), replace(domain, operators=domain.operators[1:]), dialect="costs")
    assert lines(comparison) == ["note: action 'pick-lid': removed; its skill will not be used"]


def test_a_renamed_action_is_known_by_its_effects():
    comparison = edited(("(:action pick-lid", "(:action uncover"))
    assert comparison.runs
    assert lines(comparison) == ["note: action 'uncover': was 'pick-lid', known by its effects"]
    assert comparison.plan(Plan((("uncover", ("l", "p")),))).steps == (("pick-lid", ("l", "p")),)


def test_a_plan_with_reordered_parameters_comes_back_in_order():
    comparison = edited(ALLOWED["reordered parameters"][0])
    assert comparison.plan(Plan((("pick-lid", ("p", "l")),))).steps == (("pick-lid", ("l", "p")),)


def test_renamed_parameters_are_bound_by_position():
    pick = kitchen().operators[0]
    change = {"?lid": "?cover", "?pan": "?pot"}
    new = replace(
        read_domain(TEXT).operators[0],
        parameters=tuple(replace(p, name=change[p.name]) for p in pick.parameters),
        pre=frozenset(a.substitute(change) for a in pick.pre),
        add=frozenset(a.substitute(change) for a in pick.add),
        delete=frozenset(a.substitute(change) for a in pick.delete),
    )
    domain = read_domain(TEXT)
    comparison = compare(kitchen(), replace(domain, operators=(new, *domain.operators[1:])), dialect="costs")
    assert lines(comparison) == ["note: action 'pick-lid': parameters renamed: ?lid -> ?cover ?pan -> ?pot; bound by position"]


def test_a_lost_parameter_is_an_error():
    domain = read_domain(TEXT)
    short = replace(
        domain.operators[1], parameters=domain.operators[1].parameters[:1], add=frozenset(), absent=frozenset[Absent]()
    )
    comparison = compare(
        kitchen(), replace(domain, operators=(domain.operators[0], short, *domain.operators[2:])), dialect="costs"
    )
    assert any("the parameter ?pan is gone" in line for line in lines(comparison))


def test_names_lead_back_to_the_library():
    names = Names.of(kitchen(), ["Egg"], {"pick-lid": "uncover", "pan": "pot"})
    comparison = edited(names=names)
    assert comparison.findings == ()
    plan = comparison.plan(Plan((("pick-food", ("egg", "pan-a")),)), names)
    assert plan.steps == (("pick-food", ("Egg", "pan-a")),)
    assert comparison.bindings[0].action == "uncover"
    assert comparison.bindings[0].operator == "pick-lid"


def test_a_type_that_no_demonstration_shows_is_an_error():
    domain = read_domain(TEXT)
    strange = replace(domain.operators[0], parameters=tuple(replace(p, type="food") for p in domain.operators[0].parameters))
    comparison = compare(kitchen(), replace(domain, operators=(strange, *domain.operators[1:])), dialect="costs")
    assert "error: action 'pick-lid': the parameter ?lid was a lid, is a food, which no demonstration shows" in lines(comparison)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_renamed_predicates_and_types_are_known_by_their_uses(dialect):
    text = write_domain(kitchen(), dialect=dialect)
    for before, after in (("gripper-holds-lid", "has-lid"), ("food-in-pan", "inside")):
        text = re.sub(rf"\({before} ", f"({after} ", text)
    text = re.sub(r"(?m)( - |^    )food(?=[ )]|$)", r"\1snack", text)
    comparison = compare(kitchen(), read_domain(text), dialect=dialect)
    assert lines(comparison) == [
        "note: type 'snack': was 'food', known by its uses",
        "note: predicate 'inside': was 'food-in-pan', known by its uses",
        "note: predicate 'has-lid': was 'gripper-holds-lid', known by its uses",
    ]
    assert len(comparison.bindings) == 4
    assert comparison.names.predicates["food-in-pan"] == "inside"


def test_what_two_could_be_is_taken_for_neither():
    """Two types that stand in the same places nowhere: no guess is made, and the errors say what is the matter."""
    domain = read_domain(TEXT)
    swap = {"gripper-holds-lid": "a", "gripper-holds-food": "b"}

    def moved(atoms):
        return frozenset(replace(x, predicate=swap.get(x.predicate, x.predicate)) for x in atoms)

    operators = tuple(
        replace(o, name=f"my-{o.name}", pre=moved(o.pre), add=moved(o.add), delete=moved(o.delete)) for o in domain.operators
    )
    predicates = tuple(replace(p, name=swap.get(p.name, p.name)) for p in domain.predicates)
    comparison = compare(kitchen(), replace(domain, predicates=predicates, operators=operators), dialect="costs")
    assert not comparison.runs
    assert not any("known by its uses" in line for line in lines(comparison))
