#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""validate.py CLOTHSIM [ROW ...] - benchmarks of others, each with a closed form.

Each row runs a scene on two meshes or three, and prints closed form, what was found, the error on
the last mesh and the order between the last two, where they differ enough to tell, as a Markdown
table. Exit 1 if an error lies above the bar of its row. What is static is let come to rest; a
critical load is extrapolated from below it."""
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.integrate import quad, solve_bvp
from scipy.special import jn_zeros

G = 9.81


class Runner:
    """Runs scenes by one program in a folder of its own."""

    def __init__(self, program, folder):
        self.program, self.folder = program, Path(folder)

    def __call__(self, scene, seconds, method=None, fps=60):
        """Returns times (n), positions (n, particles, 3) and velocities of a run, start included."""
        path = self.folder / "scene.json"
        path.write_text(json.dumps(scene | {"time": {"fps": fps}}))
        out = self.folder / "out"
        command = [self.program, "run", path, "-t", repr(seconds), "--no-render", "-q", "-y",
                   "--export", "npz", "-o", out] + (["-i", method] if method else [])
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(done.stderr.strip())
        with np.load(out / "run.npz") as found:
            return found["times"], found["positions"], found["velocities"]


def frequency(times, x, guess):
    """Returns the frequency, in 1/s, of the sinusoid that fits x best, near the guess."""
    x = x - x.mean()

    def misfit(f):
        waves = np.stack([np.cos(2 * np.pi * f * times), np.sin(2 * np.pi * f * times),
                          np.ones_like(times)], axis=1)
        return np.linalg.lstsq(waves, x, rcond=None)[1].sum()

    grid = np.linspace(0.3 * guess, 1.7 * guess, 561)
    best = min(range(len(grid)), key=lambda k: misfit(grid[k]))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    for _ in range(40):
        a, b = low + 0.382 * (high - low), low + 0.618 * (high - low)
        low, high = (low, b) if misfit(a) < misfit(b) else (a, high)
    return 0.5 * (low + high)


def on_slope(angle, friction, cells):
    """A sheet that lies on a plane, with gravity turned by an angle instead of the plane."""
    return {"bodies": [{"cloth": {"grid": [cells + 1] * 2, "size": 0.5, "start": "flat",
                                  "place": {"translate": [0, 0.01, 0]}},
                        "mass": {"areal_density": 0.3}}],
            "colliders": [{"floor": {}, "friction": friction, "thickness": 0.01}],
            "contact": {"law": "force", "damping": 0.002},
            "forces": {"gravity": [G * math.sin(angle), -G * math.cos(angle), 0]}}


def mean_acceleration(times, v, start):
    """Returns the mean acceleration along x of all particles from start on, in m/s2."""
    speed = v[:, :, 0].mean(axis=1)
    first = np.searchsorted(times, start)
    return (speed[-1] - speed[first]) / (times[-1] - times[first])


def slope_slides(run, cells):
    """Coulomb: a = g (sin a - mu cos a), 30 degrees, mu = 0.3."""
    times, _, v = run(on_slope(math.radians(30), 0.3, cells), 1, "tr-bdf2")
    return mean_acceleration(times, v, 0.5)


def slope_creeps(run, cells, law="smooth"):
    """At tan(angle) = 0.98 mu the smooth law creeps with 0.98 = s / sqrt(1 + s^2), s in units of its
    friction speed of 1 mm/s; in m within a second."""
    scene = on_slope(math.atan(0.98 * 0.5), 0.5, cells)
    scene["contact"]["friction_law"] = law
    times, x, _ = run(scene, 3, "tr-bdf2")
    return (x[-1] - x[np.searchsorted(times, 2)])[:, 0].mean()


def slope_sticks(run, cells):
    """Coulomb: at tan(angle) = 0.98 mu the sheet stays."""
    return slope_creeps(run, cells, "stick")


def slope_starts(run, cells):
    """Coulomb: at tan(angle) = 1.02 mu it slides with g cos(angle) 0.02 mu."""
    times, _, v = run(on_slope(math.atan(1.02 * 0.5), 0.5, cells), 2, "tr-bdf2")
    return mean_acceleration(times, v, 0.5)


def belt(run, cells):
    """A belt of 2 m/s under a sheet at rest accelerates it by mu g."""
    scene = on_slope(0, 0.2, cells)
    scene["colliders"] = [{"box": {"centre": [0, -0.1, 0], "size": [20, 0.2, 2], "radius": 0.01},
                           "friction": 0.2, "thickness": 0.01}]
    scene["events"] = [{"from": 0, "to": 2, "move": {"collider": 0,
                                                   "path": [{"at": 2, "point": [4, 0, 0]}]}}]
    times, _, v = run(scene, 0.8, "tr-bdf2")
    return mean_acceleration(times, v, 0.3)


def restitution(run, cells):
    """Newton: what is thrown at a floor with 2 m/s leaves it with 0.6 of that."""
    scene = on_slope(0, 0.2, cells)
    scene["bodies"][0]["cloth"] |= {"velocity": [0, -2, 0], "place": {"translate": [0, 0.1, 0]}}
    scene["contact"] = {"law": "force", "restitution": 0.6}
    scene["forces"]["gravity"] = [0, 0, 0]
    _, _, v = run(scene, 0.2, "tr-bdf2")
    return v[-1, :, 1].mean() / 2


def cantilever(cells, length, width, law, density, gravity, events=()):
    """A strip along x whose first two columns are held: clamped midway between them, so that its
    free length is length."""
    cell = length / (cells - 0.5)
    return {"bodies": [{"cloth": {"grid": [cells + 1, 3], "size": [cells * cell, width],
                                  "start": "flat"},
                        "mass": {"areal_density": density}, "elastic": law,
                        "pins": [{"box": {"min": [-9, -9, -9],
                                          "max": [-cells * cell / 2 + 1.2 * cell, 9, 9]}}]}],
            "forces": {"gravity": [0, -gravity, 0], "drag": 4 * density, "drag_unit": "Pa s/m"},
            "events": list(events)}


def tip_of_elastica(weight, load):
    """Returns how far the tip of a clamped elastica of length 1 and rigidity 1 falls under a weight
    per length and a load at its end (Love 1927, art. 262)."""
    def bend(s, y):
        return np.stack([y[1], -(load + weight * (1 - s)) * np.cos(y[0])])

    def ends(a, b):
        return np.array([a[0], b[1]])

    s = np.linspace(0, 1, 201)
    for part in np.linspace(0.1, 1, 10):
        whole = (weight, load)
        weight, load = part * whole[0], part * whole[1]
        guess = np.zeros((2, s.size)) if part < 0.11 else found.sol(s)
        found = solve_bvp(bend, ends, s, guess, tol=1e-10, max_nodes=10**5)
        weight, load = whole
    fine = np.linspace(0, 1, 20001)
    angle = found.sol(fine)[0]
    return np.trapz(np.sin(angle), fine)


def rest(run, scene, seconds):
    """Lets a scene come to rest by a method that damps; returns positions at the start and the end."""
    _, x, v = run(scene, seconds, "implicit-linearised:dt=frame")
    if np.abs(v[-1]).max() > 1e-4:
        raise RuntimeError(f"still moves at {np.abs(v[-1]).max():.2g} m/s")
    return x[0], x[-1]


def still(scene, run, seconds):
    """Lets a scene come to rest, and returns the shift of the last column."""
    start, end = rest(run, scene, seconds)
    columns = scene["bodies"][0]["cloth"]["grid"][0]
    return (end - start)[columns - 1::columns].mean(axis=0)


def heavy_elastica(run, cells):
    """A strip with rho g L^3/D = 8, the length twice the bending length of ASTM D1388."""
    length, density, rigidity = 0.04, 0.15, 1e-5
    law = {"membrane": {"young": 2000}, "bending": {"stiffness": rigidity, "poisson": 0}}
    gravity = 8 * rigidity / (density * length**3)
    return -still(cantilever(cells, length, 0.01, law, density, gravity), run, 4)[1] / length


def end_shear(run, cells):
    """P L^2/(E I) = 4, the greatest load of Sze 2004, 3.1: W = 6.698 of L = 10."""
    length, width, rigidity = 0.1, 0.01, 1e-5
    law = {"membrane": {"young": 2000}, "bending": {"stiffness": rigidity, "poisson": 0}}
    force = 4 * rigidity * width / length**2
    events = [{"from": 0, "to": 90, "impact": {"body": 0, "particles": ["right"],
                                               "direction": [0, -1, 0], "impulse": 90 * force}}]
    scene = cantilever(cells, length, width, law, 0.15, 0, events)
    return -still(scene, run, 8)[1] / length


def end_moment(run, cells):
    """M L / D = pi, half of the greatest moment of Sze 2004, 3.2, rolls a strip up to half a circle,
    2 / pi of the length high. M is a couple on the last two columns, whose forces turn with the end
    as it grows. The strip reaches from the middle of the held columns to that of the loaded ones."""
    length, width, rigidity, parts = 0.1, 0.01, 1e-4, 40
    law = {"membrane": {"young": 2000}, "bending": {"stiffness": rigidity, "poisson": 0}}
    cell, columns, events = length / (cells - 1), cells + 1, []
    for k in range(parts):
        begin, end = 4 * k / parts, 4 * (k + 1) / parts if k + 1 < parts else 90
        angle = math.pi * (k + 1) / parts
        force = angle * rigidity * width / length / cell
        for column, sign in ((cells, 1), (cells - 1, -1)):
            events.append({"from": begin, "to": end, "impact": {
                "body": 0, "particles": [column + columns * row for row in range(3)],
                "direction": [-sign * math.sin(angle), sign * math.cos(angle), 0],
                "impulse": force * (end - begin)}})
    _, x = rest(run, cantilever(cells, (cells - 0.5) * cell, width, law, 0.15, 0, events), 8)
    tip, root = ((x[k::columns] + x[k + 1::columns]).mean(axis=0) / 2 for k in (cells - 1, 0))
    return (tip - root)[1] / length


def balloon(run, detail):
    """Laplace: the tension T of a sphere holds p = 2 T / r. A stretch s, the same along each line,
    makes T = E / (1 - nu) (s^2 - 1) / 2 of Green's strain. Returns the stretch under the pressure of
    s = 1.2, by the distances of the vertices from their middle."""
    radius, young, poisson, stretch = 0.5, 40.0, 0.4, 1.2
    tension = young / (1 - poisson) * (stretch**2 - 1) / 2
    scene = {"bodies": [{"mesh": {"shape": "sphere", "detail": detail},
                         "mass": {"areal_density": 0.12},
                         "pressure": 2 * tension / (radius * stretch),
                         "elastic": {"membrane": {"young": young, "poisson": poisson}}}],
             "forces": {"gravity": [0, 0, 0], "drag": 3, "drag_unit": "Pa s/m"}}
    start, end = (np.linalg.norm(x - x.mean(axis=0), axis=1).mean() for x in rest(run, scene, 4))
    return end / start


def ringing(scene, run, seconds, particle, axis, guess, method="dop853:rtol=1e-7"):
    """Returns the frequency of a particle's motion along an axis over some periods."""
    times, x, _ = run(scene, seconds, method, fps=max(60, math.ceil(40 * guess)))
    return frequency(times, x[:, particle, axis], guess)


