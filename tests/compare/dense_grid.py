#!/usr/bin/python3
"""Factors of `clothsim compare` against those of a grid ten times denser.

    dense_grid.py CLOTHSIM [--scene N] [--repeats R]

On seven small scenes, three with contact, a comparison of nine methods says at each power of ten
which is the cheapest, and its factor over the next one, by time and by work. The two methods are
then run at ten times as many steps or tolerances around those that were found, and the factor is
taken where log(cost) over log(error) meets the power of ten. With --repeats a comparison is made R
times, and intervals of the same pair that do not overlap are contradictions. Prints a line a
factor; exits with 1 if fewer than 95 of 100 hold by work, which depends on no machine, or if
comparisons contradict each other.
"""
import argparse, csv, json, math, os, subprocess, sys, tempfile

METHODS = ("velocity-verlet,position-verlet,rk4,dopri5,ark-erk,ark-erk:order=8,cvode-adams,"
           "implicit-midpoint,ros2")
SHEET = {"mass": {"total": 0.3}, "springs": {"stretch": 80, "shear": 30, "bend": 8, "damping": 0.05}}


def scene(grid, colliders=None, springs=None, **more):
    body = dict(SHEET, cloth=dict({"grid": grid}, **more.pop("cloth", {})))
    body["springs"] = dict(body["springs"], **(springs or {}))
    if "pins" in more:
        body["pins"] = more.pop("pins")
    result = dict({"bodies": [body], "time": {"fps": 30}}, **more)
    if colliders:
        result.update(colliders=colliders, contact={"law": "force", "friction_speed": 0.1})
    return result


FLAT = {"start": "flat", "place": {"translate": [0, 0.05, 0]}}
SCENES = {
    "hung": scene([8, 8], pins=["top-left", "top-right"], cloth={"velocity": [0, 0, 0.5]}),
    "stiff": scene([12, 4], pins=["top"], springs={"stretch": 800, "shear": 300},
                   cloth={"velocity": [0.3, 0, 0.3]}),
    "undamped": scene([9, 9], pins=["top"], springs={"damping": 0}, cloth={"velocity": [0, 0, 0.2]}),
    "damped": scene([10, 6], pins=["top-left", "top-right"], springs={"damping": 0.8},
                    cloth={"velocity": [0, 0, 1]}),
    "on_floor": scene([6, 6], [{"floor": {"height": 0}, "thickness": 0.08, "friction": 0.3}], cloth=FLAT),
    "on_sphere": scene([7, 7], [{"sphere": {"centre": [0, -0.4, 0], "radius": 0.4},
                                 "thickness": 0.08, "friction": 0.2}], cloth=FLAT),
    "on_box": scene([7, 5], [{"box": {"centre": [0, -0.3, 0], "size": [0.5, 0.6, 0.5]},
                              "thickness": 0.08, "friction": 0.2}], cloth=FLAT),
}


