# SPDX-License-Identifier: MIT
"""The equation of motion, written from docs/theory.md and docs/contact.md alone.

Springs, gravity, drag; contact by force with spheres, planes, boxes, capsules and meshes, between
bodies and of a body with itself; smooth friction and damping. Every pair is looked at in every
evaluation, and distances are differentiated by a complex step (Squire, Trapp 1998), so that
neither lists nor gradients are shared with the program. SciPy's DOP853 integrates.
"""
import itertools
import json
from functools import reduce
from pathlib import Path

import numpy as np

from surfaces import Surface, read_grid, read_mesh, read_obj

TINY = 1e-30  # complex step


def dot(a, b):
    return sum(a[..., c] * b[..., c] for c in range(a.shape[-1]))  # np.sum is slow over three


def smooth_positive(x, e):
    """S: 0 below -e, x above e."""
    z = (x + e) / (2 * e)
    return np.where(np.real(x) <= -e, 0, np.where(np.real(x) >= e, x, 2 * e * z**4 * (z * z - 3 * z + 2.5)))


def step(x):
    x = np.where(np.real(x) < 0, 0, np.where(np.real(x) > 1, 1, x))
    return x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3)


def barrier(d, D, k):
    """F and K of the law; F is linear in the core, y < 1e-3."""
    y = np.clip(d / D, 1e-3, 1)
    K = k / 6 * (1 - y)**2 * (1 + 2 * y + 3 * y**2) / y**3
    return k * D / 12 * (1 - y)**3 * (1 + 3 * y) / y**2 + K * D * np.maximum(1e-3 - d / D, 0), K


def edge_pair(p, R):
    """Distance of edges p0 p1 and p2 p3 and the weights of the points between which friction acts."""
    u, v, w = p[:, 0] - p[:, 1], p[:, 3] - p[:, 2], p[:, 0] - p[:, 2]
    s = np.sqrt(np.stack([dot(u, u), dot(v, v)]))
    both = s[0] + s[1]
    pull = s * both / (2000 + 6.25 * both**2 / R**2)
    a, b, c = dot(u, u) + pull[0], dot(u, v), dot(v, v) + pull[1]
    right = dot(u, w) + pull[0] / 2, dot(v, w) + pull[1] / 2
    det = a * c - b * b
    l = np.stack([c * right[0] - b * right[1], a * right[1] - b * right[0]]) / det
    e = 0.1 / np.sqrt(1 + (0.1 * s / R)**2)
    L = smooth_positive(l, e) - smooth_positive(l - 1, e)
    r = w - L[0][:, None] * u - L[1][:, None] * v
    return np.sqrt(dot(r, r) + 1e-24), np.stack([1 - L[0], L[0], L[1] - 1, -L[1]], axis=1)


def foot_of(p):
    """Sides u, v of a triangle and w to the point; the foot is at l1 u + l2 v."""
    u, v, w = p[:, 2] - p[:, 1], p[:, 3] - p[:, 1], p[:, 0] - p[:, 1]
    a, b, c = dot(u, u), dot(u, v), dot(v, v)
    return u, v, w, (c * dot(u, w) - b * dot(v, w)) / (a * c - b * b), (a * dot(v, w) - b * dot(u, w)) / (a * c - b * b)


def feature(p, form, e):
    """Distance of p0 from the edge p1 p2 (form 1), the vertex p1 (2) or the plane (0) of a triangle."""
    u, v, w, l1, l2 = foot_of(p)
    a, foot = dot(u, u), w - l1[:, None] * u - l2[:, None] * v
    t, width = dot(u, w) / a, e / np.sqrt(a + 4 * e * e)
    zeta = np.where(np.real(t) < 0.5, t * step(t / width), 1 - (1 - t) * step((1 - t) / width))
    zeta = np.where(form == 1, zeta, 0)
    leg = w - zeta[:, None] * u
    height, m = dot(foot, foot), dot(leg, leg) - dot(foot, foot)

    def f(m):
        return np.where(form > 0, m * step((m - e * e / 8) / (7 / 8 * e * e)), 0)
    slope = np.imag(f(np.real(m) + 1j * TINY)) / TINY
    wu, wv = -((1 - slope) * l1 + slope * zeta), -(1 - slope) * l2
    return np.sqrt(height + f(m) + 1e-24), np.stack([1 + 0 * wu, -1 - wu - wv, wu, wv], axis=1)


