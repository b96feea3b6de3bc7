from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_domains import atoms, covered_egg, domains, kitchen, problems

from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.pddl import (
    DIALECTS,
    Names,
    exported,
    load_names,
    load_renames,
    read_domain,
    read_problem,
    write_domain,
    write_problem,
)
from symskill_pddl.pddl.names import RESERVED, check_domain_names, check_name, legal
from symskill_pddl.symbols import Atom, Domain, Operator, Parameter, Plan, Predicate, Problem, Type


@given(st.text(max_size=30))
def test_every_identifier_has_a_legal_name(identifier):
    check_name(legal(identifier), "name")


@pytest.mark.parametrize(
    ("identifier", "name"),
    [
        ("Bottle Crate 2", "bottle-crate-2"),
        ("3d", "x3d"),
        ("object", "object-1"),
        ("käse", "kase"),
        ("", "x"),
        ("--", "x"),
        ("and", "and-1"),
    ],
)
def test_legal_names(identifier, name):
    assert legal(identifier) == name


UGLY = Domain(
    "ugly",
    (Type("Food"), Type("food"), Type("2nd Food", "Food")),
    (Predicate("and", ("Food",)), Predicate("food", ("2nd Food",))),
    (
        Operator(
            "and",
            (Parameter("?A", "Food"), Parameter("?a", "2nd Food")),
            atoms("and ?A"),
            atoms("food ?a"),
            frozenset(),
        ),
    ),
)


def test_names_that_pddl_cannot_take_become_different_ones():
    problem = Problem("p", "ugly", (("food", "food"), ("Food", "2nd Food")), atoms("and Food"), atoms("food Food"))
    names = Names.of(UGLY, problem.object_types)
    exported = names.domain(UGLY)
    check_domain_names(exported)
    write_domain(exported)
    write_problem(names.problem(problem), exported)
    assert names.inverse().domain(exported) == UGLY
    assert names.inverse().problem(names.problem(problem)) == problem
    plan = Plan((("and", ("Food", "food")),))
    assert names.plan(plan) != plan
    assert names.inverse().plan(names.plan(plan)) == plan


@settings(max_examples=50, deadline=None)
@given(st.data())
def test_names_are_reversible(data):
    domain = data.draw(domains())
    problem = data.draw(problems(domain))
    identifiers = sorted({x.name for x in (*domain.types, *domain.predicates, *domain.operators)} | set(problem.object_types))
    wishes = st.sampled_from(["alpha", "beta", "gamma", *identifiers])
    renames = data.draw(st.dictionaries(st.sampled_from(identifiers), wishes, max_size=3))
    try:
        names = Names.of(domain, problem.object_types, renames)
    except InputError:
        assert len(set(renames.values())) < len(renames)
        return
    assert names.inverse().domain(names.domain(domain)) == domain
    assert names.inverse().problem(names.problem(problem)) == problem
    assert Names.model_validate_json(names.dumps()) == names
    assert all(getattr(names, kind)[k] == v for k, v in renames.items() for kind in ("types",) if k in names.types)


def test_an_object_named_like_its_type_is_told_apart():
    names = Names.of(kitchen(), ["pan", "egg"])
    assert names.objects == {"pan": "pan-1", "egg": "egg"}


def test_the_domain_has_the_same_names_with_and_without_objects():
    with_objects = Names.of(kitchen(), ["pan", "pick-lid", "egg"])
    assert with_objects.model_copy(update={"objects": {}}) == Names.of(kitchen())


def test_renames():
    names = Names.of(kitchen(), ["egg"], {"pick-lid": "uncover", "egg": "boiled-egg", "pan": "pot"})
    assert (names.operators["pick-lid"], names.objects["egg"], names.types["pan"]) == ("uncover", "boiled-egg", "pot")
    assert "(:action uncover" in write_domain(names.domain(kitchen()))


@pytest.mark.parametrize(
    ("renames", "message"),
    [
        ({"fry": "cook"}, "cannot rename 'fry', there is no such name"),
        ({"pick-lid": "Uncover"}, "not a PDDL name"),
        ({"pick-lid": "forall"}, "a word of PDDL itself"),
        ({"pick-lid": "a", "pick-food": "a"}, "two things are to be renamed to 'a'"),
    ],
)
def test_renames_that_cannot_be(renames, message):
    with pytest.raises(InputError, match=message):
        Names.of(kitchen(), (), renames)


