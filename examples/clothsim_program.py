"""A method in Python as a program of clothsim, by NumPy alone: see clothsim-program(7).

    from clothsim_program import serve, rate

    def heun(host, t, h, y):
        a = host.rate(t, y)
        b = host.rate(t + h, y + h * a)
        return y + h / 2 * (a + b)

    serve(step=heun, name="heun", order=2)

    clothsim run scenes/hang.json -i 'program:python3 heun.py:dt=0.001'

y is the state, 6n numbers: positions in m, all x, all y, all z, then velocities in m/s in the same way.
"""
import math
import mmap
import os
import socket
import struct
import sys
import traceback

import numpy as np

VERSION = 1
PART_ALL = 0x7FFFFFFF
MESSAGE = struct.Struct("<QQ4d")
DESCRIPTION = struct.Struct("<7Q64s256s256s64s32s32s32s32s")
OPTION = struct.Struct("<32s16s96s3d")
HEAD, TEXT_AT, TEXT_MAX = 8192, 4096, 4095
NO_HISTORY = 1000000
NEEDS = {"jvp": 1, "diagonal": 2, "energy": 4, "solve": 16, "bounds": 512}
TRAITS = {"implicit": 1, "adaptive": 2, "multistep": 4, "symplectic": 8, "library-bits": 16,
          "not-galilean": 32, "makes-energy": 128, "smooth-only": 256}
FIDELITIES = ["ode", "implicit-euler", "consistent", "other"]
# arrays behind the head: name, rows of n doubles
ARRAYS = (("x", 3), ("v", 3), ("f", 3), ("dx", 3), ("dv", 3), ("kxx", 6), ("dvv", 6), ("mass", 1),
          ("inv_mass", 1), ("start", 3))


class Unable(Exception):
    """Raised by a method that finds no step short enough: the run ends with that as its result."""


