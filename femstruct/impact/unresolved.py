"""Peaks and end velocities of a run whose estimated numerical error is too large."""

from __future__ import annotations

from femstruct.errors import Finding
from femstruct.impact.estimate import ErrorEstimate

UNRESOLVED = 1e-3  # of a peak force: what its estimated error may be; told from there on
NOT_TRUSTED = 1e-2  # and severe from here on
ASKED = 0.1  # share of an asked accuracy that the march may take


def unresolved_findings(errors: ErrorEstimate, within: float | None = None) -> tuple[Finding, ...]:
    """Contacts whose peak force the march may miss by more than 0.1 %, or by a tenth of the accuracy that is asked for;
    a body whose velocity at the end it may miss by more than 1 % of its largest.

    within : the share asked for [1], None where none is.
    """
    allowed = UNRESOLVED if within is None else min(UNRESOLVED, ASKED * within)
    found = []
    for name, peak in errors.peak.items():
        if peak.relative <= allowed:
            continue
        found.append(
            Finding(
                "contact-unresolved",
                f"Contact '{name}': its peak force of {peak.value:.4g} N may be wrong by {peak.error:.3g} N, "
                f"{100 * peak.relative:.2g} %; {100 * allowed:g} % is allowed. {_instead(errors, allowed)}",
                {
                    "peak_force_n": peak.value,
                    "error_n": peak.error,
                    "relative": peak.relative,
                    "allowed": allowed,
                    "first_until_s": errors.first_until,
                },
                severe=peak.relative > NOT_TRUSTED,
            )
        )
    name, speed = max(errors.velocity.items(), key=lambda item: item[1].relative, default=("", None))
    if speed is not None and speed.relative > NOT_TRUSTED:
        found.append(
            Finding(
                "end-unresolved",
                f"{name} ends with {speed.value:.4g} m/s, which may be wrong by {speed.error:.3g} m/s, "
                f"{100 * speed.relative:.2g} % of its largest speed: the end of this window cannot be determined",
                {"velocity_m_s": speed.value, "error_m_s": speed.error, "relative": speed.relative},
            )
        )
    return tuple(found)


def _instead(errors: ErrorEstimate, allowed: float) -> str:
    """What to use, or to do, where a peak of the whole window is not resolved."""
    worst = max((one.relative for one in errors.first_peak.values()), default=0.0)
    if errors.first_peak and worst <= allowed:
        firsts = ", ".join(f"{name} {one.value:.4g} N" for name, one in errors.first_peak.items())
        return (
            f"Each collision multiplies the errors before it. Peaks until {errors.first_until:.4g} s, when a contact "
            f"closes again, have an error of at most {100 * worst:.1g} % ({firsts}). Use these, shorten the window, or "
            "study the scatter of many runs"
        )
    if errors.tolerance is None:
        return "The contact is so light that rounding determines its force"
    return f"The time steps do not resolve it: use a smaller tolerance than {errors.tolerance:g}"
