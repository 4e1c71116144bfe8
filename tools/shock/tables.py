"""The tables of README.md, from the figures of a run."""


def table(head, rows):
    """Markdown; all columns but the first have numbers."""
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---:"] * len(head), *rows]) + "\n"


def percent(part, digits=0):
    return f"{100 * part:+.{digits}f} %".replace("-", "−")


def point_blast(rows):
    return table(["cells", "radius of the shock", "pressure, mean error", "peak"],
                 [[f"{r['cells']:,}", percent(r["radius_error"], 1), f"{100 * r['profile_error']:.0f} %", percent(r["peak_error"])] for r in rows])


def burst(rows):
    cells = [f"{r['cell']:.2f} m" for r in rows]
    head = ["distance", "peak of the curve", *(f"cells of {width}" for width in cells), "arrival by the curve", *cells]
    lines = []
    for gauges in zip(*(r["gauges"] for r in rows)):
        errors = [[percent(g[key] / g[key + "_reference"] - 1) for g in gauges] for key in ("peak", "arrival")]
        first = gauges[0]
        lines.append([f"{first['radius']:g} m", f"{first['peak_reference'] / 1e3:,.0f} kPa", *errors[0], f"{first['arrival_reference'] * 1e3:.1f} ms", *errors[1]])
    mean = lambda row, key: sum(abs(g[key] / g[key + "_reference"] - 1) for g in row["gauges"]) / len(row["gauges"])  # noqa: E731
    means = [[f"{100 * mean(row, key):.0f} %" for row in rows] for key in ("peak", "arrival")]
    return table(head, [*lines, ["mean error", "", *means[0], "", *means[1]]])


def gauges(rows):
    pair = lambda when, peak: f"{1e3 * when:.1f} ms, {peak / 1e3:,.{0 if peak > 5e4 else 1}f} kPa"  # noqa: E731
    curve = lambda g: pair(g["arrival_reference"], g["peak_reference"]) if "peak_reference" in g else ""  # noqa: E731
    return table(["gauge", "computed", "the curve"], [[name, pair(g["arrival"], g["peak"]), curve(g)] for name, g in rows.items()])
