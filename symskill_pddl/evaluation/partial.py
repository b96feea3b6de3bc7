"""The results so far of an evaluation: one line per episode, so that a killed evaluation goes on where it was.

The first line says what is run, every further line holds one episode. A line is written at once and reaches the disk before
the next one; a kill loses at most the line being written, and that episode is run again.
"""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType

from pydantic import BaseModel, ConfigDict, ValidationError

from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.evaluation.results import EpisodeResult, Settings
from symskill_pddl.files import open_locked

Key = tuple[str, int]
"""Task and seed of an episode."""
_BEGINS = b'{"settings":'
"""Of the first line, by which a file of somebody else is known before it is cut."""


class _Line(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Started(_Line):
    """First line."""

    settings: Settings
    tasks: tuple[str, ...]


class Done(_Line):
    """One episode."""

    task: str
    episode: EpisodeResult


def partial_path(output: Path) -> Path:
    """Where the episodes so far lie: beside the results file."""
    return output.with_name(f"{output.name}.partial.jsonl")


def differences(before: Settings, tasks_before: tuple[str, ...], now: Settings, tasks: tuple[str, ...]) -> list[str]:
    """What tells one evaluation from another, in words: 'seed 0, now 7'."""
    old, new = {**dict(before), "tasks": tasks_before}, {**dict(now), "tasks": tasks}
    return [f"{name} {_text(old[name])}, now {_text(new[name])}" for name in new if old[name] != new[name]]


class Partial:
    """The file, opened, locked and read; `done` holds its episodes. A context manager.

    Raises
    ------
    InputError
        The file cannot be written, another evaluation is writing it, or it holds episodes of other settings.
    FormatError
        It is damaged elsewhere than in a cut last line.
    """

    def __init__(self, path: Path, settings: Settings, tasks: tuple[str, ...]) -> None:
        self.path = path
        self.done: dict[Key, EpisodeResult] = {}
        self._file = open_locked(path, f"another evaluation is writing '{path}'")
        try:
            self._read(Started(settings=settings, tasks=tasks))
        except BaseException:
            os.close(self._file)
            raise

    def add(self, task: str, episode: EpisodeResult) -> None:
        """Keep one more episode."""
        self._append(Done(task=task, episode=episode))
        self.done[task, episode.seed] = episode

    def remove(self) -> None:
        """The results are written: the file has done its work."""
        self.path.unlink(missing_ok=True)

    def __enter__(self) -> Partial:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        os.close(self._file)

    def _read(self, wanted: Started) -> None:
        content = self.path.read_bytes()
        whole = content[: content.rfind(b"\n") + 1]
        if whole.count(b"\n") < 2:  # no episode was finished: nothing to go on with
            if content[: len(_BEGINS)] != _BEGINS[: len(content)]:
                raise FormatError(f"'{self.path}' holds something else than an evaluation in progress; choose another -o")
            whole = b""
        for number, line in enumerate(whole.splitlines(), start=1):
            try:
                if number == 1:
                    self._compare(Started.model_validate_json(line), wanted)
                else:
                    done = Done.model_validate_json(line)
                    self.done[done.task, done.episode.seed] = done.episode
            except ValidationError as error:
                first = error.errors()[0]
                where = ".".join(map(str, first["loc"])) or "line"
                raise FormatError(
                    f"{self.path}:{number}: not a line of an evaluation in progress: {where}: {first['msg']}; "
                    "remove the file to begin anew"
                ) from None
        # cut only once it is known to be ours
        if len(whole) < len(content):
            os.ftruncate(self._file, len(whole))
        if not whole:
            self._append(wanted)

    def _compare(self, found: Started, wanted: Started) -> None:
        if different := differences(found.settings, found.tasks, wanted.settings, wanted.tasks):
            raise InputError(
                f"'{self.path}' holds episodes of another evaluation ({'; '.join(different)}); "
                "go on with its settings, remove it, or choose another -o"
            )

    def _append(self, line: BaseModel) -> None:
        text = (line.model_dump_json() + "\n").encode("utf-8")
        try:
            if os.write(self._file, text) != len(text):
                raise InputError(f"cannot write '{self.path}': the disk is full")
            os.fsync(self._file)
        except OSError as error:
            raise InputError(f"cannot write '{self.path}': {error.strerror or error}") from None


def _text(value: object) -> str:
    if isinstance(value, tuple):
        return " ".join(map(str, value)) or "none"
    return str(value) if value != "" else "none"
