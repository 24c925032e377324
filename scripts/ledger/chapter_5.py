"""Chapter 5: a boat under a wave, and a pinned beam that falls on a wave mass."""

from __future__ import annotations

import numpy as np
from systems import boat
from systems import hull as foam
from systems import pinned_beam as pinned

from ledger.row import Row

RHO_A = pinned.MASS / pinned.LENGTH
WAVE = 9.0  # omega_w / omega_1 of Figs 5.9 to 5.13
MU = 0.3  # mass ratio of these figures: not printed, the one that fits


def rows() -> list[Row]:
    """All rows of the chapter."""
    return [
        *two_masses(),
        *beam_itself(),
        *without_damper(),
        *with_damper(),
        *in_time(),
        *lowest(),
        *accelerations(),
        *stiffnesses(),
        *hull(),
    ]


def two_masses() -> list[Row]:
    """Section 5.2: the optimum of the contact frequency."""
    found = []
    for mu in (0.3, 0.4, 0.6, 1.0, 1.4):
        gamma, low = boat.best(mu)
        found.append(
            Row(f"5.45, omega_d / omega_w at the smallest a / a0, mu = {mu:g}", boat.optimum(mu), gamma,
                1e-4 * boat.optimum(mu), note=f"a / a0 = {low:.4f}; one part in 10^4")
        )  # fmt: skip
    for mu in (0.1, 0.2):
        gamma, _ = boat.best(mu)
        found.append(
            Row(f"5.45, the same at mu = {mu:g}", boat.optimum(mu), gamma, 1e-2,
                why="below mu = 0.2943 the peak splits before its two halves are equal; not, as the text has it, "
                "because p_1 is not small: with omega = 0 it is 0")
        )  # fmt: skip
    for mu, beta in ((0.6, 0.1), (0.6, 0.5)):
        gamma, _ = boat.best(mu, beta)
        found.append(
            Row(f"5.43, omega_d / omega_w at mu = {mu:g}, beta = {beta:g}", boat.optimum(mu, beta), gamma, 0.02,
                why="5.43 falls with beta where the optimum rises",
                assumption="a is the largest during the wave" if beta < 0.3 else "", note="1 %")
        )  # fmt: skip
    quarter = np.pi / 4
    return [
        *found,
        Row("5.36 with n = 1, velocity of mode 2 there for p_2 = 3 omega_w (5.32, less its factor)", 0.0,
            float(np.cos(quarter) - np.cos(3 * quarter)), 1e-9, implied=float(np.cos(quarter) - np.cos(3 * quarter)),
            why="5.34 is zero where its argument is 2 n pi, not n pi; 'n = 2' of the text is n = 1"),
        Row("Fig. 5.2, a / a0 falls with the mass ratio: 0.6 against 0.3", boat.best(0.3)[1], boat.best(0.6)[1], 0.0,
            relation="<"),
    ]  # fmt: skip


def beam_itself() -> list[Row]:
    """Table 5.1."""
    inertia, area = 0.035 * 0.003**3 / 12, 0.035 * 0.003
    printed = (68.0, 220.4, 459.9, 786.4, 1200.0)
    found = [
        Row(f"Table 5.1, natural frequency {i + 1}", value, float(pinned.frequencies()[i + 1]), 0.05, "Hz",
            assumption="EI = 5.9 N m^2 and 120 g, as printed; see the next rows")
        for i, value in enumerate(printed)
    ]  # fmt: skip
    return [
        *found,
        Row("Table 5.1, flexural rigidity of 35 x 3 mm aluminium", 5.9, 70e9 * inertia, 0.05, "N m^2",
            why=f"5.9 needs E = {5.9 / inertia / 1e9:.1f} GPa; with 70 GPa the first frequency is "
            f"{68.014 * np.sqrt(70e9 * inertia / 5.9):.1f} Hz"),
        Row("Table 5.1, mass of 400 x 35 x 3 mm aluminium", 0.12, 2700 * area * pinned.LENGTH, 0.0005, "kg",
            why=f"120 g needs {pinned.MASS / area / pinned.LENGTH:.0f} kg/m^3"),
        Row("5.54, modal mass of mode 1 as printed", 1.0, _modal_mass(), 1e-6, implied=_modal_mass(),
            why="the braces need the power -1/2 and rho A"),
    ]  # fmt: skip


