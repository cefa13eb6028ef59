"""brakewave from Python: compute, and read what was computed.

    import brakewave
    from brakewave import variant
    folder = brakewave.run("problems/impact_oscillator.ron", out="results/impact", force=True)
    print(folder.events[["type", "A", "what"]])

`run`, `curve`, `map`, `scan`, `simulate` and `steady` call the program and return a `Folder` (see `brakewave.program`);
`Folder`, `read`, `Tube` and the functions `draw_…` read and draw what is there (see `brakewave.reader`, which needs
pandas, and matplotlib for pictures). `python -m brakewave.check DIR` proves certificates again and needs python-flint.
"""

from importlib import import_module

_PROGRAM = "Refused ron run curve map scan simulate steady variant Variant".split()


def __getattr__(name):
    # the checker needs no pandas, and the reader no flint
    if name.startswith("__"):
        raise AttributeError(name)
    return getattr(import_module(".program" if name in _PROGRAM else ".reader", __name__), name)


def __dir__():
    return [*_PROGRAM, *filter(str.isidentifier, dir(import_module(".reader", __name__)))]
