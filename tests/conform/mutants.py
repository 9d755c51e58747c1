#!/usr/bin/python3
"""mutants.py CLOTHSIM ROOT [--all] [--write] [--list] - the card on modules with one fault each.

Each mutant is a module: faulty.c with a fault of FAULTS, or the sources of a shipped method with one
line changed by a rule of RULES. The card must find it, which is a claim that fails. Without --all 30
of them, spread over kinds and methods, meet the check alone that found them, named in mutants.tsv;
with --all every mutant meets that check and, if it passes, the whole card; the rate must reach FLOOR,
and mutants.tsv must hold what was found: run with --write to write it anew.

A mutant that no check finds is no fault if it gives the same bits as the right module in all scenes of
Alike, with the step given where the method takes one. Other survivors stand in mutants.tsv with the reason.
"""
import hashlib
import itertools
import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.argv[1:] or sys.exit("usage: mutants.py CLOTHSIM ROOT [--all] [--write] [--list]")

HERE = Path(__file__).resolve().parent
TABLE = HERE / "mutants.tsv"
FLOOR = 0.98
QUICK = 30
# of each rule in each file at most
SITES = 3
FLAGS = "-std=gnu17 -O1 -w -ffp-contract=off -fno-math-errno -fPIC -fvisibility=hidden".split()

# fault of faulty.c: its methods (M H V A), its sizes, its parts
ALL = "MHVA"
PARTS = ("STRETCH SHEAR BEND DAMPING GRAVITY DRAG WIND POTENTIAL DISSIPATIVE EXTERNAL ELASTIC "
         "ELASTIC_DAMPING").split()
FAULTS = (
    ("STAGE_TIME", "MHV", (1, 1e-3, 1e-5), ()),
    ("STALE_MASS", ALL, (0,), ()),
    ("OTHER_MASS", "MA", (0,), ()),
    ("FROM_INDEX", "MH", (128, 256, 500, 1000), ()),
    ("LAST_PARTICLE", "MV", (0,), ()),
    ("EVERY_64TH", "HA", (1e-3, 1e-6, 1e-9), ()),
    ("CLAMP_SPEED", "MV", (5, 50, 150), ()),
    ("CLAMP_BACK", "HA", (50, 100), ()),
    ("CLAMP_FORCE", "MH", (1e2, 1e4), ()),
    ("FLOAT_PLACE", "MV", (0,), ()),
    ("FLOAT_FORCE", ALL, (0,), ()),
    ("FLOAT_SPEED", "MH", (0,), ()),
    ("PART_WEAK", "M", (1e-3, 1e-5, 1e-6), PARTS),
    ("PART_LAGS", "H", (1e-3,), PARTS),
    ("HELD_STAY", "MHV", (0,), ()),
    ("FIRST_WEIGHT", "HVA", (1e-3, 1e-6), ()),
    ("SECOND_WEIGHT", ALL, (1e-3, 1e-6, 1e-9), ()),
    ("STAGE_STEP", "MH", (1e-3, 1e-5), ()),
    ("DRIFT", "MA", (1e-6,), ()),
    ("NO_RESTART", "VA", (0,), ()),
    ("NO_RESTART_SET", "VA", (0,), ()),
    ("SAVES_LESS", "VA", (0,), ()),
    ("SUM_ORDER", "H", (1e-6,), ()),
    ("Z_ONLY", "MV", (1e-6,), ()),
)
BASES = {"M": "MIDPOINT", "H": "HEUN", "V": "VERLET", "A": "ADAMS"}

