"""Figures: axes with units, colours that stay with their case, nothing global, nothing half."""

import re
import runpy
import subprocess
import sys
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from acoustics.levels.bands import truncate_response
from acoustics.levels.sound_levels import level_spectrum, response_levels
from acoustics.receivers import Receiver
from acoustics.rooms.box_harmonic import PressureMap
from femstruct.modal.closed_form import given_modes
from femstruct.study.asked import RoomPlan, TimePlan
from femstruct.study.recorded import Channel
from femstruct.view.console import scaled
from femstruct.view.drawing import case_colours, case_lines, new_figure, save, thin_history
from femstruct.view.histories import contact_forces, energy, history, spectrum, travels
from femstruct.view.plots import drawings, figures, plot_all
from femstruct.view.sound_figures import draw_map, line_level, line_spacing, pressure_maps, receiver_peaks
from femstruct.view.spectra import frequency_response, sound
from femstruct.workflow.case_comparison import Spectra, compare

ROUNDING = 1e-12  # rounding: 7e-15 here at most

BY_HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))
BESIDE = "damper 0.6 / new"


@pytest.fixture(scope="module")
def result():
    return BY_HAND["study_by_hand"]()


def test_all_figures_are_drawn_to_files(result, tmp_path):
    (tmp_path / "pictures").mkdir()
    paths = plot_all(result, tmp_path / "pictures")
    names = {path.name for path in paths}
    assert {"frf_centre.png", "history_box.mic_pressure.png", "bodies.png"} <= names
    assert {"energy.png", "sound_box.mic.png"} <= names
    assert len(names) == len(paths) == len(list((tmp_path / "pictures").iterdir()))
    for path in paths:
        assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
        image = matplotlib.image.imread(path)
        assert image.shape[0] > 300 and image[..., :3].std() > 0.02  # something is drawn on the white


def test_every_axis_has_a_label_with_its_unit(result):
    unit = re.compile(
        r" in (Hz|s|ms|degrees|dB|[µmk]?(m|m/s|m/s²|N|Pa|J)|m/\(N s²\))( |$)|dB re (20 µPa|1 nm/s|1 µm/s²|1 N)$"
    )
    for name, figure in figures(result).items():
        lowest = min(axes.get_position().y0 for axes in figure.axes)
        for axes in figure.axes:
            if axes.get_position().width < 0.05:  # a colour scale
                continue
            if axes.get_position().y0 <= lowest + 1e-6:
                assert unit.search(axes.get_xlabel()), f"{name}: {axes.get_xlabel()!r}"
            if axes.get_ylabel():
                assert unit.search(axes.get_ylabel()), f"{name}: {axes.get_ylabel()!r}"


def test_a_case_has_one_colour_in_all_figures(result):
    colours = case_colours(result.cases, "without damper")
    assert len(set(colours.values())) == 2
    for figure in (history(result, "O_f.z velocity"), sound(result, "box.mic")):
        drawn = {line.get_label().split(":")[0]: line.get_color() for line in figure.axes[0].get_lines()}
        assert {name: drawn[name] for name in colours} == colours


def test_legend_tells_both_peaks_and_the_filter(result):
    figure = history(result, "O_f.z velocity")
    labels = figure.axes[0].get_legend_handles_labels()[1]
    channel = result.cases[BESIDE].channels["O_f.z velocity"]
    assert f"{1e3 * channel.whole:.4g} mm/s in all" in labels[1] or f"{channel.whole:.4g} m/s in all" in labels[1]
    assert "no filter" in figure.texts[0].get_text()
    assert all(" in the first impact (20 ms), " in label for label in labels)


def test_bodies_that_do_not_fall_back_are_drawn_without_gravity(result):
    falling = {
        name: replace(case, case=replace(case.case, study=replace(case.case.study, time=TimePlan(0.1, 1e4, True))))
        for name, case in result.cases.items()
    }
    assert not any(case.case.study.time.gravity for case in result.cases.values())
    assert travels(result).texts[0].get_text().endswith("(without gravity)")
    assert "gravity" not in travels(replace(result, cases=falling)).texts[0].get_text()


