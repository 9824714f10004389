"""Meshes the clouds of a topic:
ros2 launch pcl_spherical_param reconstruction.launch.py cloud:=/scan/points
With camera:=true they come from a depth camera, in the camera's own frame."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ARGUMENTS = {
    'cloud': ('cloud', 'topic of sensor_msgs/PointCloud2'),
    'name': ('spherical_param', 'name of the node'),
    'camera': ('false', 'true: with config/depth_camera.yaml'),
    'params': ('', 'YAML file of parameters; see doc/guide.md'),
}


def nodes(context):
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    params = given['params']
    if given['camera'].lower() == 'true':
        params = params or str(Path(__file__).parents[1] / 'config' / 'depth_camera.yaml')
    return [Node(package='pcl_spherical_param', executable='spherical_param_node', name=given['name'], output='screen',
                 parameters=[params] if params else [], remappings=[('~/cloud', given['cloud'])])]


def generate_launch_description():
    arguments = [DeclareLaunchArgument(name, default_value=value, description=description)
                 for name, (value, description) in ARGUMENTS.items()]
    return LaunchDescription([*arguments, OpaqueFunction(function=nodes)])
