"""References by a vision-language model (the paper's way to select frames), compared with the default selector's."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from symskill_pddl.learning.segments import Episode, Rest, RestKey
from symskill_pddl.learning.vision.ask import Asker, VisionError
from symskill_pddl.learning.vision.endpoints import Question
from symskill_pddl.learning.vision.frames import Frames, drawing

FRAMES = 4
"""Pictures of each motion, evenly spaced from its begin to its end."""


@dataclass
class Agreement:
    """What came of the questions.

    Attributes
    ----------
    asked, answered : int
        Episodes.
    same, compared : int
        Resting places for which the model names the object that the default selector names, of those that both name.
    notes : list of str
        Every answer that was not used, and why: the default selector decided there.
    """

    asked: int = 0
    answered: int = 0
    same: int = 0
    compared: int = 0
    notes: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        share = f"{100 * self.same / self.compared:.0f} %" if self.compared else "none"
        return (
            f"references: {self.answered} of {self.asked} episodes answered; "
            f"{self.same} of {self.compared} resting places as the default selector has them ({share})"
        )


@dataclass
class VisionSelector:
    """Asks about every episode where the object rested before and after.

    Within the rests that the default selector puts at one type, the type that most answers name is taken; answers of another type
    are outvoted, and the default selector decides there, as it does where no answer came. All of this stands in `agreement`.

    Attributes
    ----------
    asker : Asker
    frames : Frames
        Draws the pictures.
    agreement : Agreement
        Filled by the call.
    """

    asker: Asker
    frames: Frames = drawing
    agreement: Agreement = field(default_factory=Agreement)

    def __call__(self, episodes: Sequence[Episode], default: Mapping[RestKey, str]) -> dict[RestKey, str]:
        """By `Rest.key`, the object that it is at. `default`: what the default selector says.

        Raises
        ------
        VisionError
            If not one question was answered.
        """
        answers: list[tuple[Episode, Rest, str]] = []
        last: VisionError | None = None
        for e in episodes:
            self.agreement.asked += 1
            try:
                answer = self.asker.ask(question(e, self.frames))
            except VisionError as error:
                last = error
                self.agreement.notes.append(f"{e}: {error}; the default selector decides")
                continue
            self.agreement.answered += 1
            rests = {"before": [e.before, e.body_before], "after": [e.after]}
            answers += [(e, rest, answer[when]) for when, own in rests.items() for rest in own if rest is not None]
        if last is not None and not self.agreement.answered:
            raise VisionError(f"none of {self.agreement.asked} questions about references was answered; the last: {last}")
        return self._voted(answers, default)

    def _voted(self, answers: Sequence[tuple[Episode, Rest, str]], default: Mapping[RestKey, str]) -> dict[RestKey, str]:
        groups: dict[tuple[str, str], list[tuple[Episode, Rest, str]]] = defaultdict(list)
        for e, rest, name in answers:
            types = e.demo.objects
            groups[types[rest.obj], types.get(default.get(rest.key, ""), "")].append((e, rest, name))
            if rest.key in default:
                self.agreement.compared += 1
                self.agreement.same += default[rest.key] == name
        kept = {}
        for _, members in sorted(groups.items(), key=lambda item: item[0]):
            votes = Counter(e.demo.objects[name] for e, _, name in members)
            winner = max(sorted(votes), key=lambda t: votes[t])
            for e, rest, name in members:
                if e.demo.objects[name] == winner:
                    kept[rest.key] = name
                else:
                    self.agreement.notes.append(
                        f"{e}: the model says {rest.obj} rests at {name}, in most such episodes at a {winner}; "
                        "the default selector decides"
                    )
        return kept


def question(e: Episode, frames: Frames) -> Question:
    """What is asked about an episode: where the moved object rested before, and where it comes to rest."""
    moved, demo = e.moved, e.demo
    words = tuple(name for name in demo.objects if name not in (moved, e.obj))
    samples = np.linspace(e.start, min(e.stop, len(demo) - 1), FRAMES).round().astype(int)
    objects = ", ".join(f"{name} (a {type_})" for name, type_ in demo.objects.items())
    text = (
        f"A robot's gripper moves the object '{moved}' (a {demo.objects[moved]}), which is marked. The {FRAMES} pictures show "
        f"the motion in order of time, the first before it begins and the last when it is over. Objects: {objects}. Relative to "
        f"which object is '{moved}' placed before the motion, and relative to which after it: what it lies on or in, or hangs "
        "on? Answer with the names of two objects, 'before' and 'after'; they may be the same."
    )
    return Question(text, tuple(frames(demo, int(i), moved) for i in samples), {"before": words, "after": words})
