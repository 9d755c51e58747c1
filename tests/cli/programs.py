#!/usr/bin/python3
"""Methods that other processes compute (as TAP): the clients of examples give the bits of our own
methods, every command takes them, a bad one gives one line and its exit status, and no file starts one.

usage: programs.py PROGRAM SOURCE
       programs.py PROGRAM SOURCE card      the whole card on both clients
"""
import csv
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.argv[1:] or sys.exit("usage: programs.py PROGRAM SOURCE")

program, source = (os.path.abspath(path) for path in sys.argv[1:3])
PYTHON, EXAMPLES = sys.executable, os.path.join(source, "examples")
SCENE = {"bodies": [{"cloth": {"grid": [5, 4], "size": [0.8, 0.6]}, "mass": {"total": 0.2},
                     "springs": {"stretch": 50, "shear": 20, "bend": 0.1, "damping": 0.01},
                     "pins": ["top"]}]}
HEAD = f"""import os, signal, sys, time
sys.path.insert(0, {EXAMPLES!r})
from clothsim_program import serve
"""
STEPS = {
    "midpoint": "return y + h * host.rate(t + h / 2, y + h / 2 * host.rate(t, y))",
    "dies": "os._exit(3)",
    "killed": "os.kill(os.getpid(), signal.SIGSEGV)",
    "raises": "raise ValueError('no\\x1bidea')",
    "half": "host._socket.sendall(b'abc'); os._exit(0)",
    "rubbish": "host._socket.sendall(bytes(range(200, 248))); host._receive()",
    "needs": "host.energy(t, y)",
    "hangs": "open('hung', 'w').close(); time.sleep(1000)",
}
# each service against an identity that it has to hold; raises where one does not
SERVICES = HEAD + """
import numpy as np

def near(name, found, expected, bound):
    gap = np.abs(np.subtract(found, expected)).max() / (np.abs(expected).max() or 1)
    if not gap <= bound:
        raise ValueError(f"{name}: {gap:.2e}")

def step(host, t, h, y):
    n, n3, e, draw = host.n, 3 * host.n, 1e-6, np.random.default_rng(1)
    mass, free = np.tile(host.mass, 3), np.tile(host.inv_mass > 0, 3)
    p, q = (draw.normal(size=n3) * free for _ in range(2))
    by_x = host.jvp(t, y, np.concatenate([p, 0 * p])).copy()
    by_v = host.jvp(t, y, np.concatenate([0 * p, p])).copy()
    both = np.concatenate([p, p])
    slope = (host.force(t, y + e * both).copy() - host.force(t, y - e * both)) / (2 * e)
    near("jvp", by_x + by_v, slope, 1e-5)
    kxx, dvv = (blocks.reshape(6, n)[:, -1].copy() for blocks in host.diagonal(t, y))
    # blocks and matrix leave out what short springs and turning dampers add: nothing at rest
    for c, row in enumerate(((0, 1, 2), (1, 3, 4), (2, 4, 5)) if t == 0 else ()):
        unit = np.zeros(2 * n3)
        unit[(c + 1) * n - 1] = 1
        near("kxx", kxx[list(row)], host.jvp(t, y, unit)[n - 1::n], 1e-12)
        near("dvv", dvv[list(row)], host.jvp(t, y, np.roll(unit, n3))[n - 1::n], 1e-12)
    still = np.concatenate([y[:n3], 0 * p])
    move = np.concatenate([e * p, 0 * p])
    rise = (host.energy(t, still + move) - host.energy(t, still - move)) / (2 * e)
    near("energy", rise, -p @ host.force(t, still), 1e-4)
    host.solve_setup(t, y, 1.0, -h, -h * h)
    near("product", host.matrix_product(p), mass * p - h * by_v - h * h * by_x, 1e-5 if t else 1e-12)
    near("solve", host.matrix_product(host.solve(q, 1e-13).copy()), q, 1e-11)
    one, other = host.precondition(p).copy(), host.precondition(q).copy()
    near("precondition", q @ one, p @ other, 1e-12)
    near("definite", np.sign([p @ one, q @ other]), [1, 1], 0)
    omega, delta = host.bounds(t, y)
    near("bounds", [-p @ by_x <= omega**2 * (p @ (mass * p)), -p @ by_v <= 2 * delta * (p @ (mass * p))], [1, 1], 0)
    near("nothing limits", [host.max_step_fraction(t, y[:n3], t + h, y[:n3] + h * y[n3:])], [1], 0)
    host.longest_step(t, y)
    host.note("all services hold")
    host.counts[0] += 1
    host.counts[1] += 2
    # what is remembered moves the state
    host.history[:n] += 1
    new = y + h * host.rate(t, y)
    new[n3:] += 1e-6 * free * host.history[0]
    return new

serve(step=step, name="services", order=1, needs="jvp diagonal energy solve bounds", history=1)
"""
n = failed = 0


