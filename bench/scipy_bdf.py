#!/usr/bin/python3
"""BDF of SciPy against cvode-bdf of clothsim: the same drum, tolerance and time.

Prints a CSV line a solver and tolerance: solver, rtol, seconds of the processor (median, least,
most), error in m (root of the mean square over free particles, against a reference at 1e-12 that
clothsim computed by another method), steps, and how many times faster than SciPy's it is.
SciPy is served as well as it can be: one thread, forces in whole arrays, a sparse incidence
matrix to gather them, an analytic sparse Jacobian of a pattern that is laid out once, and the
pinned particles left out. Clothsim's seconds are those of the whole program.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"

try:
    import numpy as np
    from scipy import sparse
    from scipy.integrate import solve_ivp
except ImportError as missing:
    sys.exit(f"scipy_bdf.py: {missing}: install python3-numpy and python3-scipy")

# from one particle of the grid to another, and the key of the springs there
NEIGHBOURS = [((1, 0), "stretch"), ((0, 1), "stretch"), ((1, 1), "shear"), ((-1, 1), "shear"),
              ((2, 0), "bend"), ((0, 2), "bend")]


def grid_springs(body):
    """Ends (s,2), rest lengths (s) and stiffnesses (s) of the sheet."""
    columns, rows = body["cloth"]["grid"]
    size = body["cloth"]["size"]
    spacing = [size[0] / (columns - 1), size[1] / (rows - 1)]
    ends, lengths, stiffnesses = [], [], []
    for (right, down), kind in NEIGHBOURS:
        for i in range(rows):
            for j in range(columns):
                if 0 <= j + right < columns and i + down < rows:
                    ends.append((i * columns + j, (i + down) * columns + j + right))
                    lengths.append(np.hypot(right * spacing[0], down * spacing[1]))
                    stiffnesses.append(body["springs"][kind])
    return np.array(ends), np.array(lengths), np.array(stiffnesses)


class Sheet:
    """The equation of motion of the free particles; y holds x (n,3), then v (n,3)."""

    def __init__(self, scene, x):
        body = scene["bodies"][0]
        columns, rows = body["cloth"]["grid"]
        self.ends, self.length, self.stiffness = grid_springs(body)
        self.damping = body["springs"]["damping"]
        self.mass = body["mass"]["total"] / (columns * rows)
        self.gravity = np.array(scene["forces"]["gravity"])
        inner = np.zeros((rows, columns), bool)
        inner[1:-1, 1:-1] = True
        self.free = np.flatnonzero(inner)
        self.x = x.copy()
        self.lay_out()

    def lay_out(self):
        """What does not change: who feels which spring, and the pattern of the Jacobian."""
        n, springs = len(self.free), len(self.ends)
        number = np.full(len(self.x), -1)
        number[self.free] = np.arange(n)
        a, b = number[self.ends].T
        spring = np.arange(springs)
        rows = np.concatenate([a[a >= 0], b[b >= 0]])
        signs = np.concatenate([np.ones((a >= 0).sum()), -np.ones((b >= 0).sum())])
        columns = np.concatenate([spring[a >= 0], spring[b >= 0]])
        self.gather = sparse.csr_matrix((signs, (rows, columns)), (n, springs))

        # a block df_a/dx_b of a spring goes to four places, less at pinned ends
        places = [(a, b, 1), (b, a, 1), (a, a, -1), (b, b, -1)]
        keep = [(i >= 0) & (j >= 0) for i, j, _ in places]
        self.block = np.concatenate([spring[k] for k in keep])
        self.sign = np.concatenate([np.full(k.sum(), s) for k, (_, _, s) in zip(keep, places)])
        row = np.concatenate([i[k] for k, (i, _, _) in zip(keep, places)])
        column = np.concatenate([j[k] for k, (_, j, _) in zip(keep, places)])
        axis = np.arange(3)
        row = (3 * row[:, None, None] + axis[:, None] + 0 * axis).ravel() + 3 * n
        column = (3 * column[:, None, None] + 0 * axis[:, None] + axis).ravel()
        line = np.arange(3 * n)
        row = np.concatenate([line, row, row])
        column = np.concatenate([line + 3 * n, column, column + 3 * n])
        order = np.unique(column * 6 * n + row, return_inverse=True)
        self.slot = order[1]
        self.indices = order[0] % (6 * n)
        self.indptr = np.searchsorted(order[0] // (6 * n), np.arange(6 * n + 1))
        self.ones = np.ones(3 * n)

    def ends_of(self, y):
        """Unit directions (s,3), lengths (s) and differences of velocities (s,3)."""
        n = len(self.free)
        self.x[self.free] = y[:3 * n].reshape(n, 3)
        v = np.zeros_like(self.x)
        v[self.free] = y[3 * n:].reshape(n, 3)
        a, b = self.ends.T
        d = self.x[b] - self.x[a]
        length = np.sqrt(np.einsum("si,si->s", d, d))
        return d / length[:, None], length, v[b] - v[a]

    def rate(self, _, y):
        u, length, w = self.ends_of(y)
        pull = self.stiffness * (length - self.length)
        pull += self.damping * np.einsum("si,si->s", w, u)
        acceleration = self.gather @ (pull[:, None] * u) / self.mass + self.gravity
        return np.concatenate([y[len(y) // 2:], acceleration.ravel()])

    def jacobian(self, _, y):
        """Exact, the position derivative of the dampers included."""
        u, length, w = self.ends_of(y)
        uu = u[:, :, None] * u[:, None, :]
        across = np.eye(3) - uu
        slack = self.stiffness * (1 - self.length / length)
        along = np.einsum("si,si->s", w, u)
        turn = np.einsum("si,sij->sj", w, across)
        k = slack[:, None, None] * np.eye(3)
        k += (self.stiffness - slack)[:, None, None] * uu
        c = self.damping / length
        k += c[:, None, None] * (u[:, :, None] * turn[:, None, :])
        k += (c * along)[:, None, None] * across
        d = self.damping * uu
        parts = [self.ones]
        for block in (k, d):
            parts.append((block[self.block] * (self.sign / self.mass)[:, None, None]).ravel())
        data = np.bincount(self.slot, np.concatenate(parts), len(self.indices))
        m = len(self.indptr) - 1
        return sparse.csc_matrix((data, self.indices, self.indptr), (m, m))


class Clothsim:
    """Runs of the program to time T, as one frame."""

    def __init__(self, program, scene, seconds):
        self.command = [program, "run", scene, "--no-render", "--frames", "1", "--quiet",
                        "--overwrite", "--json", "-", "--set", f"time.fps={1 / seconds!r}"]

    def run(self, method, states=None):
        """Seconds of the processor, the report, and x (n,3) at the start and at the end."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = self.command + ["--integrator", method]
        command += ["--states", states] if states else []
        report = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = sum(getattr(after, key) - getattr(before, key)
                      for key in ("ru_utime", "ru_stime"))
        if not states:
            return seconds, report, None
        return seconds, report, [np.load(f"{states}/x_{k:05}.npy").reshape(-1, 3)
                                 for k in (0, 1)]


