"""The command `tweezer detect`: its table against the dataset of `tweezer.detect`."""

import tweezer

SETTINGS = ("--set", "detector.numerical_aperture=0.9", "--set", "beam.polarisation=linear")


def test_detect_prints_the_signals_at_rest(command_line):
    outcome = command_line("detect", "silica-1um", *SETTINGS, "--out", "signals.nc")
    assert outcome.code == 0
    found = tweezer.load("signals.nc")
    rows = {line[:34].strip(): line[34:].split() for line in outcome.out.splitlines()}
    slope = found["slope"].values.diagonal()
    for name, values in {
        "signal, mW": 1e3 * found["signal"].values.round(10),
        "slope along its axis, mW/um": 1e-3 * slope,
        "linear within 5 % to, nm": 1e9 * found["linear_range"].values,
        "apparent for 100 nm along x, nm": 1e9 * found["crosstalk"].values[:, 0].round(13),
        "shot noise, pm/sqrt(Hz)": 1e12 * found["shot_noise"].values,
        "part of the information, %": 100 * found["information"].values,
    }.items():
        assert [float(each) for each in rows[name]] == [
            float(f"{each:.{3 if 'noise' in name or 'part' in name else 4}g}") for each in values
        ]


def test_detect_without_a_detector_is_refused(command_line):
    outcome = command_line("detect", "silica-1um")
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err == "detector: missing; give [detector] with a numerical_aperture\n"
