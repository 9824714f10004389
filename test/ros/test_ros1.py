#!/usr/bin/python3
"""The nodes of ROS 1 with a real master, on a free port of this machine.

    test_ros1.py [Ros1.test_name...]

The environment must have the package: setup.bash of its install space, which is that of the first
example of doc/guide.md, below HOME. The meshes themselves are tested elsewhere.
"""

import contextlib
import os
import pathlib
import queue
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
DEPTH_CAMERA_FILE = ROOT / "src/ros/ros1/config/depth_camera.yaml"

with socket.socket() as probe:
    probe.bind(("localhost", 0))
    PORT = str(probe.getsockname()[1])
_folder = tempfile.TemporaryDirectory(prefix="spherical_param_ros")
os.environ.pop("ROS_IP", None)
os.environ.update(ROS_MASTER_URI=f"http://localhost:{PORT}", ROS_HOSTNAME="localhost", ROS_HOME=_folder.name)

import dynamic_reconfigure.client  # noqa: E402
import rosgraph  # noqa: E402
import rospy  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from pcl_msgs.msg import PolygonMesh  # noqa: E402
from pcl_spherical_param.srv import Reconstruct  # noqa: E402
from sensor_msgs.msg import PointCloud2, PointField  # noqa: E402
from shape_msgs.msg import Mesh  # noqa: E402
from std_msgs.msg import Header  # noqa: E402
from visualization_msgs.msg import Marker  # noqa: E402

POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<f4"), ("rgba", "<u4")])
# The commands of doc/guide.md, from tools/test_ros.sh.
DEPTH_CAMERA, RVIZ, SCANNER = (os.environ[name] for name in ("DEPTH_CAMERA", "RVIZ", "SCANNER"))
TIMEOUT = 120  # of steps that should take seconds [s]
# A reconstruction that would take weeks.
ENDLESS = ("_method:=paper", "_max_iterations:=2000000000", "_tolerance:=0.0")
processes = []


def start(*command, **options):
    process = subprocess.Popen(command, start_new_session=True, stdin=subprocess.DEVNULL, **options)
    processes.append(process)
    return process


def stop(process):
    """Ends a process and all that it started."""
    for how in (signal.SIGINT, signal.SIGKILL):
        with contextlib.suppress(ProcessLookupError, subprocess.TimeoutExpired):
            os.killpg(process.pid, how)
            process.wait(30)
    if process in processes:
        processes.remove(process)


def wait_for(condition, what):
    end = time.monotonic() + TIMEOUT
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"waited in vain for {what}")
        time.sleep(0.02)


def program(package, name):
    """Where rosrun would find it."""
    command = ["catkin_find", "--first-only", "--libexec", package, name]
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() or f"/usr/lib/{package}/{name}"


def bumpy(count, seed=1):
    """Points of a surface with bumps, with a number and a colour each; the first have alpha 0."""
    random = np.random.default_rng(seed)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    directions *= 1.0 + 0.2 * np.sin(2.0 * directions @ random.normal(size=(3, 1)))
    colors = random.integers(0, 1 << 32, count) & np.where(np.arange(count) < 20, 0xffffff, 0xffffffff)
    return np.rec.fromarrays([*directions.T, np.arange(count), colors], POINT).view(POINT, np.ndarray)


def message_of(points, number=0):
    fields = [PointField(name, POINT.fields[name][1], PointField.FLOAT32, 1) for name in POINT.names]
    return PointCloud2(header=Header(stamp=rospy.Time(12, number), frame_id="scanner"), fields=fields,
                       width=len(points), height=1, point_step=POINT.itemsize,
                       row_step=POINT.itemsize * len(points), data=points.tobytes())


