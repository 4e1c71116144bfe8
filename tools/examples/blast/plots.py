"""The plot of the gauges in the stadium."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import gas  # noqa: E402

STYLE = {"svg.hashsalt": "teracell", "font.size": 11, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#dddddd",
         "grid.linewidth": 0.8, "axes.axisbelow": True}
COLOURS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#222222", "#7f7f7f")


@matplotlib.rc_context(STYLE)
def gauges(path, names, times, pressures, arrivals):
    """The overpressure of each gauge; `arrivals` says for some of them when the shock would arrive in open air, and with which peak."""
    figure, all_axes = plt.subplots(len(names), 1, sharex=True, figsize=(8.6, 1.15 * len(names) + 0.6), constrained_layout=True)
    for name, colour, axes, pressure in zip(names, COLOURS, all_axes, pressures.T):
        axes.plot(times * 1e3, over := (pressure - gas.P0) / 1e3, color=colour, lw=1.3)
        axes.axhline(0, color="#999999", lw=0.8)
        axes.text(0.995, 0.93, name, transform=axes.transAxes, ha="right", va="top")
        if name in arrivals:
            when, peak = arrivals[name]
            axes.plot([when * 1e3], [peak / 1e3], marker="o", ms=7, mfc="none", mec="#222222")
        highest = max(over.max(), arrivals.get(name, (0, 0))[1] / 1e3)
        axes.set_ylim(1.1 * min(-0.1 * highest, over.min()), 1.3 * highest)
    all_axes[-1].set_xlabel("time, ms")
    figure.supylabel("overpressure, kPa", fontsize=11)
    figure.savefig(path, metadata={"Date": None})  # so that the same numbers give the same bytes
    plt.close(figure)
