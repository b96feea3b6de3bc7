from xml.etree import ElementTree

from symskill_pddl.report.svg import Chart, Line, charts_svg


def chart(**how):
    lines = (Line("a<b", (0.5, 1.0), ((0.4, 0.6), (0.9, 1.0))), Line("c", (0.0, 0.25), ((0.0, 0.1), (0.2, 0.3))))
    return Chart(**{"title": "curves & more", "x": "n", "ticks": ("1", "2"), "lines": lines, **how})


def test_it_is_well_formed_and_holds_every_point():
    root = ElementTree.fromstring(charts_svg([chart(), chart(), chart()]))
    space = "{http://www.w3.org/2000/svg}"
    assert len(root.findall(f".//{space}circle")) == 3 * 4
    assert len(root.findall(f".//{space}polyline")) == 3 * 2
    texts = [t.text for t in root.iter(f"{space}text")]
    assert texts.count("a<b") == 1  # one legend for all charts
    assert texts.count("curves & more") == 3


def test_higher_values_are_drawn_higher_and_none_leaves_its_chart():
    root = ElementTree.fromstring(charts_svg([chart(low=0.5)]))
    heights = [float(c.get("cy")) for c in root.iter("{http://www.w3.org/2000/svg}circle")]
    assert heights[1] < heights[0] == heights[2] == heights[3]


def test_the_same_numbers_give_the_same_bytes():
    assert charts_svg([chart()]) == charts_svg([chart()])
