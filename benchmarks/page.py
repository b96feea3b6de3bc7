"""A page that several commands write, each its own section."""

from __future__ import annotations

import os
import platform
from pathlib import Path

PAGE = Path(__file__).parent.parent / "docs" / "benchmarks-kitchen.md"
TITLE = "# The kitchen's speed and stability\n"


def write_section(name: str, text: str, path: Path = PAGE) -> None:
    """Put `text` between the marks of section `name`, at the end if it has none yet; the rest of the page stays."""
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
    page = path.read_text(encoding="utf-8") if path.is_file() else TITLE
    before, mark, rest = page.partition(begin)
    after = rest.partition(end)[2] if mark else ""
    before = before if mark else page + "\n"
    path.write_text(f"{before}{begin}{text.rstrip()}\n{end}{after}", encoding="utf-8")


def machine() -> str:
    """What it was measured on."""
    import mujoco

    model = platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.is_file():
        names = [line.partition(":")[2].strip() for line in cpuinfo.read_text().splitlines() if line.startswith("model name")]
        model = names[0] if names else model
    return f"{model}, {os.cpu_count()} cores, Python {platform.python_version()}, MuJoCo {mujoco.__version__}"