def told(name, good, found=""):
    global n, failed
    n += 1
    failed += not good
    print(("ok" if good else "not ok"), n, "-", name)
    for line in [] if good else str(found).splitlines():
        print("#  ", line)


def call(*words, env=None):
    done = subprocess.run([program, *words], capture_output=True, text=True,
                          env={**os.environ, **(env or {})})
    return done.returncode, done.stdout, done.stderr


def run(method, *words, scene="scene.json", frames="4"):
    return call("run", scene, "-n", frames, "--no-render", "-i", method, *words)


def state(method, *words, **settings):
    """The state hash of a run, or all that it said."""
    code, out, err = run(method, *words, **settings)
    found = [line.split()[-1] for line in out.splitlines() if line.startswith("state hash")]
    return found[0] if code == 0 and found else f"{code} {out} {err}"


def refused(name, code, text, *words):
    """The call ends with that status and one line with that text."""
    found, _, err = call(*words)
    lines = [line for line in err.splitlines() if line.startswith("clothsim: ")]
    told(name, found == code and len(lines) == 1 and text in lines[0], f"{found}\n{err}")


def write_programs():
    for name, body in STEPS.items():
        with open(f"{name}.py", "w") as file:
            file.write(f"{HEAD}def step(host, t, h, y):\n    if t > 0.02 or {name != 'hangs'}:\n"
                       f"        {body}\n    return y\n"
                       f"serve(step=step, name={name!r}, order=2)\n")
    with open("scene.json", "w") as file:
        json.dump(SCENE, file)


def check_bits():
    drum, rk4 = os.path.join(source, "scenes/drum.json"), os.path.join(EXAMPLES, "rk4_program.py")
    ours = state("rk4:dt=0.0005", scene=drum, frames="6")
    theirs = state(f"program:{PYTHON} {rk4}:dt=0.0005", scene=drum, frames="6")
    told("rk4 in Python has the bits of rk4", ours == theirs, f"{ours}\n{theirs}")
    if build_rust():
        rust = state("program:./rk4_program:dt=0.0005", scene=drum, frames="6")
        told("rk4 in Rust has them too", rust == ours, f"{rust}\n{ours}")
        bare = subprocess.run("./rk4_program", capture_output=True, text=True)
        told("it says who starts it", bare.returncode == 2 and "by clothsim" in bare.stderr, bare)
    build_client()
    c, python = state("program:./midpoint:dt=1e-3"), state(f"program:{PYTHON} midpoint.py:dt=1e-3")
    told("a method in C has the bits of that in Python", c == python and len(c) == 32, f"{c}\n{python}")


def build_client():
    subprocess.run(["cc", "-std=gnu17", "-O2", "-ffp-contract=off", f"-I{source}/include",
                    f"{EXAMPLES}/midpoint_program.c", "-o", "midpoint", "-lm"], check=True)


def build_rust():
    """False where there is no compiler; ./dev test slow installs it."""
    if not shutil.which("rustc"):
        print("# no rustc: the client in Rust is left out")
        return False
    subprocess.run(["rustc", "--edition", "2021", "-O", "-D", "warnings", f"{EXAMPLES}/rk4_program.rs"], check=True)
    return True


