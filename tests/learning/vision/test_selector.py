import json
import re

import pytest
from synthetic import record

from symskill_pddl.learning import learn_symbols
from symskill_pddl.learning.vision import AskConfig, Asker, VisionSelector, endpoint_named
from symskill_pddl.learning.vision.ask import VisionError


@pytest.fixture(scope="module")
def demos():
    return record("PnPCabToCounter", 4, faults=False)


def selector(model, **config):
    endpoint = endpoint_named("openai:local", model.url, {})
    return VisionSelector(Asker(endpoint, AskConfig(**{"timeout_s": 60.0, "attempts": 1, **config})), lambda d, i, o: b"%d" % i)


def right(body):
    return {"before": "cabinet", "after": "counter"}


def test_a_model_that_is_right_agrees_with_the_default_selector(model, demos):
    model.replies, chosen = [right], selector(model)
    found = learn_symbols(demos, selector=chosen)
    assert len(model.seen) == 4
    assert str(chosen.agreement) == (
        "references: 4 of 4 episodes answered; 8 of 8 resting places as the default selector has them (100 %)"
    )
    assert chosen.agreement.notes == []
    assert {g.learned.operator.name for g in found.groups} == {"pick-food-from-cabinet", "place-food-on-counter"}


def test_a_model_can_overrule_the_default_selector(model, demos):
    model.replies, chosen = [{"before": "door", "after": "counter"}], selector(model)
    found = learn_symbols(demos, selector=chosen)
    assert ("food", "door") in {p.types for p in found.relations.places}
    assert chosen.agreement.same == 4


def test_the_odd_answer_is_outvoted_and_said(model, demos):
    model.replies, chosen = [right, {"before": "door", "after": "counter"}, right], selector(model)
    found = learn_symbols(demos, selector=chosen)
    assert ("food", "door") not in {p.types for p in found.relations.places}
    (note,) = chosen.agreement.notes
    assert "rests at door, in most such episodes at a cabinet; the default selector decides" in note


def test_a_missing_answer_is_said_and_the_default_decides(model, demos):
    model.replies, chosen = [right, (500, b"no"), right], selector(model)
    found = learn_symbols(demos, selector=chosen)
    assert chosen.agreement.answered == 3
    assert re.search(r"HTTP status 500: no; the default selector decides", chosen.agreement.notes[0])
    plain = learn_symbols(demos)
    assert [g.learned.operator for g in found.groups] == [g.learned.operator for g in plain.groups]


def test_a_model_that_never_answers_is_an_error(model, demos):
    model.replies = [(404, b"no such model")]
    with pytest.raises(VisionError, match=r"none of 4 questions about references was answered; the last: .*no such model"):
        learn_symbols(demos, selector=selector(model))


def test_the_words_allowed_are_the_other_objects_of_the_scene(model, demos):
    model.replies = [right]
    learn_symbols(demos[:1], selector=selector(model))
    body = model.seen[0][2]
    schema = body["response_format"]["json_schema"]["schema"]["properties"]
    moved = next(iter({"cheese", "bread", "can"} & set(demos[0].objects)))
    assert set(schema["after"]["enum"]) <= set(demos[0].objects) - {moved} | {"lemon"}
    assert len(body["messages"][0]["content"]) == 5  # the text and four pictures
    assert json.dumps(body).count(f"'{moved}'") >= 1
