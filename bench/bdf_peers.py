#!/usr/bin/python3
"""BDF of SciPy, and of CVODE used plainly, against cvode-bdf of clothsim at the same error.

Prints a CSV line a scene, solver and tolerance: scene, solver, rtol (atol is rtol/1000), seconds of
the processor (median, least, most), error in m (root of the mean square over free particles,
against a reference at 1e-12 that clothsim computed by another method), force evaluations, and how
many times faster than SciPy's and than plain CVODE's it is: the peer's time at the same error, by
interpolation between the logarithms of error and time of its own runs, and beyond the last of them
by the slope of the last two. Scenes are the drum, and sheets that hang by two corners (W8, W16: particles a side).

SciPy is served as well as it can be: one thread, forces in whole arrays, a sparse incidence
matrix to gather them, an analytic sparse Jacobian of a pattern that is laid out once, and the
pinned particles left out. CVODE is used as in its first examples (cvode_plain.c). Clothsim's seconds are those of the whole program.
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
    sys.exit(f"bdf_peers.py: {missing}: install python3-numpy and python3-scipy")

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

    def __init__(self, scene, x, free):
        body = scene["bodies"][0]
        columns, rows = body["cloth"]["grid"]
        self.ends, self.length, self.stiffness = grid_springs(body)
        self.damping = body["springs"]["damping"]
        self.axial = body["springs"]["damping_model"] == "axial"
        self.mass = body["mass"]["total"] / (columns * rows)
        self.gravity = np.array(scene["forces"]["gravity"])
        self.free = free
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

    def as_text(self, x):
        """The model for cvode_plain."""
        free = np.isin(np.arange(len(x)), self.free)
        head = [len(x), len(self.ends), self.mass, self.damping, int(self.axial), *self.gravity]
        points = [f"{p[0]!r} {p[1]!r} {p[2]!r} {f:d}" for p, f in zip(x.tolist(), free)]
        springs = [f"{a} {b} {length!r} {k!r}" for (a, b), length, k in
                   zip(self.ends.tolist(), self.length.tolist(), self.stiffness.tolist())]
        return "\n".join([" ".join(map(str, head)), *points, *springs])

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
        if self.axial:
            pull += self.damping * np.einsum("si,si->s", w, u)
        force = pull[:, None] * u
        if not self.axial:
            force += self.damping * w
        acceleration = self.gather @ force / self.mass + self.gravity
        return np.concatenate([y[len(y) // 2:], acceleration.ravel()])

    def jacobian(self, _, y):
        """Exact, the position derivative of the dampers included."""
        u, length, w = self.ends_of(y)
        uu = u[:, :, None] * u[:, None, :]
        across = np.eye(3) - uu
        slack = self.stiffness * (1 - self.length / length)
        k = slack[:, None, None] * np.eye(3)
        k += (self.stiffness - slack)[:, None, None] * uu
        d = self.damping * (uu if self.axial else np.broadcast_to(np.eye(3), uu.shape))
        if self.axial:
            along = np.einsum("si,si->s", w, u)
            turn = np.einsum("si,sij->sj", w, across)
            c = self.damping / length
            k += c[:, None, None] * (u[:, :, None] * turn[:, None, :])
            k += (c * along)[:, None, None] * across
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


def of_scipy(sheet, start, reference, rtol, seconds):
    y0 = np.concatenate([start[sheet.free].ravel(), np.zeros(3 * len(sheet.free))])
    begin = time.process_time()
    result = solve_ivp(sheet.rate, (0, seconds), y0, "BDF", rtol=rtol, atol=rtol / 1000,
                       jac=sheet.jacobian, t_eval=[seconds])
    times = [time.process_time() - begin]
    if not result.success:
        sys.exit(f"bdf_peers.py: SciPy: {result.message}")
    x = start.copy()
    x[sheet.free] = result.y[:len(y0) // 2, -1].reshape(-1, 3)
    return times, error_of(x, reference, sheet.free), result.nfev


def of_plain(program, sheet, model, start, reference, rtol, seconds):
    """CVODE with GMRES, difference quotients and forces spring by spring, in a program of its own."""
    done = subprocess.run([program, f"{rtol:g}", f"{rtol / 1000:g}", f"{seconds!r}"], input=model,
                          check=True, capture_output=True, text=True).stdout.split()
    x = np.array(done[2:], float).reshape(-1, 3)
    return [float(done[0])], error_of(x, reference, sheet.free), int(done[1])


def of_clothsim(clothsim, rtol, reference, free, repeats, folder):
    method = f"cvode-bdf:rtol={rtol:g},atol={rtol / 1000:g}"
    runs = [clothsim.run(method, folder) for _ in range(repeats)]
    _, report, (_, x) = runs[0]
    return [run[0] for run in runs], error_of(x, reference, free), report["counts"]["forces"]


def time_at(error, ladder):
    """Seconds of a peer at an error; the ladder has (error, seconds) of falling errors."""
    log_error, log_time = np.log([error for error, _ in ladder]), np.log([t for _, t in ladder])
    if error < ladder[-1][0] and len(ladder) > 1:
        slope = (log_time[-1] - log_time[-2]) / (log_error[-1] - log_error[-2])
        return np.exp(log_time[-1] + slope * (np.log(error) - log_error[-1]))
    return np.exp(np.interp(-np.log(error), -log_error, log_time))


def tell(scene, solver, rtol, result, ladders):
    times, error, forces = result
    median = float(np.median(times))
    faster = ",".join(f"{time_at(error, ladder) / median:.1f}" if ladder else "" for ladder in ladders)
    print(f"{scene},{solver},{rtol:g},{median:.4f},{min(times):.4f},{max(times):.4f},"
          f"{error:.2e},{forces},{faster}", flush=True)


def hanging(particles):
    return {"bodies": [{"cloth": {"grid": [particles, particles], "size": [1, 1]},
                        "mass": {"total": 0.2},
                        "springs": {"stretch": 1000, "shear": 300, "bend": 100,
                                    "damping": 0.002, "damping_model": "relative"},
                        "pins": ["top-left", "top-right"]}]}


def compare(asked, name, scene, ours, theirs):
    """Runs a scene with both, each with its tolerances."""
    seconds, repeats = (0.05, 1) if asked.quick else (0.5, 7)
    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/scene.json"
        with open(path, "w", encoding="utf-8") as file:
            json.dump(scene, file)
        resolved = json.loads(subprocess.run([asked.program, "scene", path, "--resolved"],
                                             check=True, capture_output=True).stdout)
        clothsim = Clothsim(asked.program, path, seconds)
        _, _, (start, reference) = clothsim.run("cvode-adams:rtol=1e-12", folder + "/states")
        grid = np.arange(len(start)).reshape(resolved["bodies"][0]["cloth"]["grid"][::-1])
        pinned = grid[0, [0, -1]]
        if "edges" in scene["bodies"][0]["pins"]:
            pinned = np.setdiff1d(grid, grid[1:-1, 1:-1])
        sheet = Sheet(resolved, start, np.setdiff1d(grid, pinned))
        scipy = [of_scipy(sheet, start, reference, rtol, seconds) for rtol in theirs]
        model = sheet.as_text(start)
        plain = [of_plain(asked.plain, sheet, model, start, reference, rtol, seconds)
                 for rtol in theirs if asked.plain]
        own = [of_clothsim(clothsim, rtol, reference, sheet.free, repeats, folder + "/states")
               for rtol in ours]
        ladders = [[(error, times[0]) for times, error, _ in peer] for peer in (scipy, plain)]
        for solver, rtols, results in (("SciPy BDF", theirs, scipy), ("CVODE plain", theirs, plain),
                                       ("cvode-bdf", ours, own)):
            for rtol, result in zip(rtols, results):
                tell(name, solver, rtol, result, ladders)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program", help="the clothsim to measure")
    parser.add_argument("drum", help="the scene of the drum")
    parser.add_argument("plain", help="cvode_plain, or nothing where CVODE is not there")
    parser.add_argument("--quick", action="store_true", help="the drum alone, a tenth of the time")
    asked = parser.parse_args()
    with open(asked.drum, encoding="utf-8") as file:
        drum = json.load(file)
    if asked.quick:
        compare(asked, "drum", drum, (1e-4,), (1e-3, 1e-4, 1e-5))
        return
    compare(asked, "W8", hanging(8), (1e-7, 1e-8), (1e-4, 1e-5, 1e-6, 1e-7, 1e-8))
    compare(asked, "W16", hanging(16), (1e-6, 1e-8), (1e-4, 1e-5, 1e-6, 1e-7))
    compare(asked, "drum", drum, (1e-6, 1e-7), (1e-4, 1e-5, 1e-6, 1e-7))


if __name__ == "__main__":
    main()
