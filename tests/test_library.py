import json
import re

import numpy as np
import pytest
from synthetic import record

from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.learning import LearnConfig, learn
from symskill_pddl.learning.skills import SkillConfig
from symskill_pddl.library import DEMOS, INDEX, SKILLS, Library
from symskill_pddl.symbols import Absent, Atom, Parameter

FAST = LearnConfig(skills=SkillConfig(max_fields=1))


@pytest.fixture(scope="module")
def library():
    return learn(record("PnPCabToCounter", 1), FAST)


@pytest.fixture(scope="module")
def other():
    return learn(record("PnPCounterToCab", 1), FAST)


@pytest.fixture
def saved(library, tmp_path):
    library.save(tmp_path / "library")
    return tmp_path / "library"


def edit(folder, change):
    document = json.loads((folder / INDEX).read_text())
    change(document)
    (folder / INDEX).write_text(json.dumps(document))


def test_what_is_saved_is_loaded(library, saved, tmp_path):
    again = Library.load(saved)
    assert again.domain() == library.domain()
    assert again.operators == library.operators
    assert (again.goals, again.gripper, again.extents, again.types) == (
        library.goals,
        library.gripper,
        dict(library.extents),
        library.types,
    )
    for a, b in zip(again.classifiers, library.classifiers, strict=True):
        assert a.predicate == b.predicate
        for x, y in ((a.T_mean.vector(), b.T_mean.vector()), (a.cov_p, b.cov_p), (a.cov_r, b.cov_r)):
            assert np.array_equal(x, y)
    for name, skill in library.skills.items():
        arrays = again.skills[name].arrays()
        assert all(np.array_equal(arrays[k], v) for k, v in skill.arrays().items())


def test_saving_again_gives_the_same_bytes_and_no_litter(library, saved, tmp_path):
    before = {f.name: f.read_bytes() for f in saved.rglob("*") if f.is_file()}
    Library.load(saved).save(saved)
    assert {f.name: f.read_bytes() for f in saved.rglob("*") if f.is_file()} == before


def test_a_newer_library_replaces_an_older_one_whole(library, other, saved):
    other.save(saved)
    assert Library.load(saved).operators == other.operators
    assert len(list((saved / SKILLS).iterdir())) == len(other.skills)


def test_a_crash_before_the_last_write_leaves_the_old_library(library, other, saved, monkeypatch):
    import symskill_pddl.files.folder as module

    real = module.write_atomic

    def crash(path, content):
        if path.name == INDEX:
            raise KeyboardInterrupt
        real(path, content)

    monkeypatch.setattr(module, "write_atomic", crash)
    with pytest.raises(KeyboardInterrupt):
        other.save(saved)
    assert Library.load(saved).operators == library.operators


def test_who_reads_while_it_is_replaced_gets_one_of_the_two(library, other, saved, monkeypatch):
    import symskill_pddl.library_io as module

    real, read = module._read_file, []

    def replaced_in_the_middle(folder, entry):
        read.append(entry)
        if len(read) == 2:
            other.save(saved)
        return real(folder, entry)

    monkeypatch.setattr(module, "_read_file", replaced_in_the_middle)
    assert Library.load(saved).operators == other.operators


def test_nothing_but_a_library_is_replaced(library, other, saved, tmp_path):
    with pytest.raises(InputError, match="holds another library already"):
        other.save(saved, replace=False)
    library.save(saved, replace=False)
    assert Library.load(saved).operators == library.operators
    index = saved / INDEX
    for text in ('{"name": "of another tool"}', '{"format": "symskill-demos"}', "[]", "not json", "[" * 100_000):
        index.write_text(text)
        before = sorted(saved.rglob("*"))
        with pytest.raises(InputError, match="is not empty and no library"):
            other.save(saved)
        assert sorted(saved.rglob("*")) == before
        assert index.read_text() == text


def test_a_library_of_another_version_is_replaced_whole(other, saved):
    edit(saved, lambda d: d.update(schema_version=99, surprise=1))
    other.save(saved)
    assert Library.load(saved).operators == other.operators
    assert len(list((saved / SKILLS).iterdir())) == len(other.skills)


def test_an_index_that_names_files_elsewhere_removes_none_of_them(other, saved, tmp_path):
    outside = tmp_path / "mine.npz"
    outside.write_bytes(b"precious")

    def point(document):
        document["skills"] |= {"x": {"file": "../../mine.npz"}, "y": {"file": str(outside)}, "z": 3, "w": {"file": None}}

    edit(saved, point)
    other.save(saved)
    assert outside.read_bytes() == b"precious"


