# SPDX-License-Identifier: MIT
"""Log-log plots as SVG, without any package."""
import html
import math

COLOURS = ["#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf", "#8c564b", "#7f7f7f", "#bcbd22", "#e377c2"]
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 720, 440, 70, 200, 36, 50


def short(value):
    for size, suffix in ((1e9, "G"), (1e6, "M"), (1e3, "K")):
        if value >= size:
            return f"{value / size:g}{suffix}"
    return f"{value:g}"


def log_plot(title, x_label, y_label, series, slopes=False, lines=True):
    """series: name -> list of (x, y), all positive. With slopes, each name gets the exponent of its line."""
    series = {k: sorted((x, y) for x, y in v if x > 0 and y > 0) for k, v in series.items()}
    series = {k: v for k, v in series.items() if v}
    points = [p for v in series.values() for p in v]
    if not points:
        return None
    low_x, high_x = (f(math.log10(p[0]) for p in points) for f in (min, max))
    low_y, high_y = (f(math.log10(p[1]) for p in points) for f in (min, max))
    low_x, high_x = low_x - 0.1, high_x + 0.1
    low_y, high_y = math.floor(low_y - 0.05), math.ceil(high_y + 0.05)
    place_x = lambda x: LEFT + (math.log10(x) - low_x) / (high_x - low_x) * (WIDTH - LEFT - RIGHT)
    place_y = lambda y: HEIGHT - BOTTOM - (math.log10(y) - low_y) / (high_y - low_y) * (HEIGHT - TOP - BOTTOM)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
           f'<text x="{LEFT}" y="20" font-size="15">{html.escape(title)}</text>']
    for decade in range(math.floor(low_x), math.ceil(high_x) + 1):
        for step in (1, 2, 5):
            x = step * 10.0**decade
            if low_x <= math.log10(x) <= high_x:
                out.append(f'<line x1="{place_x(x):.1f}" x2="{place_x(x):.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" stroke="#eee"/>'
                           f'<text x="{place_x(x):.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{short(x)}</text>')
    for decade in range(low_y, high_y + 1):
        y = place_y(10.0**decade)
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{10.0**decade:g}</text>')
    for k, (name, values) in enumerate(series.items()):
        colour = COLOURS[k % len(COLOURS)]
        at = [(place_x(x), place_y(y)) for x, y in values]
        if lines:
            out.append('<polyline fill="none" stroke="%s" stroke-width="2" points="%s"/>' %
                       (colour, " ".join(f"{x:.1f},{y:.1f}" for x, y in at)))
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{colour}"/>' for x, y in at]
        label = name
        if slopes and len(values) > 1 and values[0][0] < values[-1][0]:
            slope = math.log(values[-1][1] / values[0][1]) / math.log(values[-1][0] / values[0][0])
            label += f" (slope {slope:.2f})"
        y = TOP + 14 + 18 * k
        out.append(f'<rect x="{WIDTH - RIGHT + 10}" y="{y - 9}" width="10" height="10" fill="{colour}"/>'
                   f'<text x="{WIDTH - RIGHT + 25}" y="{y}" font-size="11">{html.escape(label)}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 10}" text-anchor="middle">{html.escape(x_label)}</text>'
               f'<text transform="translate(16 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">'
               f'{html.escape(y_label)}</text></svg>')
    return "\n".join(out) + "\n"


def plots(report):
    """Name -> SVG of everything the results allow."""
    results = [r for r in report["results"] if "size" in r]
    bench = [r for r in results if r["phase"] != "tool"]
    threads = max((r["threads"] for r in bench), default=1)
    first = bench[0].get("family") if bench else None
    faces = lambda r: r.get("faces", r["size"])

    def by(rows, name, x, y):
        series = {}
        for r in rows:
            if x(r) and y(r):
                series.setdefault(name(r), []).append((x(r), y(r)))
        return series

    kept = ("halfedges", "topology", "geometry", "connection", "assembly", "eigen", "field")
    times = [r for r in bench if r["phase"] in kept and r["threads"] == threads and r.get("family") == first and
             r.get("backend", "auto") == "auto" and r.get("n", 4) == 4 and r.get("detail", 1) == 1]
    strong = {}
    for r in bench:
        if r["phase"] in kept and r.get("family") == first and r.get("backend", "auto") == "auto" and \
                r["size"] == max(b["size"] for b in bench if b["phase"] == r["phase"]):
            strong.setdefault(f"{r['phase']} n={r['n']}" if "n" in r else r["phase"], []).append((r["threads"], r["seconds"]))
    # Weak scaling: work per thread held as near to constant as the sizes allow, as time per triangle and thread.
    weak = by([r for r in bench if r["phase"] in kept and r.get("family") == first and r.get("n", 4) == 4 and
               r.get("backend", "auto") == "auto" and r.get("detail", 1) == 1],
              lambda r: f"{r['phase']}, {r['threads']} thr.", lambda r: faces(r) / r["threads"],
              lambda r: 1e9 * r["seconds"] * r["threads"] / faces(r))
    triad = max((r.get("GB/s", 0) for r in report["results"] if r["phase"] == "triad"), default=0)
    peak = max((r.get("GFlop/s", 0) for r in report["results"] if r["phase"] == "peak"), default=0)
    roof = {}
    if triad and peak:
        grid = [2.0**k for k in range(-4, 7)]
        roof["roof: triad, peak"] = [(i, min(peak, i * triad)) for i in grid]
        # Flops and bytes per unit of work, counted from the code: a relaxed face and its edges (CG step), a triangle's
        # entries in double (about 150 flops for 16 numbers).
        for r in bench:
            if r["phase"] == "connection" and r.get("its") and r["threads"] == threads and r.get("family") == first \
                    and r.get("detail") == 1:
                work = faces(r) * r["its"]
                roof[f"connection {short(r['size'])}"] = [(240 / 390, 240 * work / r["seconds"] / 1e9)]
        for r in report["results"]:
            if r["phase"] == "kernels" and r.get("form") == "series" and r.get("family") == "double":
                roof[f"entries {r['isa']}"] = [(150 / 128, 150 / r["ns/triangle"])]
    drawn = {
        "time": log_plot("Wall seconds by size, %d threads, n = 4" % threads, "triangles", "seconds",
                         by(times, lambda r: r["phase"], faces, lambda r: r["seconds"]), slopes=True),
        "strong_scaling": log_plot("Strong scaling, largest mesh", "threads", "seconds", strong, slopes=True),
        "weak_scaling": log_plot("Thread time per triangle", "triangles per thread", "ns", weak),
        "backends": log_plot("Eigensolvers: time against residual, n = 4", "seconds", "residual",
                             by([r for r in bench if r["phase"] == "eigen" and r["threads"] == threads and r["n"] == 4],
                                lambda r: f"{r['backend']} {short(r['size'])}", lambda r: r["seconds"], lambda r: r["residual"]),
                             lines=False),
        "linear": log_plot("Linear backends: setup and solve by size", "triangles", "seconds",
                           by([r for r in bench if r["phase"].startswith("linear") and r["threads"] == threads],
                              lambda r: f"{r['phase'][7:]} {r['backend']}", faces, lambda r: r["seconds"]), slopes=True),
        "memory": log_plot("Peak memory of alcap field", "triangles", "MB",
                           by([r for r in results if r["phase"] == "tool"], lambda r: "peak", faces,
                              lambda r: r["peak_bytes"] / 1e6), slopes=True),
        "roofline": log_plot("Roofline", "flops per byte", "GFlop/s", roof),
    }
    return {name: svg for name, svg in drawn.items() if svg}
