#!/usr/bin/python3
"""The launch file of ROS 2 with a stand-in for launch and launch_ros, which Debian does not have.

It shows that the file runs and connects the cloud to the node. It does not show that the real packages take its calls.
"""

import importlib.util
import pathlib
import sys
import types
import unittest

import yaml

ROS2 = pathlib.Path(__file__).resolve().parents[2] / "src/ros/ros2"


class Call:
    """A call of the launch API: its name and what it was given."""

    def __init__(self, call, *values, **options):
        self.call, self.values, self.options = call, values, options

    def __getattr__(self, name):
        return self.options[name]

    def perform(self, arguments):  # of a LaunchConfiguration
        return arguments[self.values[0]]


class StandIn(types.ModuleType):
    def __getattr__(self, name):
        return lambda *values, **options: Call(name, *values, **options)


for module in ("launch", "launch.actions", "launch.substitutions", "launch_ros", "launch_ros.actions"):
    sys.modules[module] = StandIn(module)


def launch(**arguments):
    """The node that the launch file starts."""
    spec = importlib.util.spec_from_file_location("launch_file", ROS2 / "launch/reconstruction.launch.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    *declared, nodes = module.generate_launch_description().values[0]
    defaults = {argument.values[0]: argument.default_value for argument in declared}
    assert arguments.keys() <= defaults.keys(), arguments
    node, = nodes.function(defaults | arguments)
    assert node.call == "Node"
    return node


class Launch(unittest.TestCase):
    def test_a_depth_camera_has_its_parameters_and_is_shown(self):
        node = launch(camera="true", cloud="/camera/depth/points")
        self.assertEqual(node.remappings, [("~/cloud", "/camera/depth/points")])
        self.assertEqual(node.parameters, [str(ROS2 / "config/depth_camera.yaml")])
        self.assertEqual(launch(camera="true", params="own.yaml").parameters, ["own.yaml"])
        shown = yaml.safe_load((ROS2 / "config/reconstruction.rviz").read_text())["Visualization Manager"]["Displays"]
        self.assertEqual({display["Topic"]["Value"] for display in shown},
                         {"/camera/depth/points", f"/{node.name}/marker"})

    def test_the_node_alone_needs_no_file_of_parameters(self):
        node = launch(cloud="/scan")
        self.assertEqual((node.parameters, node.remappings), ([], [("~/cloud", "/scan")]))

    def test_parameters_are_those_of_ros_1(self):
        own, of_ros1 = (yaml.safe_load((ROS2.parent / ros / "config/depth_camera.yaml").read_text())
                        for ros in ("ros2", "ros1"))
        self.assertEqual(own, {"/**": {"ros__parameters": of_ros1}})


if __name__ == "__main__":
    unittest.main()
