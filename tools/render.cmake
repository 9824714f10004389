# The renderer of the demo: the only target that needs VTK's OpenGL rendering. It is not installed.
# X11 is asked for because VTK ends the program with abort() where there is no display.
find_package(VTK QUIET COMPONENTS
  CommonColor CommonCore CommonDataModel FiltersCore FiltersGeneral IOGeometry IOImage IOLegacy
  IOPLY ImagingCore RenderingCore RenderingFreeType RenderingOpenGL2)
find_package(X11 QUIET)
if(VTK_FOUND AND TARGET VTK::RenderingOpenGL2)
  add_executable(pcl_spherical_param_render ${CMAKE_CURRENT_LIST_DIR}/render_views.cpp)
  target_link_libraries(pcl_spherical_param_render PRIVATE
    VTK::CommonColor VTK::CommonCore VTK::CommonDataModel VTK::FiltersCore VTK::FiltersGeneral
    VTK::IOGeometry VTK::IOImage VTK::IOLegacy VTK::IOPLY VTK::ImagingCore VTK::RenderingCore
    VTK::RenderingFreeType VTK::RenderingOpenGL2)
  if(TARGET X11::X11)
    target_link_libraries(pcl_spherical_param_render PRIVATE X11::X11)
    target_compile_definitions(pcl_spherical_param_render PRIVATE SPHERICAL_PARAM_HAVE_X11)
  endif()
  spherical_param_compile_options(pcl_spherical_param_render)
  vtk_module_autoinit(TARGETS pcl_spherical_param_render
    MODULES VTK::RenderingCore VTK::RenderingFreeType VTK::RenderingOpenGL2)
else()
  message(STATUS "VTK with OpenGL rendering not found: pcl_spherical_param_render is not built")
endif()
