"""Files of MATLAB that are damaged: refused before SciPy, which they would crash, reads them."""

import struct
from pathlib import Path

import numpy as np
import pytest
import scipy.io

import tweezer

TIMES = np.arange(200) * 1e-3
#: Of the first array, which is the time: its flags, and the tag of its numbers
FLAGS, NUMBERS = 144, 176


def written(**options):
    arrays = {"t": TIMES, "x": np.sin(TIMES), "more": {"note": "mine", "x": np.eye(3)}}
    scipy.io.savemat("r.mat", arrays, **options)


def changed(at, *words):
    with Path("r.mat").open("r+b") as file:
        file.seek(at)
        file.write(struct.pack(f"<{len(words)}I", *words))


@pytest.fixture(autouse=True)
def _here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("compressed", [False, True])
def test_sound_file_is_read(compressed):
    written(do_compression=compressed)
    found = tweezer.load_recording("r.mat", scale="1 um", columns="t=t,x=x")
    np.testing.assert_allclose(found.times, TIMES)


@pytest.mark.parametrize(
    ("at", "words", "message"),
    [
        (NUMBERS, (0x8009,), "an element has the code 32777"),  # beyond the table of types
        (NUMBERS, (14,), "an element has the code 14"),
        (NUMBERS, (8,), "an element has the code 8"),
        (NUMBERS, (9, 2**31), "an element is longer than its place"),
        (FLAGS, (0x806,), "an array has 4 parts; must have at least 5"),  # complex, but real
        (FLAGS, (0x5,), "an array has 4 parts; must have at least 6"),  # sparse, but full
        (FLAGS - 8, (9,), "an array has no flags"),
    ],
)
def test_damaged_file_is_refused(at, words, message):
    written()
    changed(at, *words)
    with pytest.raises(tweezer.ResultError, match=rf"^r\.mat: .*{message}"):
        tweezer.load_recording("r.mat", scale="1 um")


def test_packed_array_that_is_too_long_is_refused(monkeypatch):
    written(do_compression=True)
    monkeypatch.setattr("tweezer.reading.arrays._MOST_BYTES", 100)
    with pytest.raises(tweezer.ResultError, match="an array has more than 100 bytes"):
        tweezer.load_recording("r.mat", scale="1 um")
