"""Meshes the clouds of one topic:
ros2 launch pcl_spherical_param reconstruction.launch.py cloud:=/camera/depth/points"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def node(context):
    params = LaunchConfiguration('params').perform(context)
    return [Node(package='pcl_spherical_param', executable='spherical_param_node',
                 name=LaunchConfiguration('name'), output='screen',
                 parameters=[params] if params else [],
                 remappings=[('~/cloud', LaunchConfiguration('cloud'))])]


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('cloud', default_value='cloud',
                              description='topic of sensor_msgs/PointCloud2'),
        DeclareLaunchArgument('name', default_value='spherical_param',
                              description='name of the node'),
        DeclareLaunchArgument('params', default_value='',
                              description='YAML file of parameters; see doc/guide.md'),
        OpaqueFunction(function=node),
    ])
