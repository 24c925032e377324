"""Which march a scene takes: a pure function of its laws, its structure and its window."""

from __future__ import annotations

import numpy as np

from femstruct.impact.engine.records import CONSTANT, HALF_SINE, LINK, TABLE, System
from femstruct.impact.exact.exact_constants import THETA

MOST_STEPS = 3000


def takes_exact_march(system: System, duration: float) -> bool:
    """Whether a system is piecewise linear and its exact march, of THETA / (largest rate) a step, is no slower one.

    Every law must be linear in each of its states, every load a constant, a half-sine or straight lines that comes
    once, from t = 0 on. Scenes with blows go by collocation.

    Notes: a step of the exact march costs 1.4 us with 2 modes when nothing is sampled; with all samples kept 2 to 6 us
    up to 30 modes and 17 us with 98, whatever happens in it. One of collocation costs several times that, but it is as
    long as the forces allow, not the fastest mode, and an opening or a closing takes about 50 of them. Measured with 2,
    12, 30 and 98 modes, a ball, a damper and a link, with all samples kept: the exact march is 1.2 to 1.6 times faster
    at 1350 of its steps and 2 to 4 times slower at 6350; a residual vector at 40 kHz that sets the step of a window of
    0.5 s makes it ten times slower. Up to MOST_STEPS it is taken for its exactness where both take about as long.
    """
    laws = system.interfaces["straight"].all()
    loads = np.isin(system.loads["kind"], (CONSTANT, HALF_SINE, TABLE)).all()
    once = (system.loads["count"] == 1).all() and not system.loads["start"].any()
    waits = (system.interfaces["release"][system.interfaces["kind"] != LINK] > 0).any()
    if not (laws and loads and once) or waits or len(system.strikes):
        return False
    return largest_rate(system) * duration <= THETA * MOST_STEPS


def largest_rate(system: System) -> float:
    """Bound of the rates [1/s] with every law acting at once and every load."""
    law, mobility = system.interfaces, system.mobility[: len(system.interfaces)]
    stiffness = system.reach[0] + law["stiffness"] @ mobility
    damping = system.reach[1] + np.maximum(law["closing"], law["opening"]) @ mobility
    sines = system.loads[system.loads["kind"] == HALF_SINE]
    sine = 2.0 * np.pi * float(np.max(sines["frequency"], initial=0.0))
    return max(float(0.5 * (damping + np.sqrt(damping**2 + 4.0 * stiffness))), sine)
