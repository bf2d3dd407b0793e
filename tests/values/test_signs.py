"""The signs of print: in texts that people read, where the encoding has them."""

import io
import subprocess
import sys

import pytest

import tweezer
from tweezer.values.signs import for_stream, typeset


@pytest.mark.parametrize(
    ("plain", "print_"),
    [("50.35 +- 0.49 pN/um", "50.35 ± 0.49 pN/µm"), ("um^2/s", "µm²/s"), ("kg/m^3", "kg/m³"),
     ("1.002 mPa s", "1.002 mPa·s"), ("9 nN s/m", "9 nN·s/m"), ("2 pN nm s", "2 pN·nm·s"),
     ("-3 pN um, at 5 us", "-3 pN·µm, at 5 µs"), ("at, um", "at, µm"), ("1 (um)", "1 (µm)"),
     ("50 um/V", "50 µm/V"), ("to 0.5 um.", "to 0.5 µm.")],
)  # fmt: skip
def test_units_and_uncertainties_are_typeset(plain, print_):
    assert typeset(plain) == print_
    assert typeset(print_) == print_


@pytest.mark.parametrize(
    "text",
    ["silica-1um", "data um.csv", "/data/um.nc", "beam.power_um", "usual", "10^-6", "a^2 + b^2",
     "12 s", "force by quadrature"],
)  # fmt: skip
def test_names_and_other_words_stay(text):
    assert typeset(text) == text


def test_a_stream_without_the_signs_has_ascii():
    for encoding, text in (
        ("ascii", "1 +- 2 um"), ("cp437", "1 +- 2 um"), ("utf-8", "1 ± 2 µm"),
        ("latin-1", "1 ± 2 µm"),
    ):  # fmt: skip
        stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
        assert for_stream("1 +- 2 um", stream) == text
    assert for_stream("1 +- 2 um", io.StringIO()) == "1 ± 2 µm"
    assert for_stream("1 +- 2 um", None) == "1 ± 2 µm"


@pytest.mark.parametrize(("encoding", "viscosity"), [("ascii", "mPa s"), ("utf-8", "mPa·s")])
def test_a_result_in_python_follows_the_standard_output(encoding, viscosity):
    program = "import tweezer\nprint(tweezer.load_scene('silica-1um'))"
    done = subprocess.run(
        [sys.executable, "-c", program], env={"PYTHONIOENCODING": encoding},
        capture_output=True, check=True,
    )  # fmt: skip
    assert viscosity in done.stdout.decode(encoding)
    html = tweezer.load_scene("silica-1um")._repr_html_()
    assert "mPa·s" in html
