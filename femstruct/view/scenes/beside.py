"""Drawing in a process of its own: beside this one, and no loss where VTK crashes for want of OpenGL."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any, Final, TypeVar

from femstruct.view.scenes.opengl import LEFT_OUT, WAYS, NoOpenGL, choose

R = TypeVar("R")
FORKS: Final = sys.platform.startswith("linux")  # elsewhere a process of its own would have to be sent all results


def drawn_beside(draw: Callable[[], R]) -> Callable[[], R]:
    """Begin to draw in another process, where that is cheap; what is returned waits for it and tells its answer.

    A crash in one way of drawing is answered by the next way; after the last one NoOpenGL is raised. What `draw` raises
    is raised. Where processes are not forked, it is called here when its answer is asked for.

    >>> drawn_beside(lambda: 6 * 7)()
    42
    """
    if not FORKS:
        return draw
    ways = [os.environ.get("VTK_DEFAULT_OPENGL_WINDOW", "")] if "VTK_DEFAULT_OPENGL_WINDOW" in os.environ else [*WAYS]
    first = _begin(draw, ways[0])

    def answer() -> R:
        for number, way in enumerate(ways):
            process, pipe = _begin(draw, way) if number else first
            try:
                good, told = pipe.recv()
            except EOFError:
                continue  # it crashed
            finally:
                process.join()
            if not good:
                raise told
            found: R = told
            return found
        raise NoOpenGL(LEFT_OUT)

    return answer


def _begin(draw: Callable[[], Any], way: str) -> tuple[Any, Connection]:
    context = get_context("fork")
    pipe, ours = context.Pipe(duplex=False)
    process = context.Process(target=_draw, args=(draw, way, ours), daemon=True)
    process.start()
    ours.close()
    return process, pipe


def _draw(draw: Callable[[], Any], way: str, pipe: Connection) -> None:
    choose(way)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # what VTK says before it crashes; failures go through the pipe
    try:
        told: tuple[bool, Any] = True, draw()
    except Exception as failure:
        told = False, failure
    pipe.send(told)
    pipe.close()
    os._exit(0)  # what this process inherited is not its own to clean up