def seen_by_a_camera(columns=160, number=0):
    """The cloud of a depth image: organized, in the camera's frame, a bowl before a wall, and pixels that saw nothing.
    From image to image the bowl moves."""
    y, x = (np.mgrid[:columns * 3 // 4, :columns] + 0.5) / (0.875 * columns) - np.reshape([3 / 7, 4 / 7], (2, 1, 1))
    from_centre = (x - 0.01 * number)**2 + y**2
    depth = np.where(from_centre < 0.04, 0.8 - from_centre, 2.0)
    depth[::17, ::13] = np.nan
    points = np.zeros((*depth.shape, 4), "<f4")
    points[..., :3] = np.stack([x, y, np.ones_like(x)], axis=-1) * depth[..., None]
    fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(("x", "y", "z", "rgb"))]
    header = Header(stamp=rospy.Time(12, number), frame_id="camera_depth_optical_frame")
    return PointCloud2(header=header, fields=fields, height=len(points),
                       width=points.shape[1], point_step=16, row_step=points[0].nbytes, data=points.tobytes())


def assert_mesh(test, mesh, cloud, points):
    """Triangles over all points; header and all fields are kept. Returns the triangles."""
    for header in (mesh.header, mesh.cloud.header):
        test.assertEqual((header.stamp, header.frame_id), (cloud.header.stamp, cloud.header.frame_id))
    test.assertEqual(mesh.cloud.fields, cloud.fields)
    test.assertEqual(np.frombuffer(mesh.cloud.data, POINT).tobytes(), points.tobytes())
    triangles = np.array([polygon.vertices for polygon in mesh.polygons])
    test.assertEqual(triangles.shape, (2 * len(points) - 4, 3))
    test.assertEqual(set(triangles.ravel().tolist()), set(range(len(points))))
    return triangles


class Watch:
    """The messages of a node."""

    def __init__(self, test, name="/spherical_param"):
        topics = {"mesh": (f"{name}/mesh", PolygonMesh), "shape": (f"{name}/shape", Mesh),
                  "marker": (f"{name}/marker", Marker), "diagnostics": ("/diagnostics", DiagnosticArray)}
        self.all = {topic: [] for topic in topics}
        for key, (topic, kind) in topics.items():
            test.addCleanup(rospy.Subscriber(topic, kind, self.all[key].append).unregister)

    def one(self, name):
        wait_for(lambda: self.all[name], name)
        return self.all[name][-1]

    def diagnosis(self):
        for message in reversed(list(self.all["diagnostics"])):
            for status in message.status:
                if "reconstruction" in status.name:
                    level = status.level[0] if isinstance(status.level, bytes) else status.level
                    return {"level": level, "summary": status.message} | {v.key: v.value for v in status.values}
        return {}

    def wait_until(self, expected):
        wait_for(lambda: expected.items() <= self.diagnosis().items(), expected)


class Ros1(unittest.TestCase):
    def setUp(self):
        # The master keeps parameters longer than a node lives.
        for name in ("/spherical_param", "/meshes"):
            if rospy.has_param(name):
                rospy.delete_param(name)
        self.addCleanup(lambda: [stop(process) for process in list(processes)])

    def run_node(self, *arguments, **options):
        node = program("pcl_spherical_param", "spherical_param_node")
        return start(node, "__name:=spherical_param", *arguments, **options)

    def run_nodelet(self, *arguments):
        return start(program("nodelet", "nodelet"), "standalone", "pcl_spherical_param/ReconstructionNodelet",
                     "__name:=spherical_param", *arguments)

    def service(self, name="/spherical_param"):
        rospy.wait_for_service(f"{name}/reconstruct", TIMEOUT)
        return rospy.ServiceProxy(f"{name}/reconstruct", Reconstruct, persistent=True)

    def run_example(self, example, **options):
        return start("bash", "-eo", "pipefail", "-c", example, **options)

    def publisher(self, name="/spherical_param/cloud"):
        publisher = rospy.Publisher(name, PointCloud2, queue_size=1000)
        self.addCleanup(publisher.unregister)
        wait_for(lambda: publisher.get_num_connections() == 1, f"a subscriber of {name}")
        return publisher

    def test_service_answers_good_and_bad_clouds(self):
        self.run_node()
        reconstruct = self.service()
        for number, count in enumerate((4, 20000, 100)):
            points = bumpy(count, number)
            cloud = message_of(points, number)
            answer = reconstruct(cloud)
            self.assertTrue(answer.success, answer.message)
            assert_mesh(self, answer.mesh, cloud, points)
        for cloud, cause in ((PointCloud2(), "empty"), (message_of(bumpy(3)), "4 distinct")):
            answer = reconstruct(cloud)
            self.assertFalse(answer.success or answer.mesh.polygons or answer.mesh.cloud.data)
            self.assertRegex(answer.message, f"{cause}.*; ")

    def test_topic_always_meshes_the_last(self):
        self.run_node()
        watch, publisher = Watch(self), self.publisher()
        for number in range(40):
            # Much work now and then, so that it is not done in time.
            points = bumpy(20000 if number % 10 == 0 else 300, number)
            cloud = message_of(points, number)
            publisher.publish(message_of(bumpy(3)) if number == 7 else cloud)
            time.sleep(0.01)
        wait_for(lambda: watch.one("mesh").header.stamp == cloud.header.stamp, "the last mesh")
        stamps = [mesh.header.stamp for mesh in watch.all["mesh"]]
        self.assertLess(len(stamps), 39)  # one cannot be meshed, and others come too fast
        self.assertEqual(stamps, sorted(stamps))
        assert_mesh(self, watch.one("mesh"), cloud, points)

    def test_mesh_shape_and_marker_agree_and_are_latched(self):
        self.run_node()
        early, points = Watch(self), bumpy(1000, 3)
        cloud = message_of(points)
        self.publisher().publish(cloud)
        early.one("marker")
        mesh, shape, marker = map(Watch(self).one, ("mesh", "shape", "marker"))  # later
        triangles = assert_mesh(self, mesh, cloud, points)
        np.testing.assert_array_equal([list(t.vertex_indices) for t in shape.triangles], triangles)
        expected = np.stack([points[axis] for axis in "xyz"], axis=1).astype(float)
        np.testing.assert_array_equal([[p.x, p.y, p.z] for p in shape.vertices], expected)
        self.assertEqual((marker.header, marker.type, marker.action), (mesh.header, Marker.TRIANGLE_LIST, Marker.ADD))
        self.assertEqual([marker.scale.x, marker.scale.y, marker.scale.z, marker.pose.orientation.w], [1.0] * 4)
        drawn = np.array([[p.x, p.y, p.z] for p in marker.points])
        np.testing.assert_array_equal(drawn, expected[triangles.ravel()])
        wanted = points["rgba"][triangles.ravel(), None] >> np.array([16, 8, 0, 24], np.uint32) & 255
        wanted[wanted[:, 3] == 0, 3] = 255  # many drivers leave alpha 0
        colors = [[c.r, c.g, c.b, c.a] for c in marker.colors]
        np.testing.assert_allclose(colors, wanted / 255, atol=1e-6)  # single precision
        # Outward: by the volume that the triangles enclose.
        self.assertGreater(np.linalg.det(drawn.reshape(-1, 3, 3)).sum(), 0.0)

    def test_parameters_change_while_it_runs(self):
        self.run_node("_smoothing:=3", "_time_limit:=60")
        reconstruct, points = self.service(), bumpy(500, 6)
        cloud = message_of(points)
        client = dynamic_reconfigure.client.Client("/spherical_param", timeout=TIMEOUT)
        self.addCleanup(client.close)
        self.assertLessEqual({"smoothing": 3, "time_limit": 60.0}.items(), client.get_configuration(TIMEOUT).items())
        self.assertNotEqual(reconstruct(cloud).mesh.cloud.data, cloud.data)
        client.update_configuration({"smoothing": 0})
        self.assertEqual(rospy.get_param("/spherical_param/smoothing"), 0)
        assert_mesh(self, reconstruct(cloud).mesh, cloud, points)
        client.update_configuration({"surface": "closed", "fill": "smooth"})
        bowl = points[points["z"] < 0.5]
        self.assertGreater(reconstruct(message_of(bowl)).mesh.cloud.width, len(bowl))  # vertices are added
        for name, value in (("method", "simplex"), ("outliers", "many"), ("damping", 2.0), ("k", 2)):  # refused
            client.update_configuration({name: value})
            self.assertNotEqual(client.get_configuration(TIMEOUT)[name], value)
        client.update_configuration({"outliers": "auto", "parts": "each", "min_points": 1000})
        self.assertIn("min_points = 1000 points; ", reconstruct(cloud).message)
        client.update_configuration({"max_points": 100})
        self.assertIn("max_points", reconstruct(cloud).message)

    def test_wrong_parameters_end_the_node_with_cause_and_remedy(self):
        for name, value in (("method", "simplex"), ("damping", "0.0"), ("k", "2"), ("threads", "many")):
            node = self.run_node(f"_{name}:={value}", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.assertRegex(node.communicate(timeout=TIMEOUT)[0], f"{name} = .*; use ")
            self.assertEqual(node.returncode, 1)
            rospy.delete_param("/spherical_param")

    def test_diagnostics_tell_state_and_result_though_simulated_time_stands_still(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        self.run_node("_topology:=sphere")
        watch, reconstruct, good = Watch(self), self.service(), bumpy(2000)
        for cloud, level, summary, result in (
                (message_of(good), 0, "idle", "done"),
                (message_of(good[good["z"] < 0.2]), 1, "the last mesh has faults", "done"),
                (message_of(bumpy(3)), 1, "the last cloud could not be meshed", "failed")):
            answer = reconstruct(cloud)
            watch.wait_until({"level": level, "summary": summary, "state": "idle", "waiting clouds": "0",
                              "last result": result, "last message": answer.message,
                              "last cloud [points]": str(cloud.width)})
            self.assertGreater(float(watch.diagnosis()["last time [s]"]), 0.0)

    def test_launch_file_starts_node_and_nodelet_with_parameters(self):
        parameters = {"surface": "open", "queue_depth": 4}
        file = pathlib.Path(_folder.name, "parameters.yaml")
        file.write_text("".join(f"{name}: {value}\n" for name, value in parameters.items()))
        manager = start(program("nodelet", "nodelet"), "manager", "__name:=manager")
        points = bumpy(300, 2)
        for words in ((), ("nodelet:=true",), ("nodelet:=true", "manager:=manager")):
            with self.subTest(words):
                launch = start("roslaunch", "pcl_spherical_param", "reconstruction.launch", "name:=meshes",
                               "cloud:=/scan/points", f"params:={file}", *words)
                reconstruct, watch = self.service("/meshes"), Watch(self, "/meshes")
                publisher, cloud = self.publisher("/scan/points"), message_of(points, len(words))
                assert_mesh(self, reconstruct(cloud).mesh, cloud, points)
                publisher.publish(cloud)
                assert_mesh(self, watch.one("mesh"), cloud, points)
                self.assertLessEqual(parameters.items(), rospy.get_param("/meshes").items())
                publisher.unregister()
                stop(launch)
                # A nodelet ends with its loader; the manager stays.
                state = rosgraph.Master("/test_ros1").getSystemState
                wait_for(lambda: "/meshes/reconstruct" not in dict(state()[2]), "the end")
                self.assertIsNone(manager.poll())

    def test_examples_of_the_page_mesh_and_show_what_a_depth_camera_sees(self):
        self.run_example(DEPTH_CAMERA)
        publisher, watch, cloud = self.publisher("/camera/depth/points"), Watch(self), seen_by_a_camera()
        end = threading.Event()
        self.addCleanup(end.set)

        def film():
            while not end.wait(0.1):
                cloud.header.stamp = rospy.Time.now()
                publisher.publish(cloud)

        threading.Thread(target=film, daemon=True).start()
        mesh = watch.one("mesh")
        self.assertEqual(mesh.header.frame_id, "camera_depth_optical_frame")
        layout = np.dtype({"names": "xyz", "formats": ["<f4"] * 3, "itemsize": mesh.cloud.point_step,
                           "offsets": [field.offset for field in mesh.cloud.fields[:3]]})
        points = np.frombuffer(mesh.cloud.data, layout)
        points = np.stack([points[axis] for axis in "xyz"], axis=1)
        # All points that the camera saw, and no triangle from the bowl to the wall.
        seen = np.frombuffer(cloud.data, "<f4").reshape(-1, 4)[:, :3]
        self.assertEqual(set(map(tuple, points)), set(map(tuple, seen[np.isfinite(seen[:, 2])])))
        is_of_bowl = points[:, 2] < 1.0
        corners = is_of_bowl[[polygon.vertices for polygon in mesh.polygons]].sum(axis=1)
        self.assertEqual(set(corners), {0, 3})
        self.assertEqual(watch.one("marker").header.frame_id, mesh.header.frame_id)
        watch.wait_until({"level": 0, "last result": "done"})

        screen = start("Xvfb", "-displayfd", "1", "-screen", "0", "800x600x24", stdout=subprocess.PIPE, text=True)
        self.run_example(RVIZ, env=dict(os.environ, DISPLAY=":" + screen.stdout.readline().strip()))
        state = rosgraph.Master("/test_ros1").getSystemState
        for topic in ("/camera/depth/points", "/spherical_param/marker"):
            wait_for(lambda t=topic: any("rviz" in node for node in dict(state()[1]).get(t, [])), f"RViz at {topic}")

    def test_example_of_the_page_meshes_the_clouds_of_a_topic(self):
        self.run_example(SCANNER)
        watch, points = Watch(self), bumpy(300, 2)
        cloud = message_of(points)
        self.publisher("/scan/points").publish(cloud)
        assert_mesh(self, watch.one("mesh"), cloud, points)

    def test_sequence_of_a_depth_camera_is_meshed_cloud_by_cloud_in_the_same_memory(self):
        rospy.set_param("/spherical_param", yaml.safe_load(DEPTH_CAMERA_FILE.read_text()))
        # malloc gives back what is freed, so that the memory is what is in use.
        node = self.run_node(env=os.environ | {"MALLOC_TRIM_THRESHOLD_": "131072"})

        def memory():  # [MB]
            status = pathlib.Path(f"/proc/{node.pid}/status").read_text()
            return int(re.search(r"VmRSS:\s*(\d+) kB", status)[1]) / 1024

        stamps = queue.Queue()
        # As bytes: Python takes longer to read a mesh than the node to make it.
        self.addCleanup(rospy.Subscriber("/spherical_param/mesh", rospy.AnyMsg, lambda mesh: stamps.put(
            Header().deserialize(mesh._buff).stamp)).unregister)
        clouds, publisher, after = [seen_by_a_camera(320, number) for number in range(30)], self.publisher(), []
        for some in clouds[:10], clouds[10:]:
            begin = time.monotonic()
            for cloud in some:
                publisher.publish(cloud)
                self.assertEqual(stamps.get(timeout=TIMEOUT), cloud.header.stamp)
            speed = len(some) / (time.monotonic() - begin)
            time.sleep(1.0)  # the node still sends the other messages
            after.append(memory())
        print(f"{speed:.1f} clouds of {cloud.width * cloud.height} points a second; {after[0]:.0f} MB after 10, "
              f"{after[1]:.0f} MB after 30")
        wait_for(lambda: memory() < 1.05 * after[0], "memory as after 10 clouds")

    def test_parameters_of_the_depth_camera_arrive_and_are_those_of_the_page(self):
        def parameters(*words):
            command = ["roslaunch", "--dump-params", "pcl_spherical_param", "reconstruction.launch",
                       "camera:=true", *words]
            return yaml.safe_load(subprocess.run(command, check=True, capture_output=True, text=True).stdout)

        text = DEPTH_CAMERA_FILE.read_text()
        self.assertIn(f"```yaml\n{text}```\n", (ROOT / "doc/guide.md").read_text())
        of_node = {f"/spherical_param/{name}": value for name, value in yaml.safe_load(text).items()}
        self.assertEqual(parameters(), of_node)
        file = pathlib.Path(_folder.name, "own.yaml")
        file.write_text("parts: each\n")
        self.assertEqual(parameters(f"params:={file}"), {"/spherical_param/parts": "each"})

    def test_ends_at_once_while_it_works_and_requests_wait(self):
        def call(reconstruct):
            with contextlib.suppress(rospy.ServiceException):  # the node ended
                reconstruct(message_of(bumpy(3000)))

        for run in (self.run_node, self.run_nodelet):
            with self.subTest(run):
                process, watch = run(*ENDLESS), Watch(self)
                for _ in range(3):
                    threading.Thread(target=call, args=(self.service(),), daemon=True).start()
                watch.wait_until({"state": "working", "waiting clouds": "2"})
                process.send_signal(signal.SIGINT)
                self.assertEqual(process.wait(TIMEOUT), 0)


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    master = start("roscore", "-p", PORT, stdout=subprocess.DEVNULL)
    processes.remove(master)  # not one of those that end with a test
    try:
        wait_for(rosgraph.is_master_online, "the master")
        rospy.init_node("test_ros1", disable_signals=True)
        result = unittest.main(verbosity=2, exit=False, warnings="ignore").result
        return int(not result.wasSuccessful() or bool(result.skipped) or result.testsRun == 0)
    finally:
        for process in processes + [master]:
            stop(process)
        rospy.signal_shutdown("done")
        _folder.cleanup()


if __name__ == "__main__":
    sys.exit(main())