def test_history_shows_the_values_it_was_given(result):
    figure = history(result, "box.mic pressure")
    line = figure.axes[0].get_lines()[0]
    channel = result.cases["without damper"].channels["box.mic pressure"]
    t = result.cases["without damper"].response.t
    shown = len(line.get_xdata())
    np.testing.assert_allclose(line.get_xdata(), 1e3 * t[:shown])
    np.testing.assert_allclose(line.get_ydata(), channel.values[:shown])


def test_a_channel_only_one_case_has_is_drawn_alone(result):
    case = result.cases[BESIDE]
    rest = {name: channel for name, channel in case.channels.items() if name != "ball travel"}
    fewer = replace(result, cases={**result.cases, BESIDE: replace(case, channels=rest)})
    assert len(history(fewer, "ball travel").axes[0].get_lines()) == 1


def test_equal_responses_share_a_line_and_others_do_not(result):
    assert (
        len([line for line in frequency_response(result, "centre").axes[0].get_lines() if len(line.get_xdata()) > 2])
        == 1
    )
    case = result.cases[BESIDE]
    other = replace(case.frf["centre"], values=2 * case.frf["centre"].values)
    changed = replace(result, cases={**result.cases, BESIDE: replace(case, frf={"centre": other})})
    lines = [line for line in frequency_response(changed, "centre").axes[0].get_lines() if len(line.get_xdata()) > 2]
    assert len(lines) == 2
    np.testing.assert_allclose(lines[1].get_ydata(), 2 * lines[0].get_ydata())


def test_names_with_commas_have_colours_of_their_own(result):
    case = result.cases[BESIDE]
    frf = case.frf["centre"]
    named = {
        name: replace(case, frf={"centre": replace(frf, values=factor * frf.values)})
        for name, factor in (("without damper, hot", 2), ("without damper, cold", 3))
    }
    changed = replace(result, cases={"without damper": result.cases["without damper"], **named})
    lines = [line for line in frequency_response(changed, "centre").axes[0].get_lines() if len(line.get_xdata()) > 2]
    assert [line.get_color() for line in lines] == list(case_colours(changed.cases, "without damper").values())


def test_a_band_from_zero_starts_at_its_step_and_a_ratio_has_no_unit(result):
    case = result.cases["without damper"]
    frf = case.frf["centre"]
    f = np.arange(0.0, 500.5, 0.5)
    request = replace(frf.request, band=(0.0, 500.0), kind="transmissibility")
    ratio = replace(frf, request=request, frequency_hz=f, values=np.ones(len(f), dtype=complex), unit="1")
    alone = replace(result, cases={"without damper": replace(case, frf={"centre": ratio})})
    axes = frequency_response(alone, "centre").axes[0]
    assert axes.get_xlim() == (0.5, 500.0)
    assert axes.get_ylabel() == "|transmissibility|"


def test_all_of_a_frequency_response_is_inside_its_figure(result):
    case = result.cases["without damper"]
    frf = case.frf["centre"]
    wide = replace(
        frf,
        request=replace(frf.request, band=(1.0, 1000.0)),
        values=1e-9 * (1 + 0.1 * frf.values / abs(frf.values).max()),
    )
    alone = replace(result, cases={"without damper": replace(case, frf={"centre": wide})})
    figure = frequency_response(alone, "centre")
    for axes in figure.axes:
        box = axes.get_tightbbox(figure.canvas.get_renderer())
        assert box.x0 >= 0.0 and box.x1 <= figure.bbox.width