# module: the file with its list of methods, and its other files
MODULES = {
    "explicit": ("explicit.c", "explicit_steps.c fixed_step.c"),
    "composition": ("composition.c", "quadrature_weights.c fixed_step.c"),
    "dop853": ("high_order_module.c", "dop853.c dopri5.c symmetric_multistep.c nystrom.c adaptive_step.c "
               "hermite.c fixed_step.c"),
    "newton": ("newton_module.c", "newton.c fixed_step.c step_halving.c one_stage_implicit.c bdf2.c tr_bdf2.c "
               "sdirk2.c ros2.c newmark.c gauss.c collocation.c esdirk.c nystrom.c adaptive_step.c hermite.c"),
    "implicit": ("implicit.c", "fixed_step.c"),
    "r-respa": ("r_respa.c", "fixed_step.c"),
    "rkc2": ("rkc2.c", "chebyshev_step.c spectral_radius.c adaptive_step.c hermite.c"),
}
# module, changed file, method; a function's name begins with the words behind it, if there are some
TARGETS = (
    ("explicit", "explicit_steps.c", "rk4", "rk4 step_rk4"),
    ("explicit", "explicit_steps.c", "velocity_verlet", "drift_row kick_row step_velocity accelerate"),
    ("explicit", "explicit_steps.c", "position_verlet", "position last_half step_position restart_position"),
    ("explicit", "explicit_steps.c", "symplectic_euler", "symplectic step_symplectic"),
    ("explicit", "explicit_steps.c", "averaged_euler", "averaged step_averaged"),
    ("dop853", "dopri5.c", "dopri5", ""),
    ("dop853", "nystrom.c", "dopri5", "add combine nystrom_combine"),
    ("dop853", "dop853.c", "dop853", ""),
    ("dop853", "symmetric_multistep.c", "symmetric_multistep", ""),
    ("newton", "bdf2.c", "bdf2", ""),
    ("newton", "tr_bdf2.c", "tr_bdf2", ""),
    ("newton", "sdirk2.c", "sdirk2", ""),
    ("newton", "ros2.c", "ros2", ""),
    ("newton", "newmark.c", "newmark", ""),
    ("newton", "esdirk.c", "esdirk", ""),
    ("r-respa", "r_respa.c", "r_respa", "take_fast step archive"),
    ("rkc2", "chebyshev_step.c", "rkc2", ""),
)
# kind, what is replaced, by what; {d} is a size of SIZES in turn
SIZES = ("1e-3", "1e-6", "1e-9")
RULES = (
    ("coefficient", r"(?<![\w.])-?\d+\.\d+(?:e-?\d+)?(?: / \d+(?:\.\d+)?)?(?![\w.])", r"(\g<0> * (1 + {d}))"),
    ("half", r"\bh / 2\b", "h / 2 * (1 + {d})"),
    ("step", r"\bh \* (?=[a-z(])", "h * (1 + {d}) * "),
    ("time", r"\bt \+ [\w.\[\]>()-]+(?: \* [\w.\[\]>()-]+)*", "t"),
    ("range", r"(?<=; )(\w) < (row->count|n3|count)\b", r"\1 + 1 < \2"),
    ("mass", r"\bw\[i\]", "w[i / 2]"),
    ("float", r"^( +\w+\[\w\] [+*]?=) (.+);$", r"\1 (float)(\2);"),
    ("clamp", r"^( +)(v\[\w\]) [+*]?= .+;$", r"\g<0> \2 = \2 > 50 ? 50 : \2;"),
    ("save", r"^ +archive->\w+\([^;]+;$", ""),
    ("copy", r"^ +memcpy\(self->[^;]+;$", ""),
)
FUNCTION = re.compile(r"^(?!static const|const|struct|enum \{)\w[\w *]*?\b(\w+)\([^;]*?\) \{$", re.M)