def test_negative_conditions_survive(library, saved):
    from dataclasses import replace

    absent = frozenset({Absent(Atom("food-in-cabinet", ("?other", "?cabinet")), (Parameter("?other", "food"),))})
    first, *rest = library.operators
    changed = replace(library, operators=(replace(first, operator=replace(first.operator, absent=absent)), *rest))
    changed.save(saved)
    assert Library.load(saved).operators[0].operator.absent == absent
    # a library from before it was told how many there were at a time
    index = saved / INDEX
    text = index.read_text()
    assert '"at_most_one": false' in text
    index.write_text(re.sub(r',\s*"at_most_one": false', "", text))
    assert Library.load(saved).operators[0].operator.absent == absent
    index.write_text(text.replace('"at_most_one": false', '"at_most_one": true'))
    assert {a.at_most_one for a in Library.load(saved).operators[0].operator.absent} == {True}


@pytest.mark.parametrize("at", [0, 100, -1])
def test_a_flipped_byte_is_noticed(saved, at):
    path = min((saved / SKILLS).iterdir())
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)
    with pytest.raises(FormatError, match=f"{path.name}.*checksum"):
        Library.load(saved)


def test_a_missing_skill_is_named(saved):
    path = min((saved / SKILLS).iterdir())
    path.unlink()
    with pytest.raises(FormatError, match=f"there is no .*'.*{path.name}'"):
        Library.load(saved)


def test_skills_of_another_library_are_refused(saved):
    a, b, *_ = sorted((saved / SKILLS).iterdir())
    a.write_bytes(b.read_bytes())
    with pytest.raises(FormatError, match=a.name):
        Library.load(saved)


def test_no_library_at_all(tmp_path):
    with pytest.raises(FormatError, match=f"there is no .*'.*{INDEX}'"):
        Library.load(tmp_path)


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"\xff\xfe", b"{}"])
def test_a_damaged_index_is_named(saved, content):
    (saved / INDEX).write_bytes(content)
    with pytest.raises(FormatError, match=f"{INDEX}' is not a library of schema version 1"):
        Library.load(saved)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.update(schema_version=2), "schema_version"),
        (lambda d: d.update(surprise=1), "surprise"),
        (lambda d: d["operators"][0].pop("cost"), "operators.0.cost"),
        (lambda d: d["operators"][0].update(skill="juggle"), "unknown skill 'juggle'"),
        (lambda d: d["operators"][0]["pre"].append(["flies", ["?food"]]), "unknown predicate 'flies'"),
        (lambda d: d["operators"][0]["pre"].append(["food-in-cabinet", ["?food"]]), "wrong number of arguments"),
        (lambda d: d["operators"][0]["parameters"][1].__setitem__(1, "moon"), "unknown type 'moon'"),
        (lambda d: d["operators"][0].update(parameters=[["?x", "food"]]), "uses"),
        (lambda d: d["predicates"][0].update(cov_position=[[0, 0, 0]] * 3), "positive definite"),
        (lambda d: d["predicates"][0].update(orientation_wxyz=[0, 0, 0, 0]), "quaternion of length 0"),
        (lambda d: next(iter(d["skills"].values())).update(file="../../etc/passwd"), "cannot read|no file name"),
    ],
)
def test_what_does_not_fit_is_refused_in_words(saved, change, message):
    edit(saved, change)
    with pytest.raises(FormatError, match=message):
        Library.load(saved)


def test_a_folder_that_cannot_be_made(library, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"cannot write the library .*it is no folder"):
        library.save(tmp_path / "file")


def test_a_library_keeps_its_demonstrations_and_the_leads_of_its_references(library, saved):
    again = Library.load(saved)
    assert dict(again.recordings) == dict(library.recordings)
    assert set(again.recordings) == {e.demo.split(":")[0] for o in again.operators for e in o.evidence}
    assert dict(again.margins) == dict(library.margins)
    assert set(again.margins) <= {c.predicate.name for c in again.classifiers}
    assert all(margin > 0.0 for margin in again.margins.values())


def test_a_damaged_demonstration_is_named(saved):
    (file,) = (saved / DEMOS).iterdir()
    file.write_bytes(file.read_bytes()[:-1])
    with pytest.raises(FormatError, match=rf"{file.name}' is damaged or belongs to another library"):
        Library.load(saved)
    file.unlink()
    with pytest.raises(FormatError, match=rf"there is no file that library.json names '.*{file.name}'"):
        Library.load(saved)