def error_of(x, reference, free):
    return np.sqrt(np.mean((x[free] - reference[free]) ** 2) * 3)


def of_scipy(sheet, start, reference, rtol, seconds, repeats):
    y0 = np.concatenate([start[sheet.free].ravel(), np.zeros(3 * len(sheet.free))])
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        result = solve_ivp(sheet.rate, (0, seconds), y0, "BDF", rtol=rtol, atol=rtol,
                           jac=sheet.jacobian, t_eval=[seconds])
        times.append(time.process_time() - begin)
    if not result.success:
        sys.exit(f"scipy_bdf.py: SciPy: {result.message}")
    x = start.copy()
    x[sheet.free] = result.y[:len(y0) // 2, -1].reshape(-1, 3)
    return times, error_of(x, reference, sheet.free), result.nfev


def of_clothsim(clothsim, method, reference, free, repeats, folder):
    runs = [clothsim.run(method, folder) for _ in range(repeats)]
    _, report, (_, x) = runs[0]
    return [run[0] for run in runs], error_of(x, reference, free), report["counts"]["forces"]


def tell(solver, rtol, result, slowest):
    times, error, forces = result
    median = float(np.median(times))
    print(f"{solver},{rtol:g},{median:.4f},{min(times):.4f},{max(times):.4f},{error:.2e},"
          f"{forces},{slowest / median:.1f}", flush=True)
    return median


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", help="the clothsim to measure")
    parser.add_argument("scene", help="the drum")
    parser.add_argument("--quick", action="store_true", help="a tenth of the time, once")
    asked = parser.parse_args()
    seconds, repeats = (0.05, 1) if asked.quick else (0.5, 3)
    resolved = subprocess.run([asked.program, "scene", asked.scene, "--resolved"], check=True,
                              capture_output=True).stdout
    clothsim = Clothsim(asked.program, asked.scene, seconds)
    with tempfile.TemporaryDirectory() as folder:
        _, _, (start, reference) = clothsim.run("cvode-adams:rtol=1e-12", folder)
        sheet = Sheet(json.loads(resolved), start)
        for rtol in (1e-4,) if asked.quick else (1e-4, 1e-6):
            of = of_scipy(sheet, start, reference, rtol, seconds, repeats)
            median = tell("SciPy BDF", rtol, of, float(np.median(of[0])))
            of = of_clothsim(clothsim, f"cvode-bdf:rtol={rtol:g}", reference, sheet.free,
                             1 if asked.quick else 7, folder)
            tell("cvode-bdf", rtol, of, median)


if __name__ == "__main__":
    main()
