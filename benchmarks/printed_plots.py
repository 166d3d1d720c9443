"""How long the plots of a printed sheet take: our canvas beside matplotlib, cold and warm.

``python -m benchmarks.printed_plots RECORD`` prints processor time of one thread [s].
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from time import process_time

from mtcommission.export.write import type_in
from mtcommission.record.record import load_record
from mtcommission.sheet.content import compose
from mtcommission.sheet.document import LinePlot
from mtcommission.sheet.figures import LIMIT, LINES

HEIGHT = 90.0
"""Of a panel [pt]."""


def by_canvas(plot: LinePlot) -> bytes:
    from mtcommission.sheet.figures import draw_svg

    return draw_svg(plot, panel_height=HEIGHT).encode()


def by_matplotlib(plot: LinePlot) -> bytes:
    """The same curves, borders, labels and legend, as SVG with text as text."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    count = len(plot.panels)
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "sheet", "font.size": 8.0}):
        figure = Figure(figsize=(493.2 / 72, (count * (HEIGHT + 13.0) + 40.0) / 72))
        axes = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
        for panel, pair in zip(plot.panels, axes, strict=True):
            for line in panel.lines:
                color, dashes, width = LINES[line.style]
                style = (0, dashes) if dashes else "-"
                drawn = "steps-post" if line.is_stepped else "default"
                pair.plot(line.x, line.y, color=color, ls=style, lw=width, label=line.label,
                          drawstyle=drawn)  # fmt: skip
            for border in panel.borders:
                pair.axhline(border.y, color="k", ls=(0, LIMIT[1]), lw=0.7)
            pair.set_title(panel.y_label, loc="left", fontsize=8.0)
            pair.grid(visible=True)
        if plot.x_is_log:
            axes[0].set_xscale("log")
        axes[-1].set_xlabel(plot.x_label)
        axes[0].legend(loc="upper right", bbox_to_anchor=(1.0, 1.4), ncols=4)
        stream = BytesIO()
        figure.savefig(stream, format="svg", metadata={"Date": None})
    return stream.getvalue()


def measure(draw: Callable[[LinePlot], bytes], plots: list[LinePlot]) -> str:
    times = []
    for _ in range(3):
        begun = process_time()
        pictures = [draw(plot) for plot in plots]
        times.append(process_time() - begun)
    size = sum(map(len, pictures)) / 1e3
    return f"cold {times[0]:.3f} s, warm {min(times):.3f} s, {size:.0f} kB"


def main() -> None:
    path, *which = sys.argv[1:]
    if not which:  # each in a process of its own, so that none finds the other's modules loaded
        for draw in (by_canvas, by_matplotlib):
            command = [sys.executable, "-m", "benchmarks.printed_plots", path, draw.__name__]
            subprocess.run(command, check=True)
        return
    record = load_record(Path(path))
    document = compose(record, type_in(record))
    plots = [b for s in document.pages for b in s.blocks if isinstance(b, LinePlot)]
    print(f"{which[0]}: {len(plots)} plots, {measure(globals()[which[0]], plots)}")


if __name__ == "__main__":
    main()
