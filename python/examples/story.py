"""A robot that is not what its model says: identified, doubted, diagnosed, watched. Cells as an editor or Jupyter runs them,
or all at once: ``python python/examples/story.py``. Needs dynid and numpy; shows a bar where tqdm is installed."""

# %% [markdown]
# # From a table to a model that can be trusted
#
# A Staubli TX-40, simulated: its links are those of the table in `robots/tx40.yaml`, and in the gear of joint 2 there is
# Stribeck friction that nobody has told the model of. Let us see who finds out.

# %%
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import dynid

r = dynid.Robot("tx40")
print(r)
print("base parameters:", ", ".join(r.names[:8]), "...")
print(r.names[0], "is", r.relations[0])

# %% [markdown]
# ## Motions
#
# Sums of sines with different frequencies for each joint, so that every parameter shows. Positions come from encoders with
# 1e-6 rad of noise, torques with 0.1 N.m.


# %%
def motion(seed: int, seconds: float = 12.0, rate: float = 500.0):
    """t, and q, dq, ddq of three sines a joint."""
    rng = np.random.default_rng(seed)
    t = np.arange(0, seconds, 1 / rate)
    size = rng.uniform(0.3, 0.6, (3, r.joints)) * np.array([[1.0], [0.6], [0.3]])
    speed = rng.uniform(0.7, 1.3, (3, r.joints)) * np.array([[1.0], [2.3], [5.1]])
    at = t[:, None, None] * speed + rng.uniform(0, 2 * np.pi, (3, r.joints))
    q = (size * np.sin(at)).sum(1)
    dq = (size * speed * np.cos(at)).sum(1)
    ddq = -(size * speed**2 * np.sin(at)).sum(1)
    return t, q, dq, ddq


def stribeck(speed, size: float):
    """Friction that falls as the joint gets faster than 0.15 rad/s, N.m."""
    return size * np.exp(-((speed / 0.15) ** 2)) * np.tanh(speed / 1e-3)


def record(seed: int, hidden: float) -> dynid.Recording:
    """What the robot's log has: positions and torques."""
    rng = np.random.default_rng(1000 + seed)
    t, q, dq, ddq = motion(seed)
    tau = r.torque(r.chi, q, dq, ddq)
    tau[:, 1] += stribeck(dq[:, 1], hidden)
    tau += rng.normal(0, 0.1, tau.shape)
    return dynid.Recording(r, t, q + rng.normal(0, 1e-6, q.shape), tau, title=f"motion {seed}")


# %% [markdown]
# ## Parameters
#
# The regressor of many states at once, then the same thing as a well conditioned estimate with its uncertainty.

# %%
t, q, dq, ddq = motion(1)
W = r.regressor(q, dq, ddq)
print("W of", len(t), "states:", W.shape)

recordings = [record(seed, hidden=4.0) for seed in (1, 2, 3)]
fit = dynid.identify(recordings, method="idim-wls")
print(fit)
for name, value, sigma, unit in list(zip(fit.names, fit.values, fit.sigma, fit.units))[:6]:
    print(f"  {name:6} {value:8.4f} +- {sigma:.2g} {unit}")

# %% [markdown]
# ## Doubt
#
# On a motion that the fit has not seen, joint 2 is worse than it must be: the noise is 0.1 N.m.

# %%
t, q, dq, ddq = motion(9)
((_, _, measured),) = record(9, hidden=4.0).arrays()
left = measured - fit.predict(q, dq, ddq)
print("left over, N.m:", np.round(left.std(axis=0), 3))
worst = int(np.argmax(left.std(axis=0)))
print("worst is joint", worst + 1)

# %% [markdown]
# ## Diagnosis
#
# Which physics is missing, and does it hold on motion that no parameter was fitted to?

# %%
d = dynid.diagnose(recordings, test=record(9, hidden=4.0), progress=True)
print("\n".join(d.verdict))
for f in d.findings:
    print(f, f"confidence {f.confidence:.2f}")
    for name, (value, spread, unit) in f.parameters.items():
        print(f"  {name} = {value:.3g}" + (f" +- {spread:.2g}" if spread else "") + f" {unit}")
if d.on_test is not None:
    before, after = d.on_test
    print(f"error on the test motion: {before:.2%} without it, {after:.2%} with it")

# %% [markdown]
# ## Watching it
#
# The model with the law is what is normal from now on. Next month's recording is compared with it: what it knows is no news.

# %%
with TemporaryDirectory() as folder:
    path = Path(folder) / "normal.json"
    d.model.save(path)
    later = dynid.diagnose([record(seed, hidden=4.0) for seed in (21, 22)], reference=path)
    print("the same robot, later:", later.findings)
    d.report(Path(folder) / "report.html")

# %% [markdown]
# ## Fleets
#
# What an identification needs of a recording stays where the recording is until the answer is wanted: factors are bytes, which
# merge in any order.

# %%
sent = [bytes(dynid.factor(recording, band=20)) for recording in recordings]
merged = dynid.solve(dynid.merge([dynid.Factors.from_bytes(data, r) for data in sent]))
together = dynid.identify(recordings, band=20)
apart = np.abs(merged.values - together.values) / together.sigma
print("merged factors and all recordings at once differ by", f"{apart.max():.1g} standard deviations at most")
