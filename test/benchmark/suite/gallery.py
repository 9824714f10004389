"""What each method makes of real and generated clouds, side by side. doc/gallery/README.md describes them."""

import draw

from .clouds import ROWS, load
from .comparison import FRONT, ORGANIZED, compare, find_peers

PEERS = (ORGANIZED, "PCL Poisson", "PCL greedy projection", "Open3D ball pivoting")
FIRST = "desk", (FRONT, "PCL Poisson")  # on README's first picture
COLUMNS = [("cloud", "cloud"), ("method", "method"), ("triangles", "triangles"), ("boundary", "boundary edges"),
           ("crowded", "edges of three or more triangles"), ("sphere", "closed, manifold, genus 0"),
           ("intersections", "self-intersections"), ("used", "points used [%]", 1), ("bridges", "bridges [%]", 1),
           ("seconds", "time [s]", 1), ("failure", "remark")]  # fmt: skip
CAPTION = ("{method}: {triangles:,} triangles\n"
           "{boundary:,} boundary edges, {intersections:,} self-intersections")  # fmt: skip
PIXELS = 360  # of each picture


def _drawn(path, row, view):
    """What draw.draw() takes: a cloud or a mesh, turned so that z points up."""
    points, _, triangles = draw.read_ply(path)
    order, signs = row.axes
    return {"points": points[:, order] * signs, "triangles": triangles, "view": view, "edges": False, "back": True,
            "colors": None}  # fmt: skip


def _draw(path, row, cloud, compared, columns=None):
    pictures = [_drawn(cloud.points, row, row.seen or row.view)]
    captions = [f"{len(pictures[0]['points']):,} points\n"]
    for one, mesh in compared:
        if mesh:
            pictures.append(_drawn(mesh, row, row.view))
            captions.append(CAPTION.format(**one))
    columns = columns or len(pictures)
    draw.draw(path, pictures, (PIXELS * columns, PIXELS * -(-len(pictures) // columns)), captions, columns)


def section(context):
    folder, report, parameters, all_rows = context.out / "gallery", context.report, {}, []
    folder.mkdir(exist_ok=True)
    for row in context.choose([row for row in ROWS if row.name == "rabbit"], ROWS):
        context.say(f"gallery: {row.name}")
        cloud = load(context, row)
        compared = compare(context, cloud, find_peers(context, PEERS), parameters, row.options.split(), timeout=120.0)
        all_rows += [{"cloud": row.name, **one} for one, _ in compared]
        _draw(folder / f"{row.name}.png", row, cloud, compared, 3 if row.seen else None)
        report.text(f"![{row.name}: the cloud and the mesh of each method](gallery/{row.name}.png)")
        if row.name == FIRST[0]:
            _draw(folder / "front.png", row, cloud, compare(context, cloud, find_peers(context, FIRST[1]), {}))
    report.table("gallery", COLUMNS, all_rows)
    report.blocks["gallery_provenance"] = report.blocks["provenance"]
    report.blocks["gallery_parameters"] = "".join(
        f"- {one['method']}: {one['library']}: {one['parameters']}\n" for one in parameters.values())
