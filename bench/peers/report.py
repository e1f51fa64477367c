"""Tables and a page of what peers.py has measured. A row is a dictionary; see `measured` in peers.py.

Text goes between two comments of a file, `<!-- peers: NAME -->` and `<!-- peers end -->`, and replaces what stands there.
"""
import base64
import html
import math
import pathlib
import re
import struct
import zlib


def figures_of(value):
    """Three digits that count, and an exponent for what is very small alone."""
    return f"{value:.0f}" if abs(value) >= 99.95 else f"{value:.3g}"


def by_scene(rows):
    return {scene: sorted((row for row in rows if row["scene"] == scene), key=lambda row: -row["efficiency"])
            for scene in dict.fromkeys(row["scene"] for row in rows)}


def best_peer(rows):
    """The unbiased peer that Abbe is to be held against, of one scene."""
    peers = [row for row in rows if row["family"] not in ("Abbe", "yardstick") and not row["biased"]]
    return max(peers, key=lambda row: row["efficiency"], default=None)


def abbe_of(rows):
    return next((row for row in rows if row["family"] == "Abbe"), None)


def cells(row, abbe, best):
    ratio = figures_of(abbe["efficiency"] / row["efficiency"]) if abbe and row is not abbe else ""
    spread = "?" if math.isnan(row["spread"]) else f"{row['spread']:.2g}" if row["spread"] < 99.5 else f"{row['spread']:.0f}"
    return [row["scene"], row["renderer"] + (", biased" if row["biased"] else ""), str(row["samples"]), f"{row['core_seconds']:.1f}",
            f"{figures_of(row['efficiency'])} ± {spread}", figures_of(row["trimmed"]), f"**{ratio}**" if row is best else ratio,
            f"{100 * row['off']:.1f} %" if row is not abbe else "", f"{row['load_seconds']:.1f}", f"{row['first_seconds']:.1f}",
            f"{row['peak_mib']:.0f}" if row["peak_mib"] else "–"]


HEAD = ["scene", "renderer", "samples", "core-s", "efficiency", "trimmed", "Abbe ÷ this", "differs", "loading, s", "first picture, s",
        "peak MiB"]


def markdown_table(head, rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows]).replace("| --- ", "|---").replace("---|", "---|")


def table_rows(rows):
    made = []
    for here in by_scene(rows).values():
        made += [cells(row, abbe_of(here), best_peer(here)) for row in here]
    return made


def table(rows, missing=()):
    return markdown_table(HEAD, table_rows(rows)) + "".join(f"\n\nnot compared: {m}" for m in missing)


def about(run):
    versions = ", ".join(f"{name} {version}".strip() for name, version in run["versions"].items())
    return (f"{run['size']} × {run['size']} pixels, about {run['seconds']:g} core-seconds a render, {run['seeds']} seeds, one thread, "
            f"{run['date']}: {versions}.")


def short_table(rows, abouts):
    """The README's: a row for each scene, the best of each renderer; what is biased in brackets."""
    families = [f for f in dict.fromkeys(row["family"] for row in rows) if f != "yardstick"]
    made = []
    for scene, here in by_scene(rows).items():
        line = [f"{scene}: {abouts[scene]}"]
        best = max(row["efficiency"] for row in here if row["family"] != "yardstick" and not row["biased"])
        for family in families:
            of_it = sorted((row for row in here if row["family"] == family), key=lambda row: (row["biased"], -row["efficiency"]))
            text = figures_of(of_it[0]["efficiency"]) if of_it else "–"
            line.append(f"({text})" if of_it and of_it[0]["biased"] else f"**{text}**" if of_it and of_it[0]["efficiency"] == best else text)
        made.append(line)
    return markdown_table(["efficiency", *families], made)


def block(path, name):
    """The text of a file before, in and after its block. RuntimeError where the file has no place for it, or several."""
    path = pathlib.Path(path)
    parts = re.split(rf"(?<=<!-- peers: {re.escape(name)} -->\n)(.*?)(?=<!-- peers end -->)", path.read_text() if path.exists() else "",
                     flags=re.DOTALL)
    if len(parts) != 3:
        raise RuntimeError(f"{path} has {len(parts) // 2} places `<!-- peers: {name} -->` … `<!-- peers end -->`; it needs one")
    return parts


def write_block(path, name, text):
    """Writing the same twice changes nothing."""
    before, inside, after = block(path, name)
    if inside != f"\n{text.strip()}\n\n":
        pathlib.Path(path).write_text(f"{before}\n{text.strip()}\n\n{after}")


def png(width, height, rgb):
    """Of bytes, three a pixel."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    lines = b"".join(b"\0" + rgb[3 * width * y:3 * width * (y + 1)] for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(lines, 9))
            + chunk(b"IEND", b""))


STYLE = """:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; background: Canvas; color: CanvasText; margin: 2em auto; max-width: 84em; padding: 0 1em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .2em .7em; border-bottom: 1px solid color-mix(in srgb, CanvasText 25%, Canvas); text-align: right; white-space: nowrap; }
th:nth-child(-n+2), td:nth-child(-n+2) { text-align: left; }
.row { display: flex; flex-wrap: wrap; gap: 1em; }
figure { margin: 0; } figcaption { max-width: 256px; }
img { width: 256px; image-rendering: pixelated; display: block; }"""


def page(rows, missing, run, pictures, abouts, notes):
    """Self-contained HTML; `pictures` are PNGs by scene and renderer."""
    def line(values, tag):
        plain = (re.sub(r"\*\*(.*)\*\*", r"<b>\1</b>", html.escape(value)) for value in values)
        return "<tr>" + "".join(f"<{tag}>{value}</{tag}>" for value in plain) + "</tr>"
    parts = ["<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">",
             f"<title>Abbe beside other renderers</title><style>{STYLE}</style></head><body><h1>Abbe beside other renderers</h1>",
             f"<p>{html.escape(about(run))}</p><div class=\"wide\"><table>", line(HEAD, "th"), *(line(row, "td") for row in table_rows(rows)),
             "</table></div>", *(f"<p>{html.escape(note)}</p>" for note in notes), *(f"<p>Not compared: {html.escape(m)}</p>" for m in missing)]
    for scene, here in by_scene(rows).items():
        parts.append(f"<h2>{html.escape(scene)}</h2><p>{html.escape(abouts[scene])}; means of all seeds.</p><div class=\"row\">")
        for row in here:
            data = base64.b64encode(pictures[scene, row["renderer"]]).decode()
            name = html.escape(row["renderer"])
            parts.append(f"<figure><img alt=\"{name}\" src=\"data:image/png;base64,{data}\"><figcaption>{name}: {figures_of(row['efficiency'])}"
                         "</figcaption></figure>")
        parts.append("</div>")
    return "\n".join(parts) + "</body></html>\n"