class Host:
    """What a method may ask. The arrays x, v, f, dx, dv, kxx, dvv, mass, inv_mass and start are shared
    with clothsim; counts are those of clothsim-program(7); history has what save and load pass on."""

    def __init__(self, history):
        try:
            self._socket = socket.socket(fileno=3)
            self._memory = mmap.mmap(4, 0)
        except OSError:
            raise SystemExit(f"{sys.argv[0]}: a method of clothsim, expected to be started by it: "
                             f"clothsim run SCENE.json -i 'program:python3 {sys.argv[0]}'") from None
        self.n = struct.unpack_from("<Q", self._memory, 8)[0]
        reals = np.frombuffer(self._memory, dtype="<f8")
        at = HEAD // 8
        self.y = reals[at:at + 6 * self.n]
        for name, rows in ARRAYS:
            setattr(self, name, reals[at:at + rows * self.n])
            at += rows * self.n
        self.history = reals[at:at + (history or 0) * self.n]
        self.counts = np.frombuffer(self._memory, dtype="<u8")[7:11]

    # --- messages ---

    def _receive(self):
        message = b""
        while len(message) < MESSAGE.size:
            try:
                more = self._socket.recv(MESSAGE.size - len(message))
            except ConnectionError:
                more = b""
            if not more:
                os._exit(0)  # the run is over
            message += more
        code, count, *values = MESSAGE.unpack(message)
        return chr(code), count, values

    def _send(self, letter, count=0, *values):
        try:
            self._socket.sendall(MESSAGE.pack(ord(letter), count, *values, *[0.0] * (4 - len(values))))
        except OSError:
            os._exit(0)

    def _ask(self, letter, count=0, *values):
        self._send(letter, count, *values)
        return self._receive()[1:]

    def _write(self, text):
        encoded = text.encode()[:TEXT_MAX]
        self._memory[TEXT_AT:TEXT_AT + len(encoded) + 1] = encoded + b"\0"

    def _read(self):
        return self._memory[TEXT_AT:HEAD].split(b"\0")[0].decode()

    def _begin(self):
        self.offers, self.omega, self.delta, self.length_scale, self.speed_scale = (
            struct.unpack_from("<Q4d", self._memory, 16))
        self.options = {key: float(value) for key, value in
                        (line.split("=") for line in self._read().split())}

    def _set(self, y):
        if y is not self.y:
            self.y[:] = y

    def _describe(self, name, order, summary, source, options, history, order_damped=None, needs="",
                  traits="", fidelity="ode", library="", fails=""):
        numbers = (order, order if order_damped is None else order_damped, FIDELITIES.index(fidelity),
                   sum(NEEDS[word] for word in set(needs.split())),
                   sum(TRAITS[word] for word in set(traits.split())),
                   NO_HISTORY if history is None else history, len(options))
        texts = [text.encode()[:size - 1] for text, size in
                 ((name, 64), (summary, 256), (source, 256), (library, 64))]
        fails = [word.encode() for word in fails.split()] + 4 * [b""]
        self._memory[TEXT_AT:HEAD] = bytes(HEAD - TEXT_AT)
        DESCRIPTION.pack_into(self._memory, TEXT_AT, *numbers, *texts, *fails[:4])
        for k, (option, unit, *values, meaning) in enumerate(options):
            OPTION.pack_into(self._memory, TEXT_AT + DESCRIPTION.size + k * OPTION.size,
                             option.encode(), unit.encode(), meaning.encode()[:95], *values)

    # --- what a method may ask ---

    def force(self, t, y, parts=PART_ALL):
        """f (3n) in N of the chosen parts."""
        self._set(y)
        self._ask("F", parts, t)
        return self.f

    def rate(self, t, y):
        """dy/dt of all forces, (6n): v, then M^-1 f."""
        n3 = 3 * self.n
        f = self.force(t, y)
        dy = np.empty(6 * self.n)
        dy[:n3] = y[n3:]
        np.multiply(f.reshape(3, -1), self.inv_mass, out=dy[n3:].reshape(3, -1))
        return dy

    def jvp(self, t, y, dy, parts=PART_ALL):
        """df (3n) = (df/dx) dx + (df/dv) dv. Needs jvp."""
        self._set(y)
        n3 = 3 * self.n
        self.dx[:], self.dv[:] = dy[:n3], dy[n3:]
        self._ask("J", parts, t)
        return self.f

    def diagonal(self, t, y):
        """The 3x3 blocks df_i/dx_i and df_i/dv_i, (6n) each: xx xy xz yy yz zz. Needs diagonal."""
        self._set(y)
        self._ask("G", 0, t)
        return self.kxx, self.dvv

    def energy(self, t, y):
        """Kinetic and potential energy in J. Needs energy."""
        self._set(y)
        return self._ask("E", 0, t)[1][0]

    def solve_setup(self, t, y, cm, cd, ck, flags=0):
        """A = cm M + cd df/dv + ck df/dx at (t, y). Needs solve."""
        self._set(y)
        self._ask("L", flags, t, cm, cd, ck)

    def solve(self, b, rtol, start=0.0):
        """u (3n) of A u = b; None if it failed and the set-up had the flag 8."""
        self.f[:], self.dx[:] = b, start
        return None if self._ask("S", 0, rtol)[0] else self.dx

    def matrix_product(self, p):
        """A p, (3n)."""
        self.dx[:] = p
        self._ask("M")
        return self.f

    def precondition(self, r):
        """Near A^-1 r, (3n)."""
        self.f[:] = r
        self._ask("P")
        return self.dx

    def bounds(self, t, y):
        """Bounds on the angular frequency and on half the damping rate, both in 1/s. Needs bounds."""
        self._set(y)
        return self._ask("B", 0, t)[1][:2]

    def max_step_fraction(self, t0, x0, t1, x1):
        """The admissible fraction, 0 to 1, of the displacement from x0 to x1, (3n) each."""
        if not self.offers & 1:
            return 1.0
        self.x[:], self.dx[:] = x0, x1
        return self._ask("K", 0, t0, t1)[1][0]

    def longest_step(self, t, y):
        """The longest step in s that contact by projection bears."""
        if not self.offers & 4:
            return math.inf
        self._set(y)
        return self._ask("T", 0, t)[1][0]

    def commit(self, t, h, y):
        """Ends a step of length h at t. Returns the state, and whether it is another one than y."""
        self._set(y)
        changed = self._ask("C", 0, t, h)[0]
        return self.y.copy(), bool(changed)

    def note(self, text):
        """A remark for the report."""
        self._write(text)
        self._ask("N")

    # --- steps, as include/clothsim/driver.h takes them ---

    def _refuses(self, t, x0, h, x1):
        return self.max_step_fraction(t, x0, t + h, x1) < 1

    def _step_or_halve(self, step, t, h, end, shortest, y):
        n3 = 3 * self.n
        x, v = y[:n3], y[n3:]
        if not self.offers & 1 or not self._refuses(t, x, h, x + h * v):
            new = step(self, t, h, y)
            if not self.offers & 1 or not self._refuses(t, x, h, new[:n3]):
                return self.commit(end, h, new)[0]
        self.counts[0] += 1
        if h < shortest:
            raise Unable(f"a step of {h:.3g} s at t = {t:.9g} s still misses contact or crosses a "
                         "surface")
        y = self._step_or_halve(step, t, h / 2, t + h / 2, shortest, y)
        return self._step_or_halve(step, t + h / 2, h / 2, end, shortest, y)

    def steps(self, step, limit, t0, t1, y):
        """From t0 to t1 in steps of the option dt, or of limit(omega, delta) where that is 0."""
        t, i, dt = t0, 0, self.options["dt"]
        while t < t1:
            longest = dt if dt > 0 else min(limit(*self.bounds(t, y)), self.longest_step(t, y))
            begin = t0 if dt > 0 else t
            n = max(math.ceil((t1 - begin) / longest * (1 - 1e-9)), 1)
            h = (t1 - begin) / n
            i = i + 1 if dt > 0 else 1
            end = begin + i * h if i < n else t1
            y = self._step_or_halve(step, t, h, end, h / 65536, y)
            t = end
        return y