def check_cards():
    """The whole card passes; a program that claims too high an order is found."""
    build_client()
    rust = ["./rk4_program"] if build_rust() else []
    for name in ("./midpoint", f"{PYTHON} midpoint.py", *rust):
        code, out, err = call("conform", "-q", f"program:{name}")
        told(f"the card of {name}", code == 0 and " 0 fail" in out and not err, f"{code}\n{out}{err}")
    with open("midpoint.py") as file:
        claims = file.read().replace("order=2", "order=3")
    with open("claims.py", "w") as file:
        file.write(claims)
    code, out, err = call("conform", "--only", "order", f"program:{PYTHON} claims.py")
    told("an order that it has not", code == 1 and "FAIL      order" in out, f"{code}\n{out}{err}")


def check_commands():
    midpoint = f"{PYTHON} midpoint.py"
    whole = state(f"program:{midpoint}")
    named = state("mine:dt=0.001", "--program", f"mine={midpoint}")
    told("a program by a name of ours", whole == named, f"{whole}\n{named}")
    run(f"program:{midpoint}", "-o", "parts", "--checkpoint", "2", "-q", frames="2")
    resumed = state(f"program:{midpoint}", "--resume", "parts")
    told("a run goes on", whole == resumed, f"{whole}\n{resumed}")
    call("run", "scene.json", "-n", "1", "-i", f"program:{midpoint}", "-o", "whole", "-q")
    again = call("reproduce", "whole", "--program", midpoint)
    told("a result is reproduced", again[0] == 0, again)
    same = call("bisect", "scene.json", "-n", "2", "-i", f"program:{midpoint}", "--b", "threads=2")
    told("two runs are bisected", same[0] == 0 and "2 frames" in same[1], same)
    card = call("conform", f"program:{midpoint}", "--only", "free-fall")
    told("the card", card[0] == 0 and "1 pass" in card[1], card)
    # a step of 8 times the length has 64 times the error
    code, out, err = call("compare", "scene.json", "-t", "0.1", "-o", "compared", "--runs", "1",
                          "-i", f"program:{midpoint}:dt=1e-4..8e-4")
    rows = list(csv.DictReader(open("compared/compare.csv"))) if code == 0 else []
    errors = {round(float(row["value"]), 7): float(row["error"]) for row in rows}
    ratio = errors.get(8e-4, 0) / errors.get(1e-4, 1)
    told("compare measures its order", 50 < ratio < 80, f"{ratio}\n{out}{err}")


def check_services():
    with open("services.py", "w") as file:
        file.write(SERVICES)
    code, out, err = run(f"program:{PYTHON} services.py:dt=2e-3")
    counts = re.search(r"^steps +(\d+), (\d+) rejected", out, re.M)
    newton = re.search(r"(\d+) Newton", out)
    told("every service holds its identity", code == 0 and "all services hold" in out, f"{code}\n{out}{err}")
    told("its counts are told", counts and newton and counts[1] == counts[2]
         and int(newton[1]) == 2 * int(counts[1]), out)
    whole = state(f"program:{PYTHON} services.py:dt=2e-3")
    run(f"program:{PYTHON} services.py:dt=2e-3", "-o", "part", "--checkpoint", "2", "-q", frames="2")
    resumed = state(f"program:{PYTHON} services.py:dt=2e-3", "--resume", "part")
    told("its history survives a checkpoint", whole == resumed, f"{whole}\n{resumed}")


