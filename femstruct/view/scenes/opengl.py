"""Whether this machine can draw in three dimensions."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache
from typing import Final

from femstruct.errors import FemstructError

_WINDOW: Final = "VTK_DEFAULT_OPENGL_WINDOW"
_CHOSEN: Final = "FEMSTRUCT_OPENGL_WINDOW"  # in a process that may crash: drawn with, untried
WAYS: Final = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow", "")  # without a display; "" for VTK's own choice
_PROBE: Final = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(8, 8)
window.AddRenderer(vtkRenderer())
window.Render()
"""
LEFT_OUT: Final = (
    "Pictures of shapes left out: no OpenGL on this machine; on Debian or Ubuntu, install libegl1 and libgl1-mesa-dri."
)


class NoOpenGL(FemstructError):
    """This machine cannot draw in three dimensions."""


def require_opengl() -> None:
    """Choose how VTK draws off screen; raises NoOpenGL when no way works.

    Without OpenGL libraries VTK does not raise, it crashes; so each way is tried once in another process.
    """
    if _CHOSEN in os.environ:
        return
    window = _working_window()
    if window is None:
        raise NoOpenGL(LEFT_OUT)
    if window:
        os.environ[_WINDOW] = window


def choose(window: str) -> None:
    """Let this process draw with a render window of VTK, "" for its own choice, without trying whether that works."""
    os.environ[_CHOSEN] = window
    if window:
        os.environ[_WINDOW] = window


@cache
def _working_window() -> str | None:
    """The render window to ask VTK for, "" for its own choice; None when all of them crash."""
    chosen = os.environ.get(_WINDOW)
    headless = sys.platform.startswith("linux")
    ways = (chosen,) if chosen else WAYS if headless else ("",)
    return next((way for way in ways if _draws(way)), None)


def _draws(window: str) -> bool:
    environment = {**os.environ, _WINDOW: window} if window else dict(os.environ)
    try:
        probe = subprocess.run([sys.executable, "-c", _PROBE], env=environment, capture_output=True, timeout=60)
    except subprocess.TimeoutExpired:
        return False
    return probe.returncode == 0
