"""What pushes the modes on a grid of times: moments of the forces, from which their transform follows to the grid's
own frequency."""

from __future__ import annotations

from femstruct.arrays import Floats
from femstruct.impact.compiled.kernels import kernel
from femstruct.impact.engine.gauss_points import STAGES, Rule
from femstruct.impact.engine.propagate import Trial

LONG = 8.0  # spacings of a step, of which a cell then sees little: two points in it are enough
OUTER, INNER = 0.06943184420297371, 0.33000947820757187  # Gauss points of four, and their weights
OF_OUTER, OF_INNER = 0.17392742256872692, 0.32607257743127305
OF_TWO = 0.21132486540518713  # of two


@kernel
def gather(t: float, h: float, rule: Rule, trial: Trial, moments: Floats, shares: Floats, spacing: float) -> None:
    """Add what the forces of a step from t to t + h push to moments [r, cells + 2]: the integrals of each force times a
    hat of the spacing's width around each time of the grid [N s]. shares [STAGES] : room."""
    first, last = int(t / spacing), int((t + h) / spacing)
    last = min(last, moments.shape[1] - 2)
    if first >= last:
        for s in range(STAGES):
            at = (t + rule.nodes[s] * h) / spacing - first
            for a in range(len(moments)):
                push = rule.weights[s] * h * trial.forces[a, s]
                moments[a, first] += push * (1.0 - at)
                moments[a, first + 1] += push * at
        return
    low = 0.0
    for cell in range(first, last + 1):
        high = min(((cell + 1) * spacing - t) / h, 1.0)
        width = high - low
        if width <= 0.0:
            continue
        if h > LONG * spacing:
            _look(t, h, low + OF_TWO * width, 0.5 * width, cell, rule, trial, moments, shares, spacing)
            _look(t, h, high - OF_TWO * width, 0.5 * width, cell, rule, trial, moments, shares, spacing)
        else:
            _look(t, h, low + OUTER * width, OF_OUTER * width, cell, rule, trial, moments, shares, spacing)
            _look(t, h, low + INNER * width, OF_INNER * width, cell, rule, trial, moments, shares, spacing)
            _look(t, h, high - INNER * width, OF_INNER * width, cell, rule, trial, moments, shares, spacing)
            _look(t, h, high - OUTER * width, OF_OUTER * width, cell, rule, trial, moments, shares, spacing)
        low = high


@kernel
def _look(t: float, h: float, theta: float, weight: float, cell: int, rule: Rule, trial: Trial, moments: Floats,
          shares: Floats, spacing: float) -> None:  # fmt: skip
    """What one point of a cell adds; theta, weight : of the step."""
    total = 0.0
    for i in range(STAGES):
        distance = theta - rule.nodes[i]
        if distance == 0.0:  # beside it: interpolation there is to rounding
            distance = 1e-17
        # barycentric weights of the places without both ends
        shares[i] = rule.barycentric[i + 1] * rule.nodes[i] * (rule.nodes[i] - 1.0) / distance
        total += shares[i]
    at = (t + theta * h) / spacing - cell
    for a in range(len(moments)):
        push = 0.0
        for i in range(STAGES):
            push += shares[i] * trial.forces[a, i]
        push *= weight * h / total
        moments[a, cell] += push * (1.0 - at)
        moments[a, cell + 1] += push * at
