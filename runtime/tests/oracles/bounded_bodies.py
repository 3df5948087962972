"""Bodies in ellipsoids nearest to a prior, by cvxpy with Clarabel: what dynid's own search is compared with.

    pip install cvxpy clarabel numpy
    python3 runtime/tests/oracles/bounded_bodies.py        writes bounded_bodies.json beside itself

Random problems of two or three links: base parameters are random combinations of inertial parameters, the truth and the prior
random bodies, the ellipsoids small enough that most hold a body back. Minimised is

    1/2 |(K x - chi) / sigma|^2 + gamma sum_k [tr(P0_k^-1 P_k) - ln det P_k + ln det P0_k - 4],   tr(P_k Q_k) >= 0
"""

import json
import pathlib

import cvxpy as cp
import numpy as np

rng = np.random.default_rng(14)
NAMES = ["XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M"]


def ten(mass, centre, covariance):
    """XX XY XZ YY YZ ZZ MX MY MZ M of a body by its mass, centre of mass and covariance of its density."""
    second = mass * (covariance + np.outer(centre, centre))
    inertia = np.trace(second) * np.eye(3) - second
    return np.array([*inertia[np.triu_indices(3)], *(mass * centre), mass])


def pseudo(x):
    """The pseudo-inertia as an expression of ten numbers."""
    xx, xy, xz, yy, yz, zz, mx, my, mz, m = (x[i] for i in range(10))
    return cp.bmat([
        [(yy + zz - xx) / 2, -xy, -xz, mx],
        [-xy, (xx + zz - yy) / 2, -yz, my],
        [-xz, -yz, (xx + yy - zz) / 2, mz],
        [mx, my, mz, m],
    ])


def turned(values):
    q, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    matrix = q @ np.diag(values) @ q.T
    return (matrix + matrix.T) / 2


def problem(links, gamma):
    rows = 6 * links
    combinations = []
    k = np.zeros((rows, 10 * links))
    for row in range(rows):
        chosen = rng.choice(10 * links, size=3, replace=False)
        values = rng.uniform(-1, 1, 3).round(3)
        k[row, chosen] = values
        combinations.append([[int(i), float(v)] for i, v in zip(chosen, values)])
    truth = np.concatenate([ten(rng.uniform(1, 6), rng.uniform(-0.3, 0.3, 3), turned(rng.uniform(0.002, 0.04, 3)))
                            for _ in range(links)])
    prior = [ten(rng.uniform(1, 6), rng.uniform(-0.1, 0.1, 3), turned(rng.uniform(0.004, 0.01, 3)))
             for _ in range(links)]
    ellipsoids = [{"centre": rng.uniform(-0.05, 0.05, 3).tolist(), "shape": turned(rng.uniform(0.02, 0.09, 3)).tolist()}
                  for _ in range(links)]
    sigma = 0.1 * (0.1 + np.abs(k @ truth))
    chi = k @ truth + sigma * rng.standard_normal(rows)

    x = cp.Variable(10 * links)
    objective = 0.5 * cp.sum_squares(cp.multiply(1 / sigma, k @ x - chi))
    constraints, margins = [], []
    for j in range(links):
        p = cp.Variable((4, 4), PSD=True)
        own = x[10 * j:10 * j + 10]
        constraints.append(p == pseudo(own))
        p0 = pseudo(prior[j]).value
        objective += gamma * (cp.trace(np.linalg.inv(p0) @ p) - cp.log_det(p) + np.linalg.slogdet(p0)[1] - 4)
        inverse = np.linalg.inv(np.array(ellipsoids[j]["shape"]))
        c = np.array(ellipsoids[j]["centre"])
        q = np.block([[-inverse, (inverse @ c)[:, None]], [(inverse @ c)[None, :], np.array([[1 - c @ inverse @ c]])]])
        margins.append(cp.trace(p @ q))
    constraints += [m >= 0 for m in margins]
    whole = cp.Problem(cp.Minimize(objective), constraints)
    whole.solve(solver=cp.CLARABEL)
    assert whole.status == "optimal", whole.status
    return {
        "links": links, "gamma": gamma, "base": combinations, "chi": chi.tolist(), "sigma": sigma.tolist(),
        "prior": [p.tolist() for p in prior], "ellipsoids": ellipsoids,
        "x": x.value.tolist(), "objective": float(whole.value),
        "active": [bool(c.dual_value > 1e-5) for c in constraints[links:]],
    }


problems = [problem(2 + k % 2, [0.01, 0.1, 1.0, 30.0][k % 4]) for k in range(12)]
print(sum(sum(p["active"]) for p in problems), "of", sum(p["links"] for p in problems), "bounds hold a body back")
path = pathlib.Path(__file__).with_name("bounded_bodies.json")
path.write_text(json.dumps({"names": NAMES, "problems": problems}) + "\n")
