"""Reference values for the filters of dynid-runtime, from scipy.

    python3 runtime/tests/oracles/filters.py        writes filters.json beside itself
"""

import json
import pathlib

import numpy as np
import scipy.interpolate
import scipy.signal as sig

rng = np.random.default_rng(7)


def motion(n, rate):
    t = np.arange(n) / rate
    return np.sin(2 * np.pi * 1.3 * t) + 0.3 * np.cos(2 * np.pi * 7 * t + 0.4) + 0.02 * rng.standard_normal(n) + 2


def rounded(x):
    return [float(f"{v:.17g}") for v in np.asarray(x)]


out = {"filtfilt": [], "decimate": [], "spline": [], "gradient": [], "welch": []}
for order, cutoff, rate, n in [(1, 30, 500, 80), (2, 5, 500, 120), (3, 60, 500, 90), (4, 20, 95, 100),
                               (5, 100, 5000, 200), (8, 100, 5000, 240)]:
    x = motion(n, rate)
    sos = sig.butter(order, cutoff, fs=rate, output="sos")
    out["filtfilt"].append({"order": order, "cutoff": cutoff, "rate": rate, "input": rounded(x),
                            "output": rounded(sig.sosfiltfilt(sos, x, padlen=3 * (order + 1)))})
for factor, n in [(2, 150), (5, 300), (7, 400), (50, 1200)]:
    x = motion(n, 500)
    y = sig.decimate(x, factor, ftype="fir", zero_phase=True)
    # scipy pads with zeros at the ends; only rows whose whole support is inside are compared.
    half = 10 * factor
    first = -(-half // factor)
    last = (n - 1 - half) // factor
    out["decimate"].append({"factor": factor, "input": rounded(x), "first": first,
                            "output": rounded(y[first:last + 1]), "taps": rounded(
                                sig.firwin(20 * factor + 1, 1 / factor, window="hamming"))})
t = np.cumsum(rng.uniform(0.006, 0.014, 60))
x = np.sin(5 * t) + 0.1 * rng.standard_normal(60)
grid = t[0] + np.arange(int((t[-1] - t[0]) * 100) + 1) / 100
out["spline"].append({"time": rounded(t), "input": rounded(x), "rate": 100,
                      "output": rounded(scipy.interpolate.CubicSpline(t, x, bc_type="not-a-knot")(grid))})
x = motion(40, 500)
out["gradient"].append({"rate": 500, "input": rounded(x), "output": rounded(np.gradient(x, 1 / 500))})
for n, segment in [(300, 64), (301, 75)]:
    x = motion(n, 500)
    f, d = sig.welch(x, 500, nperseg=segment)
    out["welch"].append({"rate": 500, "segment": segment, "input": rounded(x), "frequency": rounded(f),
                         "density": rounded(d)})

path = pathlib.Path(__file__).with_name("filters.json")
path.write_text(json.dumps(out, separators=(",", ":")) + "\n")
print(path, path.stat().st_size, "bytes")