def beam_aside(weight, held):
    """Returns how far a small load at the tip bends a cantilever of length and rigidities 1 aside
    under its weight, with no twist up to `held`: phi'' + M^2 phi = M (1 - x), M = q (1 - x)^2 / 2
    (Timoshenko, Gere 1961, 6.3)."""
    def twist(x, y):
        moment = weight * (1 - x) ** 2 / 2
        return np.stack([y[1], moment * (1 - x) - moment**2 * y[0]])

    def ends(a, b):
        return np.array([a[0], b[1]])

    x = np.linspace(held, 1, 401)
    phi = solve_bvp(twist, ends, x, np.zeros((2, x.size)), tol=1e-9, max_nodes=10**5).sol
    return 1 / 3 - quad(lambda s: weight * (1 - s) ** 3 / 2 * phi(s)[0], held, 1)[0]


def southwell(loads, bent):
    """Returns the critical load: the reciprocal of what a small load aside bends falls with the
    square of the weight, whose sign changes nothing (Southwell 1932)."""
    low, high = (load**2 for load in loads)
    return math.sqrt(low + (high - low) / (1 - bent[0] / bent[1]))


def lateral_buckling(run, cells):
    """A narrow cantilever on edge under its own weight tilts aside at q L^3 / sqrt(E I G J) = 12.85
    for a beam of which nothing but the bending is held; here from 8 and 11. The second held column
    holds the twist half a cell further, and the warp of the end as if b / sqrt(24) were held too
    (a strip of which points (x, y) move by y phi(x) has D ((b^3 / 12) phi''^2 + 2 b phi'^2) / 2)."""
    length, width, density, rigidity = 0.1, 0.005, 0.15, 1e-5
    law = {"membrane": {"young": 12000 * rigidity / width**2, "poisson": 0},
           "bending": {"stiffness": rigidity, "poisson": 0}}
    aside = 90 * 0.006 * rigidity * width / length**2
    events = [{"from": 0, "to": 90, "impact": {"body": 0, "particles": ["right"],
                                               "direction": [0, 0, 1], "impulse": aside}}]
    loads, bent = (8.0, 11.0), []
    for load in loads:
        gravity = load * math.sqrt(2) * rigidity / (density * length**3)
        scene = cantilever(cells, length, width, law, density, gravity, events)
        scene["bodies"][0]["cloth"]["start"] = "hanging"
        bent.append(still(scene, run, 15)[2])
    held = 0.5 / (cells - 0.5) + width / length / math.sqrt(24)
    return southwell(loads, bent) / southwell(loads, [beam_aside(q, held) for q in loads])