def serve(advance=None, step=None, limit=None, restart=None, name="program", order=1, summary=None,
          source="none", options=(), history=0, **words):
    """Describes the method, and answers clothsim until it ends the program.

    step(host, t, h, y) -> y: a one-step method, without the commit. It gets the option dt; limit(omega,
    delta) is its longest stable step in s, which makes dt=0 possible, else dt is 0.001.
    advance(host, t0, t1, y) -> y: a method with a loop of its own, which ends each step by commit.
    restart(host, t, y): the state was changed from outside. options: (name, unit, default, least,
    largest, help). history: rows of n numbers in host.history that must survive a checkpoint; None: the
    method restarts there. words: order_damped, needs, traits, fidelity, library and fails, each a text of
    words of clothsim-program(7), such as needs="jvp solve"."""
    if step:
        default = 0.0 if limit else 0.001
        options = (("dt", "s", default, default and 1e-9, 1.0, "step"),) + tuple(options)
        if limit:
            words["needs"] = words.get("needs", "") + " bounds"

        def advance(host, t0, t1, y):
            return host.steps(step, limit, t0, t1, y)
    host = Host(history)
    host._describe(name=name, order=order, summary=summary or name, source=source, options=options,
                   history=history, **words)
    host._send("V", VERSION)
    while True:
        letter, _, values = host._receive()
        try:
            if letter == "Q":
                return
            if letter == "I":
                host._begin()
            elif letter == "R" and restart:
                restart(host, values[0], host.y.copy())
            elif letter == "A":
                advance(host, values[0], values[1], host.y.copy())
            host._send("D")
        except Unable as why:
            host._write(str(why))
            host._send("H")
        except Exception as why:
            traceback.print_exc()
            host._write(f"{type(why).__name__}: {why}")
            host._send("X")
