"""brakewave from Python: compute, and read what was computed.

    import brakewave
    from brakewave import variant
    folder = brakewave.run("problems/impact_oscillator.ron", out="results/impact", force=True)
    print(folder.events[["type", "A", "what"]])

The verbs call the program (see `brakewave.program`), with files or dicts as problems (`brakewave.problem`); `Folder`, `read` and `Tube`
read what is there (`brakewave.reader`), the functions `draw_…` draw it with matplotlib (`brakewave.pictures`).
`python -m brakewave.check DIR` proves certificates again and needs python-flint alone.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .pictures import (
        COLOURS as COLOURS,
        MARKS as MARKS,
        SEQUENCES as SEQUENCES,
        draw_branch as draw_branch,
        draw_curve as draw_curve,
        draw_exponents as draw_exponents,
        draw_map as draw_map,
        draw_profile as draw_profile,
        draw_regimes as draw_regimes,
        draw_scan as draw_scan,
        draw_spectrum as draw_spectrum,
    )
    from .problem import Variant as Variant, ron as ron, variant as variant
    from .process import binary as binary
    from .program import (
        Checked as Checked,
        Incomplete as Incomplete,
        Refused as Refused,
        accuracy as accuracy,
        certify as certify,
        check as check,
        curve as curve,
        map as map,
        merge as merge,
        plot as plot,
        report as report,
        run as run,
        scan as scan,
        simulate as simulate,
        spectrum as spectrum,
        steady as steady,
        verify as verify,
    )
    from .reader import (
        PARAMETERS as PARAMETERS,
        REGIMES as REGIMES,
        Folder as Folder,
        Pictures as Pictures,
        Tube as Tube,
        inertia as inertia,
        parameters as parameters,
        read as read,
        varying as varying,
        zones as zones,
    )

_MODULES = {
    "pictures": "draw_branch draw_curve draw_exponents draw_map draw_profile draw_regimes draw_scan draw_spectrum COLOURS MARKS SEQUENCES",
    "problem": "Variant ron variant",
    "process": "binary",
    "program": "Checked Incomplete Refused accuracy certify check curve map merge plot report run scan simulate spectrum steady verify",
    "reader": "PARAMETERS REGIMES Folder Pictures Tube inertia parameters read varying zones",
}
_HOMES = {name: module for module, names in _MODULES.items() for name in names.split()}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    # what is imported late is not needed by all: the checker has no use for pandas, and the verbs none for python-flint
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOMES[name]}", __name__), name)


def __dir__() -> list[str]:
    return __all__