def test_spectrum_peaks_stand_on_the_mode_lines(result):
    axes = sound(result, "box.mic").axes[0]
    line = axes.get_lines()[0]
    x, y = line.get_xdata(), line.get_ydata()
    marked = [text.get_text() for text in axes.texts]
    assert marked == ["2", "3", "4", "5", "6"]
    loudest = x[np.argmax(y)]
    # the made-up pressure is loudest in its highest mode, 448.3 Hz; lines are 4 Hz apart
    assert loudest == pytest.approx(448.3, abs=4.0)
    name, frequency = list(receiver_peaks(result, "box").items())[-1]
    assert frequency == pytest.approx(448.3, abs=4.0)
    assert name.startswith("mode ")
    case = result.cases["without damper"]
    short = replace(case, basis=replace(case.basis, complete_below_hz=frequency - 1.0))
    below = receiver_peaks(replace(result, cases={**result.cases, "without damper": short}), "box")
    assert max(below.values(), default=0.0) < frequency - 1.0  # above, the modes are not complete


def test_energy_layers_reach_what_was_put_in(result):
    axes = energy(result).axes[0]
    top = axes.collections[-1].get_paths()[0].vertices[:, 1].max()
    put_in = axes.get_lines()[0].get_ydata()[0]
    assert top == pytest.approx(put_in, rel=1e-12) == 120.0  # mJ, made by hand


def test_the_energy_picture_says_who_lost_it(result):
    figure = energy(result)
    taken, rest = figure.axes[0].collections[-2:]
    assert [taken.get_label(), rest.get_label()] == ["lost in ball on floor", "lost elsewhere"]
    corners = taken.get_paths()[0].vertices[:, 1]
    assert corners.max() - corners[corners < corners.max() - 1.0].max() <= 20.0  # mJ, made by hand
    assert len({tuple(layer.get_facecolor()[0]) for layer in figure.axes[0].collections}) == 5


def test_losses_too_small_to_be_seen_are_not_named(result):
    case = next(iter(result.cases.values()))
    ledger = case.response.ledger
    small = replace(ledger, lost_contacts={"ball on floor": 1e-3 * ledger.lost_contacts["ball on floor"]})
    cases = {name: replace(case, response=replace(case.response, ledger=small)) for name in result.cases}
    labels = energy(replace(result, cases=cases)).axes[0].get_legend_handles_labels()[1]
    assert "dissipated" in labels and not [label for label in labels if label.startswith("lost")]


def test_contacts_that_are_not_recorded_are_drawn_too(result):
    assert contact_forces(result) is None
    fewer = {
        name: replace(case, channels={"O_f.z velocity": case.channels["O_f.z velocity"]})
        for name, case in result.cases.items()
    }
    labels = contact_forces(replace(result, cases=fewer)).axes[0].get_legend_handles_labels()[1]
    assert labels == ["without damper: peak 200 N", f"{BESIDE}: peak 100 N"]


@pytest.mark.parametrize(
    ("channel", "unit", "reference", "written"),
    [("O_f.z velocity", "m/s", 1e-9, "1 nm/s"), ("P.z acceleration", "m/s^2", 1e-6, "1 µm/s²"),
     ("net force on P", "N", 1.0, "1 N")],
)  # fmt: skip
def test_a_tone_has_its_level_in_the_spectrum_of_its_channel(result, channel, unit, reference, written):
    """The rms of a sine of a whole number of periods, in its own line."""
    case = result.cases["without damper"]
    t = case.response.t
    whole = round(100.0 * len(t) / case.response.clock.sampling)
    tone = 0.02 * np.sin(2 * np.pi * whole * np.arange(len(t)) / len(t))
    channels = {channel: Channel(channel, tone, unit, 0.02, 0.02)}
    axes = spectrum(replace(result, cases={"without damper": replace(case, channels=channels)}), channel).axes[0]
    x, y = axes.get_lines()[0].get_data()
    assert y.max() == pytest.approx(20 * np.log10(0.02 / np.sqrt(2) / reference), abs=ROUNDING)
    assert x[y.argmax()] == pytest.approx(100.0, abs=0.5 * case.response.clock.sampling / len(t))
    assert axes.get_ylabel().endswith(f"dB re {written}")


def test_no_decibels_of_what_has_no_reference_or_does_not_move(result):
    assert spectrum(result, "box.mic pressure") is None  # has a picture of its own
    assert spectrum(result, "ball travel") is None


