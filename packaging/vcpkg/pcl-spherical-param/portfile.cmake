# The checkout that the port lies in. A port of a registry takes a release instead, by vcpkg_from_github().
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../.." ABSOLUTE)

if(VCPKG_TARGET_IS_WINDOWS)
  vcpkg_check_linkage(ONLY_STATIC_LIBRARY)
endif()
vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS
  FEATURES
    pcl SPHERICAL_PARAM_BUILD_PCL
    tools SPHERICAL_PARAM_BUILD_TOOLS)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${FEATURE_OPTIONS}
    -DBUILD_TESTING=OFF
    -DSPHERICAL_PARAM_BUILD_PYTHON=OFF
    -DSPHERICAL_PARAM_BUILD_REPORT=OFF  # its three.js is not in vcpkg
    -DSPHERICAL_PARAM_BUILD_ROS=OFF
  MAYBE_UNUSED_VARIABLES
    SPHERICAL_PARAM_BUILD_REPORT)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME pcl_spherical_param CONFIG_PATH lib/cmake/pcl_spherical_param)
vcpkg_fixup_pkgconfig()
if("tools" IN_LIST FEATURES)
  vcpkg_copy_tools(AUTO_CLEAN TOOL_NAMES
    pcl_spherical_param_morph
    pcl_spherical_param_reconstruction
    pcl_spherical_param_remesh
    pcl_spherical_param_scan
    pcl_spherical_param_texture)
endif()

file(REMOVE_RECURSE
  "${CURRENT_PACKAGES_DIR}/debug/include"
  "${CURRENT_PACKAGES_DIR}/debug/share"
  "${CURRENT_PACKAGES_DIR}/share/doc")
file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