def euler_buckling(run, cells):
    """A strip between hinges buckles at N L^2 / D = pi^2; the square of its lowest frequency falls
    linearly with the force."""
    length, width, density, rigidity = 0.2, 0.02, 0.1, 1e-4
    young = 2000.0
    law = {"membrane": {"young": young, "poisson": 0},
           "bending": {"stiffness": rigidity, "poisson": 0}}
    free = math.pi / (2 * length**2) * math.sqrt(rigidity / density)
    squares, loads = [], []
    for load in (0.0, 0.6):
        strain = load * math.pi**2 * rigidity / length**2 / young
        scene = {"bodies": [{"cloth": {"grid": [cells + 1, 3], "start": "flat",
                                       "size": [length / (1 - strain), width],
                                       "stretch": [1 - strain, 1], "bump": 1e-5},
                             "mass": {"areal_density": density}, "elastic": law,
                             "pins": ["left", "right"]}],
                 "forces": {"gravity": [0, 0, 0]}}
        middle = cells + 1 + cells // 2
        found = ringing(scene, run, 8 / free, middle, 1, free * math.sqrt(1 - load))
        squares.append(found**2)
        loads.append(young * strain * length**2 / rigidity)
    slope = (squares[1] - squares[0]) / (loads[1] - loads[0])
    return loads[0] - squares[0] / slope