def _modal_mass() -> float:
    """rho A int psi^2 with the factor 1 / int of 5.54, by quadrature of 5.53."""
    omega = 2 * np.pi * pinned.frequencies()[1]
    p = (omega**2 * RHO_A / pinned.EI) ** 0.25
    nodes, weights = np.polynomial.legendre.leggauss(40)
    x = 0.5 * pinned.LENGTH * (nodes + 1.0)
    shape = np.sinh(p * pinned.LENGTH) * np.sin(p * x) + np.sin(p * pinned.LENGTH) * np.sinh(p * x)
    bracket = 0.5 * pinned.LENGTH * float(weights @ shape**2)
    return RHO_A / bracket


def without_damper() -> list[Row]:
    """Fig. 5.10: energies at the first separation, omega_w / omega_1 = 9."""
    end = pinned.separation(pinned.fall(WAVE))
    first = "the state meant is that of the first separation"
    found = [
        Row("Fig. 5.10, energy of mode 1 over E0", 4.0, 100 * end.modes[1], 0.5, "%", assumption=first),
        Row("Fig. 5.10, energy of mode 3 over E0", 5.0, 100 * end.modes[3], 0.75, "%", assumption=first,
            note="'almost 5 %'"),
        Row("Fig. 5.10, energy of mode 2 over E0", 1.0, 100 * end.modes[2], 0.0, "%", "<", first),
        Row("Fig. 5.10, energy of mode 4 over E0", 1.0, 100 * end.modes[4], 0.0, "%", "<", first),
        Row("5.3.1, contact of beam and wave mass", 0.6, 1e3 * end.t, 0.1, "ms", assumption=first, note="'about'"),
        Row("5.3.1, energy of the rigid mode over the total", 80.0, 100 * end.modes[0], 0.0, "%", ">",
            why="the wave mass has 16 % of the total then; over the energy of the beam it is more than 80 %"),
        Row("5.3.1, energy of the rigid mode over that of the beam", 80.0, 100 * end.shares[0], 0.0, "%", ">",
            assumption="'total' is the energy of the beam"),
        Row("5.61, energy over E0 that it takes for the beam's and that is in the spring k_w", 0.0, 100 * end.spring,
            0.01, "%", why="5.61 leaves out the spring of the wave mass, which is compressed at separation"),
    ]  # fmt: skip
    fine = pinned.separation(pinned.fall(WAVE, modes=20))
    found.append(
        Row("5.3.1, 'only five elastic modes': contact with 20 modes over that with 6", 1.0, fine.t / end.t, 0.05,
            note="5 %")
    )  # fmt: skip
    return found


def with_damper() -> list[Row]:
    """Figs 5.11 to 5.13, energies over that of the beam."""
    guess = f"mass ratio {MU:g}, which is not printed; energies over that of the beam at the first separation"
    at_5, at_40 = (pinned.separation(pinned.fall(WAVE, MU, damper)) for damper in (5.0, 40.0))
    ratios = np.linspace(13.0, 23.0, 21)
    beams = [pinned.separation(pinned.fall(WAVE, MU, float(r))) for r in ratios]
    best = int(np.argmin([one.beam for one in beams]))
    point, at = beams[best], float(ratios[best])
    found = [
        Row("Fig. 5.11, mode 1 at omega_d / omega_1 = 5", 0.7, 100 * at_5.shares[1], 0.05, "%", assumption=guess),
        Row("Fig. 5.11, mode 3 at omega_d / omega_1 = 5", 3.6, 100 * at_5.shares[3], 0.05, "%", assumption=guess),
    ]
    for mode, printed, within in ((1, 2.0, 0.5), (3, 2.2, 0.1), (5, 0.17, 0.05)):
        found.append(
            Row(f"Fig. 5.12, mode {mode} at the lowest energy (point P)", printed, 100 * point.shares[mode], within,
                "%", assumption=f"{guess}; P is at omega_d / omega_1 = {at:.1f}")
        )  # fmt: skip
    found += [
        Row("Fig. 5.12, its caption's omega_d / omega_1 = 5: mode 1 there", 2.0, 100 * at_5.shares[1], 0.5, "%",
            implied=0.7, why="Fig. 5.11 has these parameters and another energy; P is the minimum"),
        Row("Fig. 5.13, energy of the beam at omega_d / omega_1 = 40 over that at P: mode 5 is larger",
            100 * point.shares[5], 100 * at_40.shares[5], 0.0, "%", ">", assumption=guess),
        Row("Fig. 5.13, mode 1 at omega_d / omega_1 = 40, 'almost the same' as in Fig. 5.12", 2.0,
            100 * at_40.shares[1], 0.5, "%", assumption=guess),
    ]  # fmt: skip
    return found


