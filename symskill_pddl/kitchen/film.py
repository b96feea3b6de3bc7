"""A film of an episode: where things are is noted at every control step, and drawn when the episode is over.

Drawing takes ten times as long as a control step. Done afterwards it slows nothing down, so that a filmed run takes the same
decisions and has the same times in its trace.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.files import draft
from symskill_pddl.geometry import Array
from symskill_pddl.kitchen.render import Camera, check_drawing
from symskill_pddl.kitchen.world import Kitchen
from symskill_pddl.scene import Scene


class Film:
    """Watches a kitchen from now on; use it as a context, for its camera holds a graphics context.

    Attributes
    ----------
    caption : str
        What is written below the coming pictures, after the time.

    Raises
    ------
    InputError
        There is no such camera.
    MissingDependencyError
        No library for off-screen drawing, or no encoder.
    """

    def __init__(self, kitchen: Kitchen, camera: str = "overview", width: int = 640, height: int = 480) -> None:
        self._encoder = encoder()
        self._kitchen, self._size = kitchen, (width, height)
        self._camera = Camera(kitchen, camera, width, height, quick=True)
        self.caption = ""
        self._moments: list[tuple[float, str, Array]] = []
        self._shoot(kitchen.observe())
        kitchen.watchers.append(self._shoot)

    def _shoot(self, scene: Scene) -> None:
        self._moments.append((scene.time, self.caption, self._camera.moment()))

    def __len__(self) -> int:
        return len(self._moments)

    def frame(self, i: int) -> NDArray[np.uint8]:
        """Picture i, (height, width, 3), with its caption."""
        time, caption, moment = self._moments[i]
        return captioned(self._camera.image(moment), f"{time:5.1f} s   {caption}")

    def save(self, path: Path, advance: Callable[[int], object] = lambda _: None) -> None:
        """Draw everything and write it as MP4 (H.264), as fast as it happened; `advance(1)` is called after every picture.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        rate, marked = round(1.0 / self._kitchen.period_s), ["-f", "mp4", "-metadata", "comment=symskill"]
        with draft(path) as temporary:
            frames = self._encoder.write_frames(
                str(temporary), self._size, fps=rate, codec="libx264", quality=6, output_params=marked
            )
            try:
                with closing(frames) as writer:
                    writer.send(None)
                    for i in range(len(self)):
                        writer.send(self.frame(i).tobytes())
                        advance(1)
            except OSError as error:
                raise InputError(f"cannot write the film '{path}': {str(error).splitlines()[0]}") from error

    def __enter__(self) -> Film:
        return self

    def __exit__(self, *_: object) -> None:
        self._kitchen.watchers.remove(self._shoot)
        self._camera.close()


def check_film() -> None:
    """Find out before the work that a film could not be made. Errors as for `Film`."""
    encoder()
    check_drawing()


def encoder() -> Any:
    """The module that writes films.

    Raises
    ------
    MissingDependencyError
        It, or the ffmpeg it brings, is not installed.
    """
    try:
        module = importlib.import_module("imageio_ffmpeg")
        module.get_ffmpeg_exe()
    except (ImportError, RuntimeError) as error:
        reason = str(error).splitlines()[0]
        raise MissingDependencyError(f"films need imageio-ffmpeg ({reason}): pip install imageio-ffmpeg") from error
    return module


def captioned(image: NDArray[np.uint8], text: str) -> NDArray[np.uint8]:
    """The picture with a line of text on a dark strip at its lower edge."""
    from PIL import Image, ImageDraw

    picture = Image.fromarray(image)
    draw, (width, height) = ImageDraw.Draw(picture), picture.size
    draw.rectangle((0, height - 18, width, height), fill=(20, 20, 20))
    draw.text((8, height - 15), text, fill=(235, 235, 235))
    return np.asarray(picture)
