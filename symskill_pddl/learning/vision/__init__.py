"""References chosen by a vision-language model, asked over the network; never needed, and never asked unless told to."""

from symskill_pddl.learning.vision.ask import AskConfig, Asker
from symskill_pddl.learning.vision.endpoints import Endpoint, endpoint_named
from symskill_pddl.learning.vision.frames import drawing
from symskill_pddl.learning.vision.selector import Agreement, VisionSelector

__all__ = ["Agreement", "AskConfig", "Asker", "Endpoint", "VisionSelector", "drawing", "endpoint_named"]