def chain(run, cells):
    """The lowest frequency of a hanging chain is j01/2 sqrt(g/L) / 2 pi (Bernoulli, 1732)."""
    scene = {"bodies": [{"cloth": {"grid": [2, cells + 1], "size": [0.5 / cells, 1],
                                   "velocity": [0, 0, 0.01]},
                         "mass": {"areal_density": 1}, "pins": ["top"],
                         "springs": {"stretch": 1e5, "shear": 0, "bend": 0}}]}
    guess = jn_zeros(0, 1)[0] / 2 * math.sqrt(G) / (2 * math.pi)
    return ringing(scene, run, 20, 2 * cells, 2, guess) / guess


def drum(run, cells):
    """A square drumhead under an even tension N rings at sqrt(N / (2 rho)) / L."""
    length, young, density, strain = 0.5, 100.0, 0.2, 0.1
    scene = {"bodies": [{"cloth": {"grid": [cells + 1] * 2, "size": length / (1 + strain),
                                   "stretch": 1 + strain, "start": "flat", "bump": 1e-4},
                         "mass": {"areal_density": density * (1 + strain) ** 2},
                         "elastic": {"membrane": {"young": young, "poisson": 0}},
                         "pins": ["edges"]}],
             "forces": {"gravity": [0, 0, 0]}}
    middle = (cells + 1) * (cells // 2) + cells // 2
    guess = math.sqrt(young * (strain + strain**2 / 2) / (2 * density)) / length
    return ringing(scene, run, 10 / guess, middle, 1, guess) / guess


def belt_brake(run, cells):
    """Euler, Eytelwein: over a turning drum the tensions of a belt differ by exp(mu phi); here
    half a turn and mu = 0.3. The tension is that of Green's strain at the held end."""
    radius, width, young, load, leg = 0.105, 0.02, 2000.0, 1.0, 0.1
    turn = np.linspace(math.pi, 0, cells + 1)
    path = ([(-radius, leg * (k / 3 - 1)) for k in range(3)]
            + [(radius * math.cos(a), radius * math.sin(a)) for a in turn]
            + [(radius, -leg * k / 3) for k in range(1, 4)])
    lines = [f"v {x!r} {y!r} {z!r}" for x, y in path for z in (-width / 2, width / 2)]
    lines += [f"f {2 * k + 1} {2 * k + 2} {2 * k + 4} {2 * k + 3}" for k in range(len(path) - 1)]
    (run.folder / "belt.obj").write_text("\n".join(lines) + "\n")
    last = 2 * len(path)
    scene = {"bodies": [{"mesh": {"file": "belt.obj"}, "mass": {"areal_density": 0.3},
                         "elastic": {"membrane": {"young": young, "poisson": 0}},
                         "pins": [0, 1]}],
             "colliders": [{"capsule": {"from": [0, 0, -1], "to": [0, 0, 1], "radius": 0.1},
                            "friction": 0.3, "thickness": 0.006}],
             "contact": {"law": "force", "damping": 0.001},
             "events": [{"from": 0, "to": 9, "move": {"collider": 0, "spin": [0, 0, -2]}},
                        {"from": 0, "to": 9,
                         "impact": {"body": 0, "particles": [last - 2, last - 1],
                                    "direction": [0, -1, 0], "impulse": 9 * load}}],
             "forces": {"gravity": [0, 0, 0], "drag": 3, "drag_unit": "Pa s/m"}}
    _, x, _ = run(scene, 3, "implicit-linearised:dt=frame")
    stretch = np.linalg.norm(x[-1, 2] - x[-1, 0]) / np.linalg.norm(x[0, 2] - x[0, 0])
    return young * width * stretch * (stretch**2 - 1) / 2 / load


ROWS = {
    # closed form, its unit, the scene, the bar of the error on the last mesh, cells
    "incline, sliding": (G * (0.5 - 0.3 * math.sqrt(0.75)), "m/s2", slope_slides, 0.005, (6, 12)),
    "incline, 2 % above mu": (0.01 * G / math.hypot(1, 0.51), "m/s2", slope_starts, 0.01, (6, 12)),
    "incline, 2 % below mu, smooth": (0.00098 / math.sqrt(1 - 0.98**2), "m", slope_creeps, 1e-4,
                                      (6, 12)),
    "incline, 2 % below mu, stick": (0, "m", slope_sticks, 1e-5, (6, 12)),
    "belt": (0.2 * G, "m/s2", belt, 0.01, (6, 12)),
    "belt brake": (math.exp(0.3 * math.pi), "T", belt_brake, 0.02, (12, 24)),
    "restitution": (0.6, "v", restitution, 0.01, (6, 12)),
    "hanging chain": (1, "f", chain, 0.001, (10, 20)),
    "drumhead": (1, "f", drum, 0.002, (8, 16, 32)),
    "Euler buckling": (math.pi**2, "D/L2", euler_buckling, 0.005, (8, 16)),
    "lateral buckling": (1, "of a beam", lateral_buckling, 0.025, (16, 32)),
    "heavy elastica": (tip_of_elastica(8, 0), "L", heavy_elastica, 0.001, (8, 16, 32)),
    "end shear": (tip_of_elastica(0, 4), "L", end_shear, 0.001, (8, 16, 32)),
    "end moment": (2 / math.pi, "L", end_moment, 0.005, (8, 16, 32)),
    "balloon": (1.2, "R", balloon, 0.001, (4, 8, 16)),
}


def main():
    if len(sys.argv) < 2 or not Path(sys.argv[1]).is_file():
        sys.exit("usage: validate.py CLOTHSIM [ROW ...]")
    names = sys.argv[2:] or list(ROWS)
    unknown = [name for name in names if name not in ROWS]
    if unknown:
        sys.exit(f'validate.py: no row "{unknown[0]}"; there are: {"; ".join(ROWS)}')
    failed = []
    print("| row | closed form | cells | found | error on the last mesh | order |\n|" + " --- |" * 6)
    with tempfile.TemporaryDirectory() as folder:
        run = Runner(sys.argv[1], folder)
        for name in names:
            truth, unit, measure, bar, cells = ROWS[name]
            found = [measure(run, n) for n in cells]
            errors = [abs(f - truth) / (abs(truth) or 1) for f in found]
            order = ""
            if errors[-1] > 1e-5 and errors[-2] > 1.2 * errors[-1]:
                order = f"{math.log(errors[-2] / errors[-1]) / math.log(cells[-1] / cells[-2]):.1f}"
            print(f"| {name} | {truth:.5g} {unit} | {', '.join(map(str, cells))} |"
                  f" {', '.join(f'{f:.5g}' for f in found)} | {errors[-1]:.2g} | {order} |",
                  flush=True)
            if not errors[-1] <= bar:
                failed.append(f"validate.py: {name}: error {errors[-1]:.2g}, expected at most {bar:g}")
    sys.exit("\n".join(failed) or 0)


if __name__ == "__main__":
    main()