def compare(program, path, methods, folder, cache, runs):
    command = [program, "compare", path, "-i", methods, "-t", "0.2", "-o", folder, "--cache", cache,
               "--runs", str(runs), "--budget", "0.3", "-q", "-y"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{path}: {done.stderr}")
    with open(f"{folder}/compare.json") as file:
        return json.load(file)


def dense_values(cell, fps):
    """Ten times as many values as a sweep has, an octave or a decade of tolerance about the cell,
    and all numbers of steps next to it: near the stability limit errors fall from one to the next."""
    if cell["control"] == "rtol":
        return [min(cell["value"] * 10 ** (0.05 * k), 0.1) for k in range(-10, 15)]
    steps = 1 / (fps * cell["value"])
    near = {max(1, round(steps) + k) for k in range(-3, 3)}
    return [1 / fps / n for n in sorted(near | {max(1, round(steps * 2 ** (0.1 * k))) for k in range(-12, 8)})]


def cost_at(rows, bound, column):
    """At the first row, by falling step, with an error of at most the bound; None without any."""
    misses = None
    for row in rows:
        error = float(row["error"] or "nan")
        if not error <= bound:
            misses = row if error > bound else None
            continue
        cost = float(row[column])
        if misses is None:
            return cost
        part = math.log(bound / error) / math.log(float(misses["error"]) / error)
        return cost * (float(misses[column]) / cost) ** part
    return None


def lies_in(interval, value):
    """True if the interval, whose open ends are None, has the value."""
    low, high = interval
    return (low is None or low <= value) and (high is None or value <= high)


def judge(program, name, folder):
    path, cache = f"{folder}/{name}.json", f"{folder}/{name}-cache"
    with open(path, "w") as file:
        json.dump(SCENES[name], file)
    os.makedirs(cache, exist_ok=True)
    found = compare(program, path, METHODS, f"{folder}/{name}", cache, 15)
    cells, lists = found["cells"], []
    ranks = [rank for rank in found["verdict"] if rank.get("factor")]
    for rank in ranks:
        for cell in (cells[rank["best"]], cells[rank["next"]]):
            fixed = cell["method"] + ":" + (cell["fixed"] + "," if cell["fixed"] else "")
            lists += [f"{fixed}{cell['control']}={value:.12g}" for value in dense_values(cell, found["fps"])]
    if not lists:
        return 0, 0, 0
    compare(program, path, ",".join(dict.fromkeys(lists)), f"{folder}/{name}-dense", cache, 1)
    series = {}
    with open(f"{folder}/{name}-dense/compare.csv") as file:
        for row in csv.DictReader(file):
            series.setdefault(row["series"], []).append(row)
    for rows in series.values():
        rows.sort(key=lambda row: -float(row["value"]))
    n = by_work = by_time = 0
    for rank in ranks:
        pair = [cells[rank["best"]], cells[rank["next"]]]
        true = {}
        for column in ("work", "cpu"):
            costs = [cost_at(series[cell["series"]], rank["error"], column) for cell in pair]
            true[column] = costs[1] / costs[0] if None not in costs else math.nan
        if math.isnan(true["work"]):
            continue
        low, high = rank["work_interval"]
        works = low - 0.01 <= true["work"] <= high + 0.01
        times = rank["interval"] and lies_in(rank["interval"], true["cpu"])
        n, by_work, by_time = n + 1, by_work + works, by_time + bool(times)
        print(f"{name} {rank['error']:.0e} {pair[0]['series']} over {pair[1]['series']}: work "
              f"{rank['work_factor']:.3f} ({low:.3f} to {high:.3f}), dense {true['work']:.3f}"
              f"{'' if works else ' MISSED'}; time {rank['factor']:.3f}, dense {true['cpu']:.3f}"
              f"{'' if times else ' missed'}", flush=True)
    return n, by_work, by_time


def repeat(program, name, folder, times):
    """Contradictions among repeated comparisons: intervals of one pair that do not overlap."""
    path, cache = f"{folder}/{name}.json", f"{folder}/{name}-cache"
    intervals, contradictions = {}, 0
    for k in range(times):
        found = compare(program, path, METHODS, f"{folder}/{name}-{k}", cache, 15)
        for rank in found["verdict"]:
            if rank.get("factor") and rank["interval"] and None not in rank["interval"]:
                names = [found["cells"][rank[key]]["series"] for key in ("best", "next")]
                low, high = rank["interval"]
                if names != sorted(names):
                    names, low, high = names[::-1], 1 / high, 1 / low
                intervals.setdefault((rank["error"], *names), []).append((low, high))
    pairs = 0
    for found in intervals.values():
        for i, a in enumerate(found):
            for b in found[:i]:
                pairs += 1
                contradictions += a[0] > b[1] or b[0] > a[1]
    print(f"{name}: {contradictions} of {pairs} pairs of intervals contradict each other")
    return contradictions


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--scene", choices=list(SCENES), action="append")
    parser.add_argument("--repeats", type=int, default=0)
    asked = parser.parse_args()
    total, contradictions = [0, 0, 0], 0
    with tempfile.TemporaryDirectory() as folder:
        for name in asked.scene or SCENES:
            total = [a + b for a, b in zip(total, judge(asked.program, name, folder))]
            if asked.repeats:
                contradictions += repeat(asked.program, name, folder, asked.repeats)
    print(f"{total[1]} of {total[0]} factors by work, {total[2]} by time, are those of the dense grid")
    sys.exit(total[1] < 0.95 * total[0] or contradictions > 0)


if __name__ == "__main__":
    main()
