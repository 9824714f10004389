"""Scans as sensors make them: of one place, of several places merged, and real ones; ours and the peers'."""

from .clouds import OTHERS, ROWS, Row, load
from .comparison import FRONT, ORGANIZED, PARAMETERS, compare, find_peers, summarize
from .quality import Mesh

VIEW_PEERS = (FRONT, ORGANIZED, "PCL greedy projection", "Open3D ball pivoting", "Open3D Poisson")
MERGED_PEERS = (FRONT, "PCL Poisson", "Open3D Poisson")
# Scans, quick and in full.
SCENES = (("desk_5000",), ("desk", "yard", "town", "jaw"))
SHAPES = (("animal_2000",), ("animal_20000", "hand_20000", "bird_20000", "head_20000", "chair_20000"))
NOISES = ((0.5,), (0.5, 1.5))  # along the rays [spacings]
CAMERAS = 8
TIMEOUT = 300.0  # seconds of a method

VIEWS = [("model", "scan"), ("points", "points"), ("method", "method"), ("used", "points kept [%]", 2),
         ("intersections", "self-intersections"), ("rms", "RMS [%]", 3), ("bridges", "bridges [%]", 2),
         ("seconds", "time [s]", 2), ("megabytes", "memory [MB]", 0), ("failure", "remark")]  # fmt: skip
MERGED = [("shape", "scan"), ("noise", "noise [spacings]"), ("points", "points"), ("method", "method"),
          ("right", "pieces and handles right"), ("intersections", "self-intersections"), ("rms", "RMS [%]", 3),
          ("hausdorff", "Hausdorff [%]", 2), ("normals", "normals off by [deg]", 1), ("seconds", "time [s]", 2),
          ("failure", "remark")]  # fmt: skip
SUMMARY = [("method", "method"), ("clouds", "scans"), ("meshes", "meshes"), ("right", "pieces and handles right"),
           ("whole", "meshes without self-intersections"), ("used", "points kept (median) [%]", 1),
           ("bridges", "bridges (median) [%]", 1), ("rms", "RMS, times ours (median)", 2),
           ("seconds", "time, times ours (median)", 2), ("megabytes", "memory, times ours (median)", 2)]  # fmt: skip
SCANS = [("model", "cloud"), ("points", "points"), ("method", "method"), ("view", "seen from one place"),
         ("sound", "sound by our verdict"), ("used", "points used [%]", 2), ("parts", "parts"),
         ("openings", "openings"), ("genus", "handles"), ("intersections", "self-intersections"),
         ("seconds", "time [s]", 2), ("failure", "remark")]  # fmt: skip


def _views(context, parameters):
    rows, peers = [], find_peers(context, VIEW_PEERS)
    for name in context.choose(*SCENES):
        context.say(f"views: {name}")
        compared = compare(context, context.programs.view(name), peers, parameters, repeats=context.choose(1, 3),
                           timeout=TIMEOUT)  # fmt: skip
        rows += [row for row, _ in compared]
    context.report.text("""
        ### Seen from one place

        Generated scans of a depth camera, a scanner on a tripod, an airborne and a structured-light scanner, with the
        noise of such sensors. All methods get the points alone, in the frame of the sensor, but for the organized mesh,
        which gets the image. The truth is what the sensor sees, without noise. *Bridges*: area of the mesh that is
        farther than three spacings from the truth, in percent of the area of the truth. The spacing is that of the
        sensor's rays at the nearest place of the truth: the side of a square with the area between four neighbouring
        rays.""")
    _tables(context, "views", VIEWS, rows, ("right",))


def _merged(context, parameters):
    rows, peers = [], find_peers(context, MERGED_PEERS)
    for name in context.choose(*SHAPES):
        for noise in context.choose(*NOISES):
            context.say(f"merged: {name}, noise {noise}")
            cloud = context.programs.scan(name, noise, views=CAMERAS)
            truth = context.programs.referee.topology(Mesh.read(cloud.truth))
            compared = compare(context, cloud, peers, parameters, repeats=context.choose(1, 3), timeout=TIMEOUT)
            for row, _ in compared:
                right = all(row.get(key) == truth[key] for key in ("parts", "genus"))
                rows.append({**row, "shape": name.split("_")[0], "noise": noise, "right": right})
    context.report.text(f"""
        ### Merged of {CAMERAS} views

        What {CAMERAS} cameras around an object see, merged: noise along the rays, and half as much error of registration
        of each camera. The truth is the whole object.""")
    _tables(context, "merged", MERGED, rows, ("used", "bridges"))


def _tables(context, name, columns, rows, without):
    summary = [column for column in SUMMARY if column[0] not in without]
    context.report.table(f"{name}_summary", summary, summarize(rows))
    context.report.table(name, columns, rows)


def _scans(context, parameters):
    """All real scans by default options, beside the fastest peer."""
    real = [row for row in ROWS if row.source] + OTHERS
    real += [Row(path.stem, source=str(path)) for path in context.scans]
    rows = []
    for row in context.choose([row for row in ROWS if row.name == "rabbit"], real):
        context.say(f"scans: {row.name}")
        compared = compare(context, load(context, row), find_peers(context, [FRONT]), parameters, timeout=TIMEOUT)
        rows += [found for found, _ in compared]
    context.report.text("""
        ### Real scans

        By default options. *Seen from one place* and *sound* are our own verdict, the referee counts all else. Handles
        are those of all parts, `-` if the mesh is not manifold and oriented.""")
    context.report.table("scans", SCANS, rows)


def section(context):
    parameters = {}
    _views(context, parameters)
    _merged(context, parameters)
    _scans(context, parameters)
    context.report.text("### Parameters")
    context.report.table("views_peers", PARAMETERS, list(parameters.values()))
