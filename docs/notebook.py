# %% [markdown]
# # From equations to a diagram
# An oscillator hits a stop: x'' + c x' + x = A cos(ωt) while x < d, and v becomes −e v at x = d. As the force falls
# its orbit loses stability. What comes of it? `pip install ./python`, and put the program on PATH, or its path into the
# variable BRAKEWAVE.

# %%
import brakewave
from brakewave import variant

system = dict(
    states=["x", "v"],
    parameters={"c": 0.1, "A": 1.0, "w": 0.8, "d": 1.0, "e": 0.8},
    forcing="w",
    modes={
        "free": dict(
            rates={"x": "v", "v": "A*cos(phase) - c*v - x"},
            until=[dict(zero="d - x", to="free", reset={"v": "-e*v"})],
        ),
    },
)


def orbit(periods):
    rest = variant.Simulate(mode="free", state={"x": 0.0, "v": 0.0}, settle=300)
    return dict(start=rest, periods=periods)


# %% [markdown]
# ## What motions settle on
# For every value of A the motion is followed for 200 periods, each from where that of the value above has come to; then
# x is noted wherever it is least, that is where v rises to zero.

# %%
values = variant.Linear(0.3, 1.0, 200)
section = variant.Zero("v")
scan = brakewave.scan(
    dict(
        title="Impact oscillator",
        system=system,
        orbit=orbit(1),
        scan=dict(parameter="A", values=values, sweep=variant.Down, settle=200, keep=40, section=section),
    ),
    out="scan",
    force=True,
    quiet=True,
)
print(scan.scan.round({"x": 6}).groupby("value")["x"].nunique().describe())

# %% [markdown]
# ## What is there besides
# Branches of periodic orbits, stable or not, through every event: the orbit with one impact in a period, and what a motion
# comes to at A = 0.5, within eight periods.

# %%
branches = []
for name, start in [("single", 1.0), ("below", 0.5)]:
    parameters = {**system["parameters"], "A": start}
    problem = dict(
        title="Impact oscillator",
        system={**system, "parameters": parameters},
        orbit=orbit(8),
        continuation=dict(parameter="A", range=(0.3, 1.0), toward=variant.Both if start < 1.0 else variant.Down, max_points=2000),
        stability={},
    )
    try:
        branches.append(brakewave.run(problem, out=name, force=True, quiet=True))
    except brakewave.Refused as reason:
        print(f"{name}: {reason}")
        continue
    print(name, branches[-1].events[["type", "A", "period", "what"]].to_string(), sep="\n")

# %% [markdown]
# ## One picture

# %%
axes = brakewave.draw_scan(scan)
for branch in branches:
    brakewave.draw_branch(branch, y="min_x", axes=axes)
axes.set(xlabel="A", ylabel="least x", xlim=(0.3, 1.0))
handles = dict(zip(*reversed(axes.get_legend_handles_labels())))
axes.legend(handles.values(), handles.keys())
axes.figure.savefig("impact.png", dpi=150)
