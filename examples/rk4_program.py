"""The classical method of Runge (1895) and Kutta (1901) in Python: clothsim-program(7)."""
from clothsim_program import serve


def rk4(host, t, h, y):
    a = host.rate(t, y)
    b = host.rate(t + h / 2, y + h / 2 * a)
    c = host.rate(t + h / 2, y + h / 2 * b)
    d = host.rate(t + h, y + h * c)
    return y + h / 6 * (a + 2 * b + 2 * c + d)


serve(step=rk4, name="python-rk4", order=4, source="Kutta 1901")
