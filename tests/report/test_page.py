import re
import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.report import library_page, results_page, run_page, write_page
from symskill_pddl.report.results import ResultRow

VOID = {"meta", "br", "link", "img", "input", "hr"}


class Page(HTMLParser):
    """Checks that tags nest, and collects ids, text and outside references."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.tags: set[str] = set()
        self.words: list[str] = []
        self.feed(html)
        self.close()
        assert self.open == []
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        values = dict(attrs)
        assert "src" not in values
        assert "href" not in values
        assert not any(name.startswith("on") for name in values)
        if "id" in values:
            self.ids.append(values["id"])
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("style", "title"):
            self.words.append(data)


def test_the_page_of_a_run_has_every_part(trace, library):
    page = Page(run_page(trace, library))
    expected = ["summary", "timeline", "events", "attempts", "plans", "timing", "operators", "predicates", "goals", "objects"]
    assert page.ids == expected
    for words in (
        "StoreCheese, seed 3",
        "success",
        "(food-in-cabinet cheese cabinet) holds",
        "the grasp was lost",
        "blamed: acquiring step",
        "retry 1, goal moved",
        "cheese was pushed by 6 cm",
        "retreat: a lost grasp (clear)",
        "20.0 ms",
        "learned from 2 episodes in 2 demonstrations",
        "no ?lid - lid with (lid-on-cabinet ?lid ?cabinet)",
        "1. in ?food's frame, fingers open",
        "food at x 0.0, y -2.0, z 3.1 cm in the cabinet's frame",
        "not in the library",
    ):
        assert words in page.text, words


def test_without_a_library_the_page_tells_the_run_only(trace):
    assert "operators" not in Page(run_page(trace)).ids


def test_a_failure_is_called_one(trace):
    outcome = trace.lines[-1].model_copy(update={"success": False, "category": "unreachable", "reason": "no plan"})
    page = Page(run_page(type(trace)(trace.header, (*trace.lines[:-1], outcome))))
    assert "failure no plan (unreachable)" in page.text


def test_the_timeline_is_well_formed_and_has_a_bar_for_each_attempt(trace):
    svg = re.search(r"<svg.*?</svg>", run_page(trace), re.DOTALL)
    assert svg is not None
    root = ET.fromstring(svg.group())
    assert [bar.get("class") for bar in root.iter("rect")] == ["good", "bad", "skip", "good"]
    assert len([line for line in root.iter("line") if line.get("class") == "plan"]) == 2


def test_nothing_from_a_file_becomes_markup(new_trace, new_library, hostile):
    trace = new_trace(hostile)
    header = trace.header.model_copy(
        update={"task": hostile, "planner": hostile, "objects": {hostile: hostile}, "goal": ((hostile,),)}
    )
    lines = [
        line.model_copy(update={"verdict": line.verdict.model_copy(update={"reason": hostile, "kind": hostile})})
        if line.event in ("tick", "step")
        else line.model_copy(update={"reason": hostile})
        if line.event in ("plan", "recovery", "outcome")
        else line
        for line in trace.lines
    ]
    html = run_page(type(trace)(header, tuple(lines), hostile), new_library(hostile))
    page = Page(html)
    assert "script" not in page.tags
    assert hostile in page.text
    html = results_page([ResultRow(hostile, 1, 0, (0, 1), {hostile: 1}, {hostile: hostile})], hostile, [(hostile, hostile)])
    assert "script" not in Page(html).tags


def test_the_same_run_gives_the_same_page(library, new_trace):
    assert run_page(new_trace(), library) == run_page(new_trace(), library)


def test_the_page_of_a_library(library):
    page = Page(library_page(library, "Kitchen"))
    assert "Kitchen 2 operators, 3 predicates" in page.text
    assert page.ids == ["operators", "predicates", "goals"]


def test_the_page_of_results():
    rows = [
        ResultRow("StoreCheese", 100, 93, (0.86, 0.97), {"timeout": 2, "unreachable": 5, "none": 0}, {"duration": "21.3 s"}),
        ResultRow("CoverPan", 0, 0, (0, 1), {}, {"replanning": "14 ms"}),
    ]
    page = Page(results_page(rows, facts=[("seed", "0")]))
    for words in (
        "93 of 100",
        "86 to 97 %",
        "unreachable 5, timeout 2 ",
        "21.3 s",
        "14 ms",
        "duration replanning",
        "trials succeeded 0 seed",
    ):
        assert words in page.text, words
    assert "none 0" not in page.text
    assert "no results" in Page(results_page([])).text


def test_results_that_cannot_be_are_refused():
    with pytest.raises(InputError, match="3 successes of 2 trials cannot be"):
        ResultRow("A", 2, 3, (0, 1))
    with pytest.raises(InputError, match=r"interval of a rate lies in \[0, 1\]"):
        ResultRow("A", 2, 1, (0.5, 1.5))


def test_a_page_is_written_whole(tmp_path, trace):
    write_page(tmp_path / "report.html", run_page(trace))
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == run_page(trace)
    with pytest.raises(InputError, match="cannot write"):
        write_page(tmp_path / "none" / "report.html", "")