def test_cases_are_told_apart_in_grey():
    """By how light their colours are, or by their dashes: all pairs of the first eight cases."""
    looks = list(case_lines("abcdefgh", "a").values())
    light = [to_rgb(look["color"]) @ np.array([0.2126, 0.7152, 0.0722]) for look in looks]
    for i, j in combinations(range(len(looks)), 2):
        # a tenth of white is what the eye tells in thin lines
        assert looks[i]["linestyle"] != looks[j]["linestyle"] or abs(light[i] - light[j]) > 0.1, (i, j)


def test_a_window_that_is_the_first_impact_is_drawn_once(result):
    short = {}
    for name, case in result.cases.items():
        peaks = replace(case.case.study.peaks, first_impact=0.9 * case.response.t[-1])
        short[name] = replace(case, case=replace(case.case, study=replace(case.case.study, peaks=peaks)))
    brief = replace(result, cases=short)
    assert len(history(result, "O_f.z velocity").axes) == 2 and len(energy(result).axes) == 4
    assert len(history(brief, "O_f.z velocity").axes) == 1 and len(energy(brief).axes) == 2


def test_a_force_is_shown_while_it_acts_and_the_longest_case_whole(result):
    """Made by hand: half a sine of 5 ms in a first impact of 20 ms; another case is cut to half its length."""
    left, _ = history(result, "ball on floor force").axes
    assert left.get_xlim()[1] == pytest.approx(1.25 * 5.0, rel=0.05)  # ms; samples
    case = result.cases["without damper"]
    half = len(case.response.t) // 2
    response = replace(case.response, t=case.response.t[:half])
    channels = {"O_f.z velocity": replace(channel := case.channels["O_f.z velocity"], values=channel.values[:half])}
    cut = replace(result, cases={**result.cases, "without damper": replace(case, response=response, channels=channels)})
    whole = history(cut, "O_f.z velocity").axes[1].get_xlim()[1]
    assert whole == history(result, "O_f.z velocity").axes[1].get_xlim()[1]


def test_a_net_force_that_one_contact_makes_is_drawn_once(result):
    def with_net(factor):
        made = {}
        for name, case in result.cases.items():
            force = next(iter(case.response.contacts.values())).force
            net = Channel("net force on O_f", -factor * force, "N", 1.0, 1.0)
            made[name] = replace(case, channels={**case.channels, net.name: net})
        return set(figures(replace(result, cases=made)))

    assert "history_net_force_on_O_f.png" not in with_net(1.0)
    assert "history_net_force_on_O_f.png" in with_net(0.5)


def test_sound_ends_with_the_modes_of_its_room(result, monkeypatch):
    monkeypatch.setattr(RoomPlan, "complete_below_hz", 200.0)
    cases = {}
    for name, case in result.cases.items():
        heard = truncate_response(case.rooms["box"], 200.0)
        levels = {f"box.{one}": value for one, value in response_levels(heard, case.rooms["box"]).items()}
        cases[name] = replace(case, rooms={"box": heard}, levels=levels)
    result = replace(result, cases=cases)
    above, below = sound(result, "box.mic").axes
    assert above.get_xlim()[1] == 200.0
    assert below.get_xticklabels()[-1].get_text() == "160"  # 200 Hz goes up to 224
    assert max(receiver_peaks(result, "box").values(), default=0.0) <= 200.0
    levels = compare("without damper", result.cases, Spectra()).cases[BESIDE].modes_db
    basis = result.cases["without damper"].basis
    assert all(basis.frequency_hz[mode - 1] <= 200.0 for mode in levels["box.mic pressure"])
    assert any(basis.frequency_hz[mode - 1] > 200.0 for mode in levels["O_f.z velocity"])


def test_a_spectrum_ends_where_something_is_known(result):
    """Modes that are given are complete to no frequency, bodies alone miss none; both are drawn."""
    case = result.cases["without damper"]
    half = 0.5 * case.response.clock.sampling
    given = replace(case.basis, complete_below_hz=0.0)
    alone = given_modes([], [], {})[0]
    for basis, end in ((given, min(2 * case.basis.frequency_hz.max(), half)), (alone, half)):
        other = replace(result, cases={**result.cases, "without damper": replace(case, basis=basis)})
        assert spectrum(other, "O_f.z velocity").axes[0].get_xlim()[1] == pytest.approx(end, rel=ROUNDING)
    lines = 5.0 / case.response.clock.duration  # where the fifth line of the record is
    few = replace(case, basis=replace(case.basis, complete_below_hz=lines))
    assert spectrum(replace(result, cases={**result.cases, "without damper": few}), "O_f.z velocity") is None


