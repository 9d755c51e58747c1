"""The methods of scipy.integrate.solve_ivp as methods of clothsim: clothsim-program(7).

    clothsim compare scenes/drum.json -i 'program:python3 scipy_methods.py DOP853,dop853'

The argument is one of RK23, RK45, DOP853, Radau, BDF and LSODA. Each advance starts the solver anew,
and so does each step that clothsim changes, by contact say. The implicit ones form a dense Jacobian of
6n columns from products with the host's derivative: for small scenes.
"""
import sys

import numpy as np
import scipy
from clothsim_program import Unable, serve
from scipy.integrate import BDF, DOP853, LSODA, RK23, RK45, Radau

SOLVERS = {"RK23": (RK23, 3), "RK45": (RK45, 5), "DOP853": (DOP853, 8), "Radau": (Radau, 5),
           "BDF": (BDF, 5), "LSODA": (LSODA, 12)}
name = sys.argv[1] if len(sys.argv) > 1 else ""
if name not in SOLVERS:
    sys.exit(f"scipy_methods.py: found {name!r}, expected one of {', '.join(SOLVERS)}")
solver, order = SOLVERS[name]
implicit = solver in (Radau, BDF, LSODA)


def jacobian(host):
    """The function J(t, y) = d(dy/dt)/dy, (6n, 6n): unit directions through host.jvp."""
    n3 = 3 * host.n
    weights = np.tile(host.inv_mass, 3)

    def evaluate(t, y):
        j = np.zeros((2 * n3, 2 * n3))
        j[:n3, n3:] = np.eye(n3)
        for k in range(2 * n3):
            direction = np.zeros(2 * n3)
            direction[k] = 1
            j[n3:, k] = host.jvp(t, y, direction) * weights
        host.counts[2] += 1
        return j
    return evaluate


def advance(host, t0, t1, y):
    rtol = host.options["rtol"]
    # an absolute tolerance that nobody set is the relative one times the scales of the scene
    atol = rtol * np.repeat([host.length_scale, host.speed_scale], 3 * host.n)
    settings = {"rtol": max(rtol, 3e-14), "atol": atol}
    if implicit:
        settings["jac"] = jacobian(host)
    pinned, new = np.tile(host.inv_mass == 0, 6), None
    while t0 < t1:
        new = new or solver(host.rate, t0, y, t1, **settings)
        message = new.step()
        if new.status == "failed":
            raise Unable(message or "the step is too small")
        # a solve moves pinned particles by rounding, which clothsim refuses
        state = np.where(pinned, y, new.y)
        y, changed = host.commit(new.t, new.t - t0, state)
        t0 = new.t
        new = None if changed else new


serve(advance, name="scipy-" + name.lower(), order=order, summary=f"SciPy's {name}",
      source="Virtanen et al. 2020", library=f"SciPy {scipy.__version__}",
      traits="adaptive library-bits" + (" implicit" if implicit else ""), fails="crossing",
      options=[("rtol", "", 1e-6, 1e-13, 1.0, "relative tolerance of a step")],
      needs="jvp" if implicit else "")
