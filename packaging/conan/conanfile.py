"""Conan 2 package of the checkout that this file lies in."""

import os
import re

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir

required_conan_version = ">=2.4"


class PclSphericalParam(ConanFile):
    name = "pcl_spherical_param"
    description = "Meshes of point clouds by spherical parameterisation"
    license = "BSD-3-Clause"
    topics = ("point cloud", "surface reconstruction", "mesh", "parameterisation")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {
        "shared": [True, False],
        "fPIC": [True, False],
        "with_pcl": [True, False],
        "with_tools": [True, False],
    }
    default_options = {"shared": False, "fPIC": True, "with_pcl": True, "with_tools": False}
    implements = ["auto_shared_fpic"]

    def set_version(self):
        sources = os.path.join(self.recipe_folder, "..", "..")
        found = re.search(r"^project\(.* VERSION ([0-9.]+)", load(self, os.path.join(sources, "CMakeLists.txt")), re.M)
        self.version = found[1]

    def export_sources(self):
        sources = os.path.join(self.recipe_folder, "..", "..")
        for pattern in ("CMakeLists.txt", "LICENSE", "package.xml", "cmake/*", "include/*", "src/*", "tools/*"):
            copy(self, pattern, sources, self.export_sources_folder)

    def requirements(self):
        self.requires("eigen/3.4.0", transitive_headers=True)
        # PCL and FLANN may name other versions of what both of them and the core use.
        self.requires("qhull/8.0.2", force=True)
        self.requires("flann/1.9.2", force=True)
        self.requires("lz4/1.9.4", force=True)
        if self.options.with_pcl:
            self.requires("pcl/[>=1.13 <2]", transitive_headers=True)
        if self.options.with_tools:
            self.requires("nlohmann_json/[>=3.6 <4]", visible=False)
            self.requires("zlib/[>=1.2.11 <2]", visible=False)
            self.requires("libpng/[>=1.6 <2]", visible=False)

    def validate(self):
        check_min_cppstd(self, 17)
        if self.settings.os == "Windows" and self.options.shared:
            raise ConanInvalidConfiguration("on Windows the libraries are static: set shared to False")

    def build_requirements(self):
        self.tool_requires("cmake/[>=3.21]")

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables.update({
            "BUILD_TESTING": False,
            "SPHERICAL_PARAM_BUILD_PCL": bool(self.options.with_pcl),
            "SPHERICAL_PARAM_BUILD_PYTHON": "OFF",
            "SPHERICAL_PARAM_BUILD_REPORT": False,  # its three.js is not in Conan
            "SPHERICAL_PARAM_BUILD_ROS": "OFF",
            "SPHERICAL_PARAM_BUILD_TOOLS": bool(self.options.with_tools),
        })  # fmt: skip
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        # Conan makes the files of CMake and pkg-config itself.
        for folder in ("lib/cmake", "lib/pkgconfig", "share"):
            rmdir(self, os.path.join(self.package_folder, folder))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "pcl_spherical_param")
        core = ["eigen::eigen", "qhull::qhull", "flann::flann", "lz4::lz4"]
        self._component("core", "spherical_param_core", core)
        self._component("map", "spherical_param_map", ["core"])
        if self.options.with_pcl:
            self._component("pcl", "pcl_spherical_param", ["map", "pcl::pcl"])

    def _component(self, name, library, requires):
        component = self.cpp_info.components[name]
        component.set_property("cmake_target_name", f"pcl_spherical_param::{name}")
        component.libs = [library]
        component.requires = requires
        if self.settings.os in ("Linux", "FreeBSD"):
            component.system_libs = ["m", "pthread"]
