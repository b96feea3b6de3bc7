import re
from pathlib import Path

PAGE = Path(__file__).parent.parent.parent / "docs" / "skills.md"


def test_the_example_of_the_page_runs():
    (code,) = re.findall(r"(?s)```python\n(.*?)```", PAGE.read_text())
    exec(compile(code, str(PAGE), "exec"), {})
