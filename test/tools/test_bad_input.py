"""Mistakes of users: each must end with the right exit code, one line of cause and one of remedy, and leave the folder
as it was."""

import os
import pathlib
import resource
import unittest

import numpy as np
from tool_test import Mesh, ToolTest, call, ellipsoid, limited, run, write, write_ply, write_xyz

FAILED, WRONG_USAGE = 1, 2


def full_disk(size):
    return limited(resource.RLIMIT_FSIZE, size)


class BadInput(ToolTest):
    def setUp(self):
        super().setUp()
        write_xyz("in.xyz", ellipsoid(500))
        write_ply("in.ply", ellipsoid(20))
        write("kept.ply", "kept")

    def check_ends_refused(self, rows):
        """Beginnings of command lines, each with ends that are wrong and their causes."""
        for line, ends in rows.items():
            self.check_refused(WRONG_USAGE, {f"{line} {end}": cause for end, cause in ends.items()})

    def check_output_refused(self, rows):
        # It must exist: a missing device is not to be replaced by a file of that name.
        with open("/dev/full", "r+b", buffering=0) as full:
            self.check_refused(FAILED, rows, stdout=full)

    def test_mistakes_that_every_tool_refuses(self):
        for tool, others in (("reconstruction", ""), ("remesh", ""), ("morph", " in.ply"), ("texture", "")):
            inputs = f"{tool} in.xyz{others}"
            line = f"{inputs} out.ply"
            self.check_refused(WRONG_USAGE, {
                tool: " file is missing",
                inputs: "the output file is missing",
                f"{line} b.ply": "one file too many: 'b.ply'",
                f"{tool} in.foo{others} out.ply": "'in.foo' has an extension",
                f"{tool} in.glb{others} out.ply": "'in.glb' is glTF",
                f"{inputs} out.pcd": "'out.pcd' has an extension",
                f"{inputs} in.xyz": "an extension",
                f"{line} -quite": "unrecognised option '-quite'",
                f"{line} -k 2": "option -k: '2' is not allowed",
                f"{line} -json ''": "option -json: the name of the file is empty",
                f"{line} -json in.xyz": "'in.xyz' would overwrite 'in.xyz'",
                f"{line} -columns x,y": "has no x, y and z",
                f"{line} -quiet -verbose": "exclude each other",
            })  # fmt: skip
            self.check_refused(FAILED, {
                f"{tool} no.xyz{others} out.ply": "cannot read 'no.xyz': No such file",
                f"{inputs} no/out.ply": "missing directory",
                f"{line} -json no/r.json": "missing directory",
            })  # fmt: skip
            self.check_refused(FAILED, {f"{line} -quiet": "File too large"}, **full_disk(4000))
            self.check_output_refused({f"{line} -json -": "standard output", f"{tool} -h": "standard output"})

    def test_formats_that_are_not_read_are_named_with_a_command_that_converts_them(self):
        write("in.dat", "LASF" + 9 * "\0")
        for names, kind, command in (("in.las in.LAZ in.dat", "LA", "pdal translate"),
                                     ("in.e57", "E57", "CloudCompare"),
                                     ("in.ptx", "PTX", "CloudCompare"),
                                     ("in.gii", "GIfTI", "mris_convert"),
                                     ("in.glb", "glTF", "assimp export"),
                                     ("in.vtk", "VTK", "pcl_vtk2pcd"),
                                     ("in.ply.gz", "compressed by gzip", "gunzip"),
                                     ("in.zip", "a ZIP archive", "unzip"),
                                     ("in.bag", "a bag of ROS", "rosrun pcl_ros bag_to_pcd"),
                                     ("in.mcap in.db3", "a bag of ROS 2", "ros2 bag play")):  # fmt: skip
            for name in names.split():
                said = run("reconstruction", name, "out.ply", code=WRONG_USAGE)
                self.assertIn(f" is {kind}", said)
                self.assertIn(f"\n  remedy: convert it: {command} ", said)

    def test_files_that_make_no_sense_are_refused(self):
        os.symlink("in.ply", "link.ply")
        os.link("in.ply", "hard.ply")
        self.check_ends_refused({
            "reconstruction": {"'in\n.las' out.ply": "'in?.las'", "- out.ply": "'-' has no extension",
                               "in.ply link.ply": "would overwrite", "in.ply hard.ply": "would overwrite"},
            "reconstruction in.xyz": {
                "out": "'out' has no extension", "out.ply -sphere ''": "-sphere",
                "./a.obj -sphere a.obj": "would overwrite", "out_%03d.ply -parts all": "is a pattern for several parts",
                "out.ply -sphere s%03d.ply": "is a pattern, but the output is one file",
                "out_%03d.ply -json j_%03d.json": "is a pattern, but one report has all parts"},
            "scan": {"": "the shape is missing", "sphere": "the output file", "cube out.pcd": "unknown shape 'cube'",
                     "sphere out.stl": "extension", "sphere out.ply -truth ./out.ply": "would overwrite"},
            "remesh in.xyz": {"out.png": "out.png", "out.pcd": "out.pcd",
                              "out.ply -harmonics ''": "-harmonics", "out.ply -harmonics out.ply": "would overwrite"},
            "morph in.ply in.xyz": {
                **{f"{name}.ply": "% that is not a frame number" for name in ("m_%s", "m_%d_%d", "m_%12d", "m_%%")},
                "m.ply -pairs ''": "-pairs", "m.ply -json m_001.ply": "would overwrite"},
            "morph in.ply m_001.ply": {"m.ply": "would overwrite"},
            "texture in.ply": {
                "in.ply": "would overwrite", "out.ply -json out.png": "would overwrite",
                "out.glb -image out.png": "-image", "out.obj -image out.jpg": "out.jpg",
                "out.obj -image 'a b.png'": "a b.png", "'a b.obj'": "a b", "out.ply -image 'a\nb.png'": "a?b.png"},
        })  # fmt: skip

    def test_options_that_make_no_sense_are_refused(self):
        self.check_ends_refused({
            "reconstruction in.xyz out.ply": {
                "-view 1,2": "option -view: '1,2'", "-view 1,2,inf": "option -view: '1,2,inf'",
                "-ki 5": "'-ki'", "-quiet=1": "-quiet", "-x -- -k": "'-x'", "-k": "missing",
                "-k -quiet": "has no value", "-k 5 -k 6": "more than once",
                "-damping ''": "option -damping: ''",
                "-method ball": "option -method: 'ball'", "-outliers 1001": "option -outliers: '1001'",
                "-parts each -min-points 3": "-min-points"},
            "scan sphere out.pcd": {
                "more": "one word too many: 'more'", "-points 3": "option -points: '3'",
                "-seed -1": "option -seed: '-1'"},
            "remesh in.xyz out.ply": {
                "-grid cubic": "'cubic' is not allowed", "-points 3": "-points", "-map-sweeps 1001": "-map-sweeps",
                "-harmonics c.json -degree 513": "-degree"},
            "morph in.ply in.xyz m.ply": {
                "-frames 1": "-frames", "-align yes": "option -align: 'yes'",
                "-connectivity resampled -samples 11": "-samples"},
            "texture in.ply out.glb": {
                "-chart mercator": "mercator", "-size 15": "-size", "-gutter 257": "-gutter", "-checker 0": "-checker"},
        })  # fmt: skip

    def test_numbers_are_the_whole_text_and_in_their_range(self):
        for option, texts in (("-k", "25.5 99999999999999999999"), ("-tolerance", "-1e-9 nan inf 1e999")):
            for text in ("+-1", "1x", " 1", "0x5", *texts.split()):
                self.check_refused(WRONG_USAGE, {
                    f"reconstruction in.xyz out.ply {option} '{text}'": f"{option}: '{text}' is not allowed"})  # fmt: skip

    def test_unknown_options_are_answered_with_the_nearest(self):
        for word, nearest in (("-quite", "-quiet"), ("--seeds=x", "-seed"), ("-verson", "-version")):
            said = run("reconstruction", "in.xyz", "out.ply", word, code=WRONG_USAGE)
            self.assertIn(f"\n  remedy: did you mean {nearest}? ", said)

    def test_options_that_do_nothing_are_refused(self):
        self.check_ends_refused({
            "reconstruction in.xyz out.ply": {
                "-max-iterations 5": "-max-iterations does nothing with -method default",
                "-min-points 60 -topology sphere": "-min-points does nothing with -parts all",
                "-time-limit 1 -method paper": "-time-limit does nothing with -method paper"},
        })  # fmt: skip
        for line, options in {
            "remesh in.xyz out.ply": ["-degree 5", "-area-weight 1 -map-sweeps 0"],
            "morph in.ply in.xyz m.ply": ["-samples 100"],
            "texture in.ply out.glb": ["-ascii"],
        }.items():  # fmt: skip
            self.check_ends_refused({line: {words: f"{words.split()[0]} does nothing with " for words in options}})

    def test_meshes_with_handles_have_no_map_to_one_sphere(self):
        run("scan", "torus", "torus.xyz", "-points", 1500)
        write_xyz("both.xyz", ellipsoid(2000, (1, 1, 1), (9, 0, 0)), np.loadtxt("torus.xyz"))
        # A field of 18 x 18 points, of which 3 x 3 each are 0, 2.5 or 5 high, without walls.
        row, column = np.divmod(np.arange(324), 18)
        x, y = column + 0.5 * (row % 2), 0.75**0.5 * row
        i, j = np.minimum(x // 3, 5), y // 3
        write_xyz("tangle.xyz", np.stack([x, y, 2.5 * ((i * i + 2 * j * j + i * j) % 3)], axis=1))
        cause = "'torus.xyz' has no map to one sphere: its mesh has 1 handle"
        self.check_refused(FAILED, {
            "reconstruction torus.xyz out.ply -sphere s.ply": cause,
            "reconstruction both.xyz out%03d.ply -parts each -sphere s%03d.ply":
                "part 2 of 'both.xyz' has no map to one sphere",
            "remesh torus.xyz out.ply -handles auto": cause,
            "texture torus.xyz out.glb": cause,
            "morph in.xyz torus.xyz out.ply -handles auto": cause,
            "reconstruction tangle.xyz out.ply -sphere s.ply":
                "'tangle.xyz' has no map to one sphere: it is a tangle",
        })  # fmt: skip
        call("reconstruction", "torus.xyz", "out.ply", "-sphere", "s.ply", "-handles", "none", "-time-limit", 0)
        self.check_sphere(Mesh("s.ply"))
        said = call("morph", "torus.xyz", "torus.xyz", "m.ply", "-frames", 2).stderr
        self.assertRegex(said, "1 handle, cut: the mesh is a sphere\n")  # without an option that the tool refuses

    def test_files_that_cannot_be_read_are_a_failure(self):
        write("three.xyz", "1 0 0\n0 1 0\n0 0 1\n1 0 0\nnan 1 1\n1e999 1 1\n")
        write("flat.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n")
        write("outliers.xyz", "0 0 0\n.1 0 0\n0 .1 0\n9 9 9\n-9 9 0\n")
        os.mkdir("folder.ply")
        os.mkfifo("pipe.ply")
        self.check_refused(FAILED, {
            "reconstruction folder.ply out.ply": "is a directory",
            "reconstruction pipe.ply out.ply": "not a regular file",
            "reconstruction three.xyz out.ply": "at least 4",
            "reconstruction in.xyz out.ply -parts each -min-points 501": "no part has min_points = 501",
            "reconstruction in.xyz out.ply -view 9,0,0 -smoothing 5": "smoothing cannot be used with a view",
            "reconstruction flat.xyz out.ply -topology sphere":
                "cannot mesh 'flat.xyz': all points lie in one plane",
            "reconstruction outliers.xyz out.ply -topology sphere -outliers 0":
                "all points lie in one plane (left out: 1 stray point)",
            "remesh flat.xyz out.ply": "cannot mesh 'flat.xyz'",
            "morph in.ply flat.xyz m.ply": "cannot mesh 'flat.xyz'",
        })  # fmt: skip

    def test_pairs_that_make_no_sense_are_refused_with_their_line(self):
        for text, cause in (("", "is empty"),
                            ("1 2\n1\n", "line 2: 1 word make"),
                            ("1 2 3 4 5 6 7", "line 1"),
                            ("\n\n1 two", "line 3: words like 'two'"),
                            ("20 2", "unknown point '20' in a cloud of 20"),
                            ("2 -1", "unknown point '-1' in a cloud of 500"),
                            ("1 2 3 4 5 nan", "line 1")):  # fmt: skip
            write("pairs.txt", text)
            self.check_refused(FAILED, {"morph in.ply in.xyz m.ply -pairs pairs.txt -quiet": cause})

    def test_files_that_cannot_be_written_are_a_failure_before_the_work(self):
        os.mkdir("folder.ply")
        os.symlink("missing/out.ply", "dangling.ply")
        self.check_refused(FAILED, {
            "reconstruction in.xyz folder.ply": "is a directory",
            "reconstruction in.xyz dangling.ply": "missing directory",
            "remesh in.xyz out.ply -harmonics no/c.json": "missing directory",
            "texture in.ply out.ply -image no/out.png": "missing directory",
        })  # fmt: skip

    def test_files_without_rights_are_a_failure(self):
        unprivileged = {"user": 65534} if os.geteuid() == 0 else {}
        try:
            run("reconstruction", "-version", **unprivileged)
        except PermissionError:
            self.skipTest("the tool is in a place that root alone may enter")
        os.mkdir("closed", 0o555)
        write("secret.xyz", "1 2 3\n")
        pathlib.Path("secret.xyz").chmod(0)
        pathlib.Path("kept.ply").chmod(0o444)
        lines = "secret.xyz out.ply", "in.xyz closed/out.ply", "in.xyz kept.ply"
        self.check_refused(FAILED, {f"reconstruction {line}": "Permission denied" for line in lines}, **unprivileged)

    def test_a_full_disk_or_standard_output_is_a_failure_and_keeps_the_old_file(self):
        full = ": File too large"
        # Each size is too small for the file that the message names.
        for size, rows in ((4000, {"reconstruction in.xyz kept.ply": f"cannot write 'kept.ply'{full}",
                                   "texture in.ply a.obj -size 256": full,
                                   "texture in.ply a.glb -size 256": full,
                                   "scan sphere kept.ply": full}),
                           (15000, {"remesh in.xyz kept.ply -harmonics c.json": full}),
                           (30000, {"reconstruction in.xyz kept.ply -sphere s.stl": f"cannot write 's.stl'{full}",
                                    "reconstruction in.xyz kept.ply -json r.json -method paper -tolerance 0":
                                        f"cannot write 'r.json'{full}"})):  # fmt: skip
            self.check_refused(FAILED, rows, **full_disk(size))
        self.check_output_refused({"reconstruction in.xyz kept.ply": "standard output",
                                   "scan sphere out.pcd -points 99": "standard output"})  # fmt: skip