def in_time() -> list[Row]:
    """Fig. 5.9: kinetic energies."""
    guess = f"mass ratio {MU:g} and the omega_d / omega_1 of Figs 5.11 to 5.13, 5, 17.9 and 40; at the first separation"
    three = [pinned.separation(pinned.fall(WAVE, MU, ratio)) for ratio in (5.0, 17.9, 40.0)]
    ratios = np.geomspace(5.0, 40.0, 61)
    all_of_them = [pinned.separation(pinned.fall(WAVE, MU, float(ratio))) for ratio in ratios]
    most = float(ratios[int(np.argmax([one.wave for one in all_of_them]))])
    least = float(ratios[int(np.argmin([one.beam for one in all_of_them]))])
    dampers = [one.damper for one in all_of_them]
    return [
        Row("Fig. 5.9, kinetic energy of m_d is 'independent' of omega_d: largest over smallest of three", 1.0,
            max(one.damper for one in three) / min(one.damper for one in three), 0.2, assumption=guess,
            note="a fifth is allowed"),
        Row("Fig. 5.9, the same of all omega_d / omega_1 from 5 to 40", 1.0, max(dampers) / min(dampers), 0.2,
            assumption=f"mass ratio {MU:g}; at the first separation",
            why="near omega_d / omega_1 = 9 the damper keeps a third less"),
        Row("Fig. 5.9, kinetic energy of m_w is 'influenced': largest over smallest of three", 1.2,
            max(one.wave for one in three) / min(one.wave for one in three), 0.0, relation=">", assumption=guess,
            note="a fifth is asked for"),
        Row("Fig. 5.9, of three: energy of m_w where the beam has least, over the largest", 1.0,
            min(three, key=lambda one: one.beam).wave / max(one.wave for one in three), 0.0, assumption=guess),
        Row("Fig. 5.9, omega_d of least energy of the beam over that of most energy of m_w", 1.0, least / most, 0.1,
            assumption=f"mass ratio {MU:g}",
            why="5.61 also counts what the damper has, which still rises from one to the other",
            note="a tenth is allowed"),
    ]  # fmt: skip


def lowest() -> list[Row]:
    """Fig. 5.15: where the beam keeps least, omega_w = 4700 rad/s."""
    wave = 4.7e3 / (2.0 * np.pi * float(pinned.frequencies()[1]))
    ratios = np.linspace(0.3, 5.0, 471)
    found = []
    for mu in (0.1, 0.3, 0.6):
        places = pinned.minima(wave, mu, ratios)
        least = min(energy for _, energy in places)
        others = max(energy for _, energy in places)
        at = min(places, key=lambda one: one[1])[0]
        found += [
            Row(f"Fig. 5.15, number of minima for omega_d / omega_w up to 5, mu = {mu:g}", 2.0, float(len(places)), 0.0,
                assumption="energy at the first separation; below 0.3 contacts part more than once",
                why="their number grows with the mass, from one to five, and they differ little: here "
                f"{100 * least:.2f} to {100 * others:.2f} % of the energy"),
            Row(f"5.5, the lowest of them over 5.45, mu = {mu:g}: 'a little difference'", 1.0, at / boat.optimum(mu),
                0.1, why="5.45 is where a rigid boat accelerates least; a beam keeps least energy elsewhere, the "
                "further away the heavier the damper", note="a tenth is allowed"),
        ]  # fmt: skip
    return found