def code_only(text):
    """The text with comments and lines of options blanked, of the same length."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", lambda m: re.sub(r"[^\n]", " ", m.group(0)), text, flags=re.S)
    return re.sub(r"static const struct cs_option rows.*?\};", lambda m: re.sub(r"[^\n]", " ", m.group(0)),
                  text, flags=re.S)


def function_at(text, place):
    name = ""
    for m in FUNCTION.finditer(text, 0, place):
        name = m.group(1)
    return name


def faulty():
    for fault, bases, sizes, parts in FAULTS:
        for base, size, part in itertools.product(bases, sizes, parts or ("",)):
            flags = [f"-DBASE={BASES[base]}", f"-DFAULT={fault}", f"-DSIZE={float(size)}"]
            flags += [f"-DPART=CS_PART_{part}"] if part else []
            name = "-".join(filter(None, (BASES[base].lower(), fault.lower(), part.lower(), f"{size:g}")))
            yield {"name": name, "kind": fault.lower(), "flags": flags}


def mutations(root):
    """Of each rule in each file SITES sites, evenly chosen."""
    turn = itertools.cycle(SIZES)
    for module, file, method, words in TARGETS:
        source = (root / "plugins" / file).read_text()
        code = code_only(source)
        for kind, pattern, new in RULES:
            sites = [m for m in re.finditer(pattern, code, re.M)
                     if not words or function_at(code, m.start()).startswith(tuple(words.split()))]
            step = max(1, len(sites) / SITES)
            for m in [sites[int(k * step)] for k in range(min(SITES, len(sites)))]:
                changed = m.expand(new.replace("{d}", next(turn))) if new else ""
                line = source.count("\n", 0, m.start()) + 1
                text = source[:m.start()] + changed + source[m.end():]
                # of what is changed, not of the file, which may change elsewhere
                start = source.rfind("\n", 0, m.start()) + 1
                place = source[start:source.index("\n", start)]
                place += str(source.count(place, 0, start) or "")
                digest = hashlib.sha256((file + place + str(m.start() - start) + changed).encode()).hexdigest()[:6]
                yield {"name": f"{method}-{kind}-{digest}", "kind": kind, "module": module, "file": file,
                       "method": method, "text": text, "line": line,
                       "change": f"{m.group(0).strip()} -> {changed.strip() or 'left out'}"}


class Maker:
    """Builds modules in a folder; objects of unchanged files are made once."""

    def __init__(self, root, work):
        self.root, self.work = root, Path(work)
        self.cc = os.environ.get("CC", "cc").split()

    def compile(self, source, out, flags=()):
        include = [f"-I{self.root / 'include'}", f"-I{self.root / 'plugins'}"]
        return subprocess.run([*self.cc, *FLAGS, *include, *flags, "-c", source, "-o", out],
                              capture_output=True).returncode == 0

    def prepare(self):
        for module, (first, others) in MODULES.items():
            for file in others.split():
                if not (out := self.work / f"{file}.o").exists():
                    assert self.compile(self.root / "plugins" / file, out), file

    def make_right(self, mutant, name):
        """The module that the mutant was made of."""
        right = {**mutant, "flags": [f for f in mutant.get("flags", ()) if f.startswith("-DBASE")]}
        if "module" in mutant:
            right["text"] = (self.root / "plugins" / mutant["file"]).read_text()
        return self.make(right, name)

    def make(self, mutant, number):
        """The module's path, or None if it does not compile."""
        base = self.work / f"m{number}"
        source, objects = base.with_suffix(".c"), []
        if "module" not in mutant:
            source = HERE / "faulty.c"
        else:
            first, others = MODULES[mutant["module"]]
            text = (self.root / "plugins" / first).read_text() if first != mutant["file"] else mutant["text"]
            # the changed method alone
            text = re.sub(r"(\*const integrators\[\] = \{)[^}]*\}", rf"\1&{mutant['method']}}}", text)
            source.write_text(text)
            for file in others.split():
                if file == mutant["file"]:
                    changed = self.work / f"m{number}b.c"
                    changed.write_text(mutant["text"])
                    if not self.compile(changed, changed.with_suffix(".o")):
                        return None
                    objects.append(changed.with_suffix(".o"))
                else:
                    objects.append(self.work / f"{file}.o")
        if not self.compile(source, base.with_suffix(".o"), mutant.get("flags", ())):
            return None
        out = base.with_suffix(".so")
        link = subprocess.run([*self.cc, "-shared", base.with_suffix(".o"), *objects, "-o", out, "-lm"],
                              capture_output=True)
        return out if link.returncode == 0 else None


# a thin sheet that a box runs into at 10 m/s
RUN_INTO = {"bodies": [{"cloth": {"grid": [5, 5], "size": [0.4, 0.4], "start": "flat"}, "mass": {"areal_density": 0.2},
                        "springs": {"stretch": 60, "shear": 20, "bend": 0.5, "damping": 0.01}, "thickness": 0.002}],
            "colliders": [{"box": {"centre": [0.2, 0.08, 0.2], "size": [1, 0.02, 1]}, "thickness": 0.002,
                           "friction": 0.3}],
            "forces": {"gravity": [0, 0, 0]}, "contact": {"law": "force"}, "time": {"fps": 60},
            "events": [{"from": 0, "to": 0.1, "move": {"collider": 0, "path": [{"at": 0.1, "point": [0, -1, 0]}]}}]}