def gradient(distance, p, *args):
    """The gradient of a distance by the points (n, 4, 3): 12 states of each pair at a time."""
    n = len(p)
    states = np.tile(p.astype(complex), (12, 1, 1)).reshape(12, n, 12)
    states[np.arange(12), :, np.arange(12)] += 1j * TINY
    d, _ = distance(states.reshape(-1, 4, 3), *(np.tile(a, 12) if np.ndim(a) else a for a in args))
    return np.imag(d).reshape(12, n).T.reshape(n, 4, 3) / TINY


class Model:
    def __init__(self, path):
        self.scene = scene = json.loads(Path(path).read_text())
        x, v, springs, mass, surfaces = [], [], [], [], []
        for body in scene["bodies"]:
            first = sum(map(len, x))
            own, triangles, kinds = (read_grid if "cloth" in body else read_mesh)(body, Path(path).parent)
            for kind, ends in kinds:
                rest = np.linalg.norm(own[ends[:, 0]] - own[ends[:, 1]], axis=1)
                springs += [(*(pair + first), length, body["springs"].get(kind, 0), body["springs"].get("damping", 0))
                            for pair, length in zip(ends, rest)]
            surfaces.append(Surface(triangles, first, len(own)))
            shape = body.get("cloth", body.get("mesh"))
            x.append(own + shape.get("place", {}).get("translate", [0, 0, 0]))
            v.append(np.tile(np.array(shape.get("velocity", [0, 0, 0]), float), (len(own), 1)))
            mass.append(np.full(len(own), body["mass"]["particle"]))
        self.n, n_bodies = sum(map(len, x)), len(x)
        self.colliders = [c for c in scene.get("colliders", []) if "mesh" not in c]
        for c in scene.get("colliders", []):
            if "mesh" in c:
                own, triangles = read_obj(Path(path).parent / c["mesh"]["file"])
                surfaces.append(Surface(triangles, sum(map(len, x)), len(own)))
                x.append(own + c["mesh"].get("place", {}).get("translate", [0, 0, 0]))
                v.append(0 * own)
        self.x, self.v, self.mass = np.concatenate(x), np.concatenate(v), np.concatenate(mass)
        table = np.array(springs)
        self.a, self.b = table[:, 0].astype(int), table[:, 1].astype(int)
        self.length, self.k, self.damper = table[:, 2:].T
        self.free = np.ones(self.n, bool)
        for body, surface in zip(scene["bodies"], surfaces):
            self.free[surface.points[body.get("pins", [])]] = False
        self.v[:self.n][~self.free] = 0
        self.law = {"stiffness": None, "damping": 0, "friction_speed": 1e-3, **scene.get("contact", {})}
        self.meetings = list(self.find_meetings(surfaces, n_bodies))

    def find_meetings(self, surfaces, n_bodies):
        """Of each two surfaces that meet: D, mu, point-triangle pairs with weights, edge pairs."""
        scene, meshes = self.scene, [c for c in self.scene.get("colliders", []) if "mesh" in c]
        for i, j in ((i, j) for i in range(n_bodies) for j in range(i, len(surfaces))):
            A, B, own = surfaces[i], surfaces[j], i == j
            D, mu = scene["bodies"][i].get("thickness"), scene["bodies"][i].get("friction", 0)
            if own and not scene["bodies"][i].get("self_contact"):
                continue
            if j >= n_bodies:
                D, mu = meshes[j - n_bodies]["thickness"], meshes[j - n_bodies].get("friction", 0)
            elif not own:
                if scene.get("pairs", {}).get("among") != "all":
                    continue
                D, mu = (D + scene["bodies"][j]["thickness"]) / 2, scene["pairs"].get("friction", 0)
            sides = [(A, B)] if own else [(A, B), (B, A)]
            points = [(p, s, t) for q, s in sides for p in q.points for t in range(len(s.triangles))
                      if not (own and p in s.triangles[t])]
            edges = [(*e, *f) for (m, e), (k, f) in itertools.product(enumerate(A.edges), enumerate(B.edges))
                     if not own or (m < k and not set(e) & set(f))]
            rows = np.array([(p, *s.triangles[t]) for p, s, t in points]).reshape(-1, 4)
            inner = np.array([s.inner[t] & (s.across[t] != p) for p, s, t in points]).reshape(-1, 3)
            share = np.array([[0 if own and (p, q) in s.joined else part for q, part in zip(s.triangles[t], s.share[t])]
                              for p, s, t in points]).reshape(-1, 3)
            yield D, mu, rows, inner, share, np.array(edges, int).reshape(-1, 4)

    def near(self, x, rows, split, D):  # which pairs have boxes nearer than D
        p = [x[column] for column in rows.T]
        low, high = ([reduce(least, side) for side in (p[:split], p[split:])] for least in (np.minimum, np.maximum))
        gap = np.maximum(low[0] - high[1], low[1] - high[0])
        return (gap[:, 0] < D) & (gap[:, 1] < D) & (gap[:, 2] < D)

    def add_pairs(self, f, x, v, distance, found, args, rows, D, k, mu):
        inside = (found[0] < D) & (k != 0)
        d, weights, rows, k = found[0][inside], found[1][inside], rows[inside], k[inside]
        g = gradient(distance, x[rows], *(a[inside] if np.ndim(a) else a for a in args))
        F, K = barrier(d, D, k)
        r, V = np.einsum("nk,nkc->nc", weights, x[rows]), np.einsum("nk,nkc->nc", weights, v[rows])
        normal = r / np.sqrt(dot(r, r) + 1e-24)[:, None]
        approach = dot(normal, V)
        T = V - normal * approach[:, None]
        rub = mu * F / np.sqrt(dot(T, T) + self.law["friction_speed"]**2)
        R = -self.law["damping"] * (K * approach)[:, None] * normal - rub[:, None] * T
        np.add.at(f, rows, F[:, None, None] * g + weights[:, :, None] * R[:, None])

    def add_meeting(self, f, x, v, D, mu, rows, inner, share, edges):
        near, k = self.near(x, rows, 1, D), self.law["stiffness"]
        rows, inner, share, e, range_ = rows[near], inner[near], share[near], 0.2 * D, 0.992 * D
        if len(rows):
            *_, l1, l2 = foot_of(x[rows])
            beyond = np.stack([l2, 1 - l1 - l2, l1]) < 0  # edges 12, 23, 31
            # the plane, three edges and three vertices: rows turned so that each comes first
            turned = np.concatenate([rows] + 2 * [rows[:, [0, 1, 2, 3]], rows[:, [0, 2, 3, 1]], rows[:, [0, 3, 1, 2]]])
            args = np.repeat([0, 1, 1, 1, 2, 2, 2], len(rows)), e
            found = feature(x[turned], *args)
            reach = np.where(beyond, found[0].reshape(7, -1)[1:4], np.inf)
            nearest = beyond & (np.arange(3)[:, None] == reach.argmin(0))
            times = np.concatenate([[~beyond.any(0)], nearest - inner.T / 2, share.T]).ravel()
            self.add_pairs(f, x, v, feature, found, args, turned, range_, k * times, mu)
        edges = edges[self.near(x, edges, 2, D / 2)]
        if len(edges):
            found = edge_pair(x[edges], D / 2)
            self.add_pairs(f, x, v, edge_pair, found, (D / 2,), edges, D / 2, np.full(len(edges), 4 * k), mu)

    def collider_distance(self, c, x):
        """Distance of points from a sphere, plane, floor, box or capsule."""
        if "sphere" in c:
            r = x - np.array(c["sphere"]["centre"])
            return np.sqrt(dot(r, r)) - c["sphere"]["radius"]
        if "floor" in c:
            return x[:, 1] - c["floor"]["height"]
        if "plane" in c:
            n = np.array(c["plane"]["normal"]) / np.linalg.norm(c["plane"]["normal"])
            return dot(x - np.array(c["plane"]["point"]), n)
        if "box" in c:
            radius = c["box"]["radius"]
            own, core = x - np.array(c["box"]["centre"]), np.array(c["box"]["size"]) / 2 - radius
        else:
            ends, radius = np.array([c["capsule"]["from"], c["capsule"]["to"]]), c["capsule"]["radius"]
            along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
            r = x - ends.mean(0)
            h = dot(r, along)
            flat = r - h[:, None] * along
            own, core = np.stack([np.sqrt(dot(flat, flat)), h], axis=1), np.array([0, np.linalg.norm(ends[1] - ends[0]) / 2])
        size = np.where(np.real(own) < 0, -own, own)
        e = np.minimum(radius / 2, core)
        q = np.stack([size[:, i] if core[i] == 0 else smooth_positive(size[:, i] - core[i], e[i]) for i in range(len(core))], 1)
        d = np.sqrt(dot(q, q) + 1e-300) - radius
        return d if "capsule" in c else d - smooth_positive(-(size - core), e).min(1)

    def add_collider(self, f, x, v, c):
        d = np.real(self.collider_distance(c, x))
        inside = np.flatnonzero(d < c["thickness"])
        g = np.stack([np.imag(self.collider_distance(c, x[inside] + way)) for way in 1j * TINY * np.eye(3)], 1) / TINY
        F, K = barrier(d[inside], c["thickness"], self.law["stiffness"])
        square, approach = dot(g, g), dot(g, v[inside])
        T = v[inside] - g * (approach / square)[:, None]
        rub = c.get("friction", 0) * F * np.sqrt(square) / np.sqrt(dot(T, T) + self.law["friction_speed"]**2)
        f[inside] += (F - self.law["damping"] * K * approach)[:, None] * g - rub[:, None] * T

    def force(self, x, v):
        f = np.zeros_like(x)
        way = x[self.b] - x[self.a]
        length = np.sqrt(dot(way, way))
        u = way / length[:, None]
        pull = self.k * (length - self.length) + self.damper * dot(v[self.b] - v[self.a], u)
        np.add.at(f, self.a, pull[:, None] * u)
        np.add.at(f, self.b, -pull[:, None] * u)
        f[:self.n] += self.mass[:, None] * np.array(self.scene["forces"].get("gravity", [0, -9.81, 0]))
        f[:self.n] -= self.scene["forces"].get("drag", 0) * v[:self.n]
        for c in self.colliders:
            self.add_collider(f[:self.n], x[:self.n], v[:self.n], c)
        for meeting in self.meetings:
            self.add_meeting(f, x, v, *meeting)
        return f

    def run(self, seconds, rtol=1e-12):
        """Positions (n, 3) of all particles after so many seconds, to some 1e-12 m."""
        from scipy.integrate import solve_ivp  # half a second that forces alone do without
        fixed, n = self.x[self.n:], self.n

        def rate(_, state):
            x, v = state[:3 * n].reshape(n, 3), state[3 * n:].reshape(n, 3)
            f = self.force(np.concatenate([x, fixed]), np.concatenate([v, 0 * fixed]))[:n]
            return np.concatenate([(v * self.free[:, None]).ravel(), (f * self.free[:, None] / self.mass[:, None]).ravel()])
        start = np.concatenate([self.x[:n].ravel(), self.v[:n].ravel()])
        found = solve_ivp(rate, (0, seconds), start, "DOP853", rtol=rtol, atol=1e-13, max_step=2e-3)
        assert found.success, found.message
        return found.y[:3 * n, -1].reshape(n, 3)