def accelerations() -> list[Row]:
    """Figs 5.16 and 5.17: the free end up to 1.5 ms, K_w = 5e5 N/m."""

    def peak(mu: float = 0.0, added: float = 0.0, modes: int = 6) -> float:
        gamma = boat.optimum(mu) if mu else 0.0
        return float(np.abs(pinned.accelerations(5e5, mu, gamma, modes, added)[1]).max())

    window = "1.5 ms, and the six modes of the source"
    found = [
        Row(f"Fig. 5.16, peak at mu = {heavy:g} over that at {light:g}: falls", 1.0, peak(heavy) / peak(light), 0.0,
            relation="<", assumption=window)
        for light, heavy in ((0.0, 0.1), (0.1, 0.2), (0.2, 0.4))
    ]  # fmt: skip
    found.append(
        Row("5.3.1, 'only five elastic modes': peak of the free end with 40 modes over that with 6", 1.0,
            peak(modes=40) / peak(), 0.1, why="an acceleration needs modes that 0.5 ms of contact still reach; with "
            "60 modes it is 1.52, too", note="a tenth is allowed")
    )  # fmt: skip
    for modes in (6, 40):
        found += [
            Row(f"Fig. 5.17, peak with the damper over that with the added mass, mu = {mu:g}, {modes} modes", 1.0,
                peak(mu, modes=modes) / peak(added=mu, modes=modes), 0.0, relation="<",
                assumption=window if modes == 6 else "",
                why="its contact is harder than the wave's and excites modes that six do not have; the order is an "
                "artefact of truncation")
            for mu in (0.1, 0.2, 0.4)
        ]  # fmt: skip
    return found


def stiffnesses() -> list[Row]:
    """Units and stiffnesses of Fig. 5.14 and Table 5.2."""
    found = [
        Row("Fig. 5.14, omega_w = 4.7e3 with the unit N/m", 4.7e3, pinned.WAVE_MASS * 4.7e3**2, 1.0, "N/m",
            implied=pinned.WAVE_MASS * 4.7e3**2,
            why="it is rad/s: the stiffness is then 4.9e5 N/m, the upper end of Table 5.1"),
    ]  # fmt: skip
    for mu, printed in ((0.1, 1e5), (0.2, 5e5), (0.4, 1e6)):
        by_545 = mu * pinned.MASS * 3e5 / pinned.WAVE_MASS * boat.optimum(mu) ** 2
        found.append(
            Row(f"Table 5.2, K_d at mu = {mu:g} as the optimum of 5.45 with K_w = 3e5 N/m", printed, by_545,
                0.05 * printed, "N/m", why="the table does not follow 5.45; its omega_d / omega_w are 0.78, 1.24, 1.24")
        )  # fmt: skip
    return found


def hull() -> list[Row]:
    """Section 5.3.2 and 5.5: the foam boat behaves like two masses."""
    own = foam.identified()
    made = "a hull of ours: its bottom's thickness and E are found from these two frequencies"
    slow = "a hull of ours, a wave at a tenth of its bending frequency"
    shapes = dict(zip(("bending", "torsion"), foam.frequencies(own.basis, own.model), strict=True))
    at = boat.optimum(MU)
    ratios = [foam.ratio(own, mu, boat.optimum(mu)) for mu in (0.1, 0.3, 0.6)]
    guess = "a uniform free-free beam, an even pressure, its first bending frequency {:g} times the wave's"
    return [
        Row("Fig. 5.22, first elastic mode: bending", foam.BENDING, shapes["bending"], 0.5, "Hz", assumption=made,
            note="walls of 40 or 60 mm fit as well, with another E: two numbers for two numbers"),
        Row("Fig. 5.22, second elastic mode: torsion", foam.TORSION, shapes["torsion"], 0.5, "Hz", assumption=made),
        Row("5.5, a / a0 of a foam hull of finite elements against two masses, mu = 0.3, at 5.45", boat.ratio(MU, at),
            ratios[1], 0.02, assumption=slow, note="'almost the same'"),
        Row("5.5, the same with a wave at a third of the bending frequency", boat.ratio(MU, at),
            foam.ratio(own, MU, at, foam.BENDING / 3.0), 0.02, assumption="a hull of ours",
            why="a hull as soft as that bends under the damper; the wave's period is not printed"),
        Row("Fig. 5.23, a / a0 at mu = 0.3 over that at 0.1: falls", 1.0, ratios[1] / ratios[0], 0.0, relation="<",
            assumption=slow),
        Row("Fig. 5.23, a / a0 at mu = 0.6 over that at 0.3: falls", 1.0, ratios[2] / ratios[1], 0.0, relation="<",
            assumption=slow),
    ] + [
        Row(f"5.5, a / a0 of the hull against two masses, mu = 0.3, at 5.45, bending at {elastic:g} omega_w",
            boat.ratio(MU, boat.optimum(MU)), boat.hull_ratio(MU, boat.optimum(MU), elastic), 0.02,
            assumption=guess.format(elastic),
            why="a hull as soft as that bends under the damper instead of slowing down",
            note="hull, mass, damping and wave are not given: 293 Hz says nothing without the wave's period")
        for elastic in (20.0, 3.0)
    ]  # fmt: skip