class Alike:
    """Tells mutants that do what the right module does, by state hashes of every frame, on from a
    checkpoint too. What they choose as step is no claim, so that it is given where dt is an option."""

    FRAMES = 2
    # a second and more each, and many particles of one law
    LEFT_OUT = ("arch", "bag", "balloon", "mass_", "stiffness_", "tent", "trampoline")

    def __init__(self, clothsim, root, maker):
        self.clothsim, self.maker, self.known = clothsim, maker, {}
        moving = maker.work / "run_into.json"
        moving.write_text(json.dumps(RUN_INTO))
        shipped = sorted((root / "scenes").glob("*.json"))
        self.scenes = [moving] + [path for path in shipped if not path.name.startswith(self.LEFT_OUT)]

    def hashes(self, module, name, scene):
        """Hashes of all frames, and of one behind the checkpoint."""
        rows = []
        with tempfile.TemporaryDirectory() as out:
            for form in (f"{name}:dt=0.004", name):
                for more in (["-n", str(self.FRAMES), "--checkpoint", str(self.FRAMES)],
                             ["-n", str(self.FRAMES + 1), "--resume", out]):
                    done = subprocess.run([self.clothsim, "run", scene, "-p", module, "-i", form, "-o", out,
                                           "--no-render", "--hash", *more], capture_output=True, text=True)
                    rows += re.findall(r"^\d+ +[0-9a-f]{32}$", done.stdout, re.M)
                if done.returncode != 2:
                    break
        return rows

    def find(self, mutant, module, number):
        """Number of scenes with the same bits if all have them, else 0."""
        name = mutant.get("method", "faulty").replace("_", "-")
        key = (mutant.get("file"), name, *[f for f in mutant.get("flags", ()) if f.startswith("-DBASE")])
        right = self.maker.make_right(mutant, f"r{number}")
        seen = 0
        for scene in self.scenes:
            if (key, scene) not in self.known:
                self.known[key, scene] = self.hashes(right, name, scene)
            same = self.known[key, scene]
            if same != self.hashes(module, name, scene):
                return 0
            seen += len(same) > 0
        return seen


def judge(clothsim, module, only):
    """The first check that fails, or ''."""
    command = [clothsim, "conform", "-q", "--fail-fast", "--isolate", "20", module] + (["--only", only] if only else [])
    done = subprocess.run(command, capture_output=True, text=True)
    failed = re.findall(r"^(?:FAIL|STALE) +(\S+)", done.stdout, re.M)
    if done.returncode not in (0, 1) and not failed:
        return "refused"
    return failed[0] if failed else ""


def read_table():
    rows = [(line + "\t\t").split("\t")[:3] for line in TABLE.read_text().splitlines()[1:]] if TABLE.exists() else []
    return {row[0]: row for row in rows}


def main():
    clothsim, root = sys.argv[1], Path(sys.argv[2]).resolve()
    whole, write = "--all" in sys.argv, "--write" in sys.argv
    table = read_table()
    mutants = list(faulty()) + list(mutations(root))
    if "--list" in sys.argv:
        for m in mutants:
            print(m["name"], m.get("file", ""), m.get("line", ""), m.get("change", ""), sep="\t")
        return 0
    if not whole:
        found = [m for m in mutants if table.get(m["name"], ["", ""])[1]]
        mutants = [found[int(k * len(found) / QUICK)] for k in range(QUICK)]
    with tempfile.TemporaryDirectory() as work, ThreadPoolExecutor(int(os.environ.get("JOBS", "2"))) as pool:
        maker = Maker(root, work)
        maker.prepare()

        alike = Alike(clothsim, root, maker)

        def run(item):
            number, mutant = item
            module = maker.make(mutant, number)
            if module is None:
                return None
            known = table.get(mutant["name"], ["", ""])[1]
            check = judge(clothsim, module, known) if known else ""
            if whole and not check:
                check = judge(clothsim, module, "")
            same = alike.find(mutant, module, number) if whole and not check else 0
            module.unlink()
            return check, same

        # told as they come, so that a run that is cut short has its results
        made, lines = [], []
        for mutant, result in zip(mutants, pool.map(run, enumerate(mutants))):
            if result is None:
                continue
            check, scenes = result
            made.append((mutant, check, scenes))
            reason = "" if check else table.get(mutant["name"], ["", "", ""])[2]
            if scenes:
                reason = f"same bits in {scenes} scenes"
            known = bool(check) or (whole and bool(reason) and (scenes > 0) == reason.startswith("same"))
            print("ok" if known or write else "not ok", "-", mutant["name"], f"({check or 'survives: ' + reason})",
                  mutant.get("file", ""), mutant.get("line", ""), mutant.get("change", ""), flush=True)
            lines.append("\t".join((mutant["name"], check, reason)))
    found = [m for m, check, _ in made if check]
    same = sum(scenes > 0 for _, _, scenes in made)
    rate = len(found) / (len(made) - same)
    print(f"# {len(found)} of {len(made) - same} mutants found, {100 * rate:.1f} %; {same} more do what the right "
          f"method does, {len(mutants) - len(made)} do not compile")
    if write:
        TABLE.write_text("\n".join(["mutant\tcheck\treason"] + lines) + "\n")
    held = rate >= FLOOR if whole else len(found) == QUICK
    print("ok" if held else "not ok", "- the rate")
    print(f"1..{len(made) + 1}")
    return 0 if held or write else 1


if __name__ == "__main__":
    sys.exit(main())
