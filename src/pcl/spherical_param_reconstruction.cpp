#include <pcl/impl/instantiate.hpp>
#include <pcl/point_types.h>
#include <pcl/surface/impl/spherical_param_reconstruction.hpp>

PCL_INSTANTIATE(SphericalParamReconstruction, PCL_XYZ_POINT_TYPES)
