"""Forging press: acceleration of the bed and force on the ground, in time and frequency (Figs. 4.10 to 4.19).

The source prints 2.3 and 2.4 dB for columns on the ground and about 3 dB for hard springs. With one mode both must be
equal. Hard springs transmit forty times the force of soft ones, where the source says less.
"""

import numpy as np
from matplotlib.figure import Figure
from systems.pictures import save
from systems.press import MODELS

from femstruct.language.cases import read_study
from femstruct.study.results import StudyResult
from femstruct.workflow.run import run_study

CASES = {
    "press": "case 1, soft springs",
    "press_hard": "case 2, hard springs",
    "press_clamped": "case 3, on the ground",
}
PANELS = (("O_b.z acceleration", "m/s²", "1 µm/s²", 1e-6), ("ground force", "N", "1 N", 1.0))
BAND = (2.0, 600.0)  # shown [Hz]
TICKS = (2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)


def main() -> dict[str, float]:
    """Largest force on the ground [N] and what the damper takes from the highest peaks of the spectra [dB]."""
    found = {}
    for name, title in CASES.items():
        result = run_study(read_study(MODELS / f"{name}.study.yaml"))
        _picture(result, name, title)
        found[f"{title}: force"] = result.cases["no damper"].channels["ground force"].whole
        for channel, *_ in PANELS:
            before, after = (np.max(_spectrum(result, case, channel)[1]) for case in ("no damper", "damper"))
            found[f"{title}: {channel} dB"] = float(20.0 * np.log10(before / after))
    return found


def _spectrum(result: StudyResult, case: str, channel: str) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and amplitudes of the lines of the whole record."""
    response, values = result.cases[case].response, result.cases[case].channels[channel].values
    assert response is not None
    amplitude = 2.0 * np.abs(np.fft.rfft(values)) / len(values)
    return np.fft.rfftfreq(len(values), 1.0 / response.clock.sampling), amplitude


def _picture(result: StudyResult, name: str, title: str) -> None:
    figure = Figure(figsize=(12, 7), layout="constrained")
    for (left, right), (channel, unit, reference, one) in zip(figure.subplots(2, 2), PANELS, strict=True):
        window = 0.5 if name == "press" and channel == "ground force" else 0.06
        for case, own in result.cases.items():
            assert own.response is not None
            shown = own.response.t <= window
            left.plot(1e3 * own.response.t[shown], own.channels[channel].values[shown], linewidth=0.9, label=case)
            hertz, amplitude = _spectrum(result, case, channel)
            band = (hertz >= BAND[0]) & (hertz <= BAND[1])
            right.semilogx(hertz[band], 20.0 * np.log10(amplitude[band] / one), linewidth=0.9, label=case)
        right.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
        left.set(xlabel="time [ms]", ylabel=f"{channel} [{unit}]")
        right.set(xlabel="frequency [Hz]", ylabel=f"{channel} [dB re {reference}]")
        for axis in (left, right):
            axis.grid(alpha=0.3, which="both")
            axis.legend(fontsize=8)
    figure.suptitle(f"Blow on the forging press, {title}")
    save(figure, f"07_{name}")


if __name__ == "__main__":
    for key, value in main().items():
        print(f"{key:52} {value:10.4g}")