def check_studies(method="program:./midpoint"):
    """The studies that choose steps by themselves."""
    build_client()
    advised = call("advise", "scene.json", "-t", "0.05", "-i", method)
    row = next((line.split() for line in advised[1].splitlines() if line.startswith(method)), [])
    told(f"advise takes {method}", advised[0] == 0 and len(row) == 5 and 0 < float(row[2]) < float(row[1]), advised)
    mapped = call("stability", "scene.json", "-i", method, "--columns", "2", "--rows", "2", "-t", "0.05",
                  "-o", "map", "-q", "-y")
    tables = [name for name in os.listdir("map") if name.endswith(".csv") and not name.endswith("_border.csv")]
    verdicts = [row["verdict"] for name in tables for row in csv.DictReader(open(f"map/{name}"))]
    told(f"stability takes {method}", mapped[0] == 0 and len(verdicts) == 4
         and {"bounded", "global instability"} <= set(verdicts), f"{mapped}\n{tables}\n{verdicts}")
    shutil.rmtree("map")
    same = call("bisect", "scene.json", "-n", "2", "-i", method, "--b", "threads=2")
    told(f"bisect takes {method}", same[0] == 0 and "2 frames" in same[1], same)


def check_tableau_studies():
    check_studies(f"tableau:{EXAMPLES}/tableaux/ralston3.json")


def check_ranking():
    """Beside a program all are ranked by work, whatever the times were."""
    code, out, err = call("compare", "scene.json", "-t", "0.1", "-o", "ranked", "--runs", "3", "-q", "-i",
                          f"program:{PYTHON} midpoint.py:dt=1e-4..8e-4,velocity-verlet")
    with open("ranked/compare.json") as file:
        report = json.load(file) if code == 0 else {"cells": [], "verdict": []}
    cells, ranks = report["cells"], [rank for rank in report["verdict"] if "factor" in rank]
    exact = [rank["factor"] == rank["work_factor"] == cells[rank["next"]]["work"] / cells[rank["best"]]["work"] >= 1
             and rank["best"] == rank["least_work"] for rank in ranks]
    told("a factor beside a program is that of the work", exact and all(exact), f"{ranks}\n{out}{err}")
    told("the verdict says so", "warning: ranked by work" in out and "times less work than" in out
         and "cheaper than" not in out and " ms, work" not in out, out)


def check_scipy():
    if not importlib.util.find_spec("scipy"):
        told("SciPy's methods # SKIP no SciPy", True)
        return
    ours = call("run", "scene.json", "-n", "4", "--no-render", "--states", "ours", "-i",
                "dop853:rtol=1e-10")
    # small: a dense Jacobian has 6n columns
    for method in ("DOP853", "RK45", "Radau"):
        command = f"program:{PYTHON} {EXAMPLES}/scipy_methods.py {method}:rtol=1e-8"
        done = run(command, "--states", method)
        import numpy as np
        gap = 1.0
        if not done[0] and not ours[0]:
            gap = np.abs(np.load(f"{method}/x_00004.npy") - np.load("ours/x_00004.npy")).max()
        told(f"{method} of SciPy finds the motion", gap < 1e-6, f"{gap}\n{done}")