def test_a_body_that_came_to_rest_is_told_to_rest(result):
    case = result.cases[BESIDE]
    (name, body), *others = case.response.bodies.items()
    moved = np.linspace(0.0, -2.5e-3, len(body.velocity))
    for end, told in (
        (1e-9, "ends at -2.5 mm, at rest"),
        (-2e-3, "ends at -2.5 mm, moving"),
    ):  # a picture of displacements
        velocity = np.full(len(body.velocity), 0.5)
        bodies = {name: replace(body, velocity=velocity, displacement=moved, end_velocity=end), **dict(others)}
        response = replace(case.response, bodies=bodies)
        figure = travels(replace(result, cases={**result.cases, BESIDE: replace(case, response=response)}))
        assert f"{BESIDE}: {told}" in figure.axes[0].get_legend_handles_labels()[1]


def test_a_label_is_not_said_twice_side_by_side(result):
    left, right = history(result, "O_f.z velocity").axes
    assert left.get_ylabel() and right.get_ylabel() != left.get_ylabel()


def test_rows_say_what_is_drawn_of_whom(result):
    assert travels(result).axes[0].get_ylabel().startswith("displacement of ball in ")
    case = result.cases["without damper"]
    unrecorded = replace(result, cases={"without damper": replace(case, channels={})})
    assert contact_forces(unrecorded).axes[0].get_ylabel().startswith("force of ball on floor in ")


def test_what_strikes_late_is_drawn_from_its_own_beginning(result):
    """The first panel of a contact that closes after the first impact shows it; that of an early one starts at 0."""
    case = result.cases["without damper"]
    t, contact = case.response.t, case.response.contacts["ball on floor"]
    later = np.where(t > 0.6 * t[-1], np.interp(t - 0.6 * t[-1], t, contact.force), 0.0)
    contacts = {"late": replace(contact, force=later), "soon": contact}
    changed = replace(case, response=replace(case.response, contacts=contacts))
    late, whole, soon, _ = contact_forces(replace(result, cases={"without damper": changed})).axes
    assert late.get_xlim()[0] > 0.5 * whole.get_xlim()[1]
    assert np.ptp(late.get_lines()[0].get_ydata()) > 0.0
    assert soon.get_xlim()[0] == 0.0 >= whole.get_xlim()[0] >= -0.01 * whole.get_xlim()[1]
    assert soon.get_xlabel() == "time in ms"
    late_s = np.diff(late.get_xlim()) * (1e-3 if late.get_xlabel() == "time in ms" else 1.0)
    assert late_s == pytest.approx(1e-3 * np.diff(soon.get_xlim()), rel=0.05)  # samples


def test_a_study_of_modes_only_has_no_histories(result):
    bare = {name: replace(case, response=None, channels={}, rooms={}, levels={}) for name, case in result.cases.items()}
    assert set(figures(replace(result, cases=bare))) == {"frf_centre.png"}


@pytest.mark.parametrize("study", ["whole", "modes only", "silent"])
def test_what_has_nothing_to_show_says_why(result, study):
    cases = result.cases
    if study == "modes only":
        cases = {n: replace(one, response=None, channels={}, rooms={}, levels={}) for n, one in cases.items()}
    if study == "silent":
        silent = {n: {k: replace(c, whole=0.0) for k, c in one.channels.items()} for n, one in cases.items()}
        cases = {n: replace(one, channels=silent[n]) for n, one in cases.items()}
    found = drawings(replace(result, cases=cases))
    assert {name for name, one in found.items() if one.why_not()} == {
        name for name, one in found.items() if one.draw() is None
    }
    told = {name: one.why_not() for name, one in found.items() if one.why_not()}
    assert told["contact_forces.png"] == "there are no contacts" if study == "modes only" else told
    if study == "silent":
        assert told["spectrum_O_f.z_velocity.png"] == "it is zero"