@pytest.mark.parametrize("word", sorted(RESERVED)[:5])
def test_words_of_pddl_are_no_names(word):
    with pytest.raises(InputError, match="a word of PDDL"):
        check_name(word, "type")


@pytest.mark.parametrize(
    ("domain", "message"),
    [
        (replace(kitchen(), name="Kitchen"), "domain 'Kitchen' is not"),
        (replace(kitchen(), predicates=(*kitchen().predicates, Predicate("or"))), "predicate 'or' is a word of PDDL"),
        (replace(kitchen(), operators=(replace(kitchen().operators[0], name="3d"),)), "operator '3d' is not a PDDL name"),
        (UGLY, "type 'Food' is not a PDDL name"),
    ],
)
def test_the_writer_refuses_what_is_no_name(domain, message):
    with pytest.raises(InputError, match=message):
        write_domain(domain)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"objects": (("pan", "pan"), ("pan", "lid"))}, "two of the object 'pan'"),
        ({"domain": "garage"}, "of the domain 'garage'"),
        ({"name": "9"}, "not a PDDL"),
    ],
)
def test_the_writer_refuses_a_problem(change, message):
    bare = replace(covered_egg(), init=frozenset(), goal=frozenset())
    with pytest.raises(InputError, match=message):
        write_problem(replace(bare, **change), kitchen())


def test_the_side_car_file_comes_back(tmp_path):
    names = Names.of(UGLY, ["egg"])
    path = tmp_path / "names.json"
    path.write_text(names.dumps())
    assert load_names(path) == names


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "names.json: .*JSON"),
        ('{"version": 2}', "names.json: version"),
        ('{"colours": {}}', "names.json: colours"),
        ('{"types": {"a": "x", "b": "x"}}', "names.json: .*'x' names both"),
        ('{"types": {"a": "X"}}', "names.json: .*not a PDDL name"),
        ('{"parameters": {"op": {"?a": "?x", "?b": "?x"}}}', "names.json: .*two parameters with one name"),
        ('{"parameters": {"op": {"?a": ""}}}', r"names.json: .*'op', parameter '\?a': '' is no variable"),
        ('{"parameters": {"op": {"?a": "?a b"}}}', "names.json: .*is no variable"),
        ('{"version": ' + "9" * 5000 + "}", "names.json: .*5000 digits"),
        ("[" * 100_000, "names.json: .*nested too deeply"),
    ],
)
def test_a_damaged_side_car_file_is_refused(tmp_path, text, message):
    path = tmp_path / "names.json"
    path.write_text(text)
    with pytest.raises(FormatError, match=message):
        load_names(path)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"there is no file of names .*gone.json"):
        load_names(tmp_path / "gone.json")
    with pytest.raises(InputError, match=r"there is no file of names .*gone.json"):
        load_renames(tmp_path / "gone.json")


def test_a_renames_file(tmp_path):
    path = tmp_path / "renames.json"
    path.write_text('{"renames": {"pick-lid": "uncover"}}')
    assert load_renames(path) == {"pick-lid": "uncover"}
    path.write_text('{"pick-lid": "uncover"}')
    with pytest.raises(FormatError, match="expected"):
        load_renames(path)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_names_that_the_standard_allows_are_written_as_they_are(dialect):
    """A predicate `at`, an operator named like a predicate, an object named like a type."""
    at, over = Predicate("at", ("pan",)), Predicate("over")
    go = Operator("over", (Parameter("?at", "pan"),), frozenset({Atom("over")}), frozenset({Atom("at", ("?at",))}), frozenset())
    domain = Domain("start", (Type("pan"),), (at, over), (go,))
    read = read_domain(write_domain(domain, dialect=dialect))
    assert read == exported(domain, dialect).domain
    problem = Problem("end", "start", (("pan", "pan"),), frozenset({Atom("over")}), frozenset({Atom("at", ("pan",))}))
    assert read_problem(write_problem(problem, domain, dialect=dialect), read) == exported(domain, dialect).problem(problem)