def check_faults():
    for name, text in (("dies", "its program ended with code 3"),
                       ("killed", "its program was ended by signal 11"),
                       ("raises", "ValueError: no idea"),
                       ("half", "its program ended with code 0"),
                       ("rubbish", "its program sent 0xcfcecdcccbcac9c8, expected one of the letters"),
                       ("needs", "its program asked for 'E', which is not among its needs")):
        refused(name, 5, f'integrator "{name}" failed at t = 0 s: {text}', "run", "scene.json", "-n",
                "1", "--no-render", "-q", "-i", f"program:{PYTHON} {name}.py")
    limit = 0.5
    while not os.path.exists("hung"):  # a machine at work may need longer to start Python than it may be silent
        limit *= 2
        found = run(f"program:{PYTHON} hangs.py", "-q", "--isolate", str(limit))
    lines = [line for line in found[2].splitlines() if line.startswith("clothsim: ")]
    told("one that hangs", found[0] == 5 and len(lines) == 1 and
         f'integrator "hangs" hung in advance: it was ended after {limit:g} s' in lines[0], found)
    refused("one that is no client", 5, "ended with code 0 before it described itself", "run",
            "scene.json", "-i", "program:true")
    with open("wait.sh", "w") as file:
        file.write("until grep -q silent err; do sleep 0.1; done")
    with open("err", "w") as err:
        code = subprocess.run([program, "run", "scene.json", "-i", "program:sh wait.sh"], stderr=err).returncode
    said = open("err").read()
    told("a silent one is told", code == 5 and said.startswith(
        'clothsim: "program:sh wait.sh" is silent: it has a minute to describe itself\n'), said)
    refused("one that is not there", 5, "cannot be started: No such file or directory", "run",
            "scene.json", "-i", "program:./missing with words")
    wrong = "import os; os.write(3, bytes([86]) + bytes(7) + bytes([9]) + bytes(39)); os.read(3, 1)"
    with open("wrong.py", "w") as file:
        file.write(wrong)
    refused("another version", 5, "sent 0x56, 9, expected 'V', 1", "run", "scene.json",
            "-i", f"program:{PYTHON} wrong.py")
    refused("an option it has not", 2, 'dtt: no such option; did you mean "dt"?', "run", "scene.json",
            "-i", f"program:{PYTHON} midpoint.py:dtt=1")
    refused("too many words", 2, "more than 64 words", "run", "scene.json", "-i",
            f"program:{PYTHON} midpoint.py" + 63 * " a")
    refused("no command", 2, "expected program:COMMAND", "run", "scene.json", "-i", "program:")
    alone = subprocess.run([PYTHON, "midpoint.py"], capture_output=True, text=True)
    told("a program that nobody asked", alone.returncode == 1 and "Traceback" not in alone.stderr,
         alone.stderr)


def left_of(script):
    """Processes of a script in this folder."""
    found = subprocess.run(["pgrep", "-f", f"{PYTHON} {script}"], capture_output=True, text=True, cwd="/").stdout
    return [pid for pid in found.split() if os.path.realpath(f"/proc/{pid}/cwd") == os.getcwd()]


def check_signal():
    """A run that is asked to end while its program hangs leaves neither."""
    os.remove("hung")
    child = subprocess.Popen([program, "run", "scene.json", "-n", "4", "--no-render", "--hash", "-q",
                              "-i", f"program:{PYTHON} hangs.py"], stdout=subprocess.DEVNULL,
                             stderr=subprocess.PIPE, text=True)
    while child.poll() is None and not os.path.exists("hung"):
        time.sleep(0.02)
    child.terminate()
    err = child.communicate()[1]
    told("SIGTERM while it hangs", child.returncode == 143, f"{child.returncode}\n{err}")
    until = time.monotonic() + 600  # it sleeps for longer, and may take a moment to die
    while (left := left_of("hangs.py")) and time.monotonic() < until:
        time.sleep(0.05)
    told("nothing of it is left", not left, left)


def check_door():
    """No scene, override or result starts a program."""
    touch = "program:touch started"
    with open("bad.json", "w") as file:
        json.dump({**SCENE, "integrator": touch}, file)
    refused("a scene names a program", 3, "a program with --program", "run", "bad.json")
    refused("an override does", 3, "a program with --program", "run", "scene.json", "-s",
            f"integrator={touch}")
    run("rk4:dt=1e-3", "-o", "result", "--checkpoint", "1", "-q", frames="2")
    path = "result/run.checkpoint"
    bytes_of = open(path, "rb").read()
    with open(path, "wb") as file:
        file.write(bytes_of.replace(b"rk4:dt=1e-3", touch.encode()[:11]))
    call("run", "--resume", "result")
    call("run", "scene.json", "-n", "1", "-i", f"program:{PYTHON} midpoint.py", "-o", "seen", "-q")
    refused("a result does", 2, "--program", "reproduce", "seen")
    told("nothing was started", not os.path.exists("started"))


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    write_programs()
    for check in ([check_cards, check_studies, check_tableau_studies] if "card" in sys.argv[3:] else
                  [check_bits, check_commands, check_services, check_ranking, check_scipy, check_faults, check_signal, check_door]):
        check()
    os.chdir("/")
print(f"1..{n}")
sys.exit(failed > 0)