def test_silence_can_be_drawn(result):
    """All zero: no logarithm of nothing, no empty axis."""
    quiet = {}
    for name, case in result.cases.items():
        channels = {
            key: replace(channel, values=0 * channel.values, first_impact=0.0, whole=0.0)
            for key, channel in case.channels.items()
        }
        rooms = {key: replace(room, p=0 * room.p) for key, room in case.rooms.items()}
        quiet[name] = replace(case, channels=channels, rooms=rooms)
    silent = replace(result, cases=quiet)
    for figure in (history(silent, "O_f.z velocity"), sound(silent, "box.mic")):
        figure.canvas.draw()
    assert pressure_maps(silent, "box") is None


def test_map_shows_the_room_from_above():
    first, second = np.linspace(0, 0.6, 7), np.linspace(0, 0.4, 5)
    spectrum = (np.cos(np.pi * first / 0.6)[None, :, None] * np.ones((1, 1, 5))).astype(complex) * 1j
    drawn = PressureMap("z", 0.05, first, second, np.array([283.0]), spectrum)
    figure = draw_map(drawn, ["mode 7"], [Receiver("mic", [0.3, 0.2, 0.05])], "box", 0.5)
    axes = figure.axes[0]
    values = axes.images[0].get_array()
    assert values.shape == (5, 7)  # rows along y
    np.testing.assert_allclose(values[0], np.cos(np.pi * first / 0.6), atol=ROUNDING)
    assert "91 dB re 20 µPa" in axes.get_title()  # 1 Pa/Hz, lines half a hertz apart: an rms of 1 Pa / sqrt(2)
    assert "levels of lines 0.5 Hz apart" in figure.texts[0].get_text()


def test_a_map_states_the_levels_of_the_spectrum(result):
    """A line has one level, in the map as in the picture of the spectrum."""
    heard = result.cases["without damper"].rooms["box"]
    f, level = level_spectrum(heard.p[0], heard.dt)
    told = line_level(np.abs(heard.spectrum[0]), line_spacing(heard))
    np.testing.assert_allclose(heard.frequency_hz[1:-1], f[1:-1], rtol=1e-12)  # rounding
    loud = level[1:-1] > level.max() - 120.0  # of what is less, rounding is a part
    np.testing.assert_allclose(told[1:-1][loud], level[1:-1][loud], atol=1e-6)  # dB, rounding


def test_units_are_scaled_and_extremes_kept():
    assert scaled("m/s", 0.012) == (pytest.approx(1e3), "mm/s")
    assert scaled("N", 3600.0) == (pytest.approx(1e-3), "kN")
    assert scaled("N", 1.6e7) == (pytest.approx(1e-6), "MN")
    assert scaled("rad/s", 3.0) == (1.0, "rad/s")
    y = np.random.default_rng(1).standard_normal(100_000)
    t, thin = thin_history(np.arange(100_000.0), y)
    assert len(t) < 3200 and thin.max() == y.max() and thin.min() == y.min()
    assert (np.diff(t) > 0).all() or (np.diff(t) >= 0).all()


def test_a_picture_is_whole_or_not_there(tmp_path):
    figure = new_figure(2, 2, "x")
    figure.savefig = None  # type: ignore[method-assign]
    with pytest.raises(TypeError):
        save(figure, tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_drawing_has_no_global_effects():
    code = (
        "import sys, matplotlib\n"
        "def settings():  # 'backend' resolves, and imports pyplot, when it is looked at\n"
        "    return {name: matplotlib.rcParams[name] for name in matplotlib.rcParams if name != 'backend'}\n"
        "before = settings()\n"
        "import femstruct.view.plots, femstruct.view.model_scene\n"
        "assert 'matplotlib.pyplot' not in sys.modules and 'pyvista' not in sys.modules\n"
        "assert settings() == before\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
