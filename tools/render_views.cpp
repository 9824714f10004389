/// \file
/// Draws point clouds and meshes side by side into one PNG: the picture of the demo and the README,
/// and figures with close-ups.

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkImageResize.h>
#include <vtkLight.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkOutputWindow.h>
#include <vtkPLYReader.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkPolyDataReader.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkTriangleFilter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVertexGlyphFilter.h>
#include <vtkWindowToImageFilter.h>

#ifdef SPHERICAL_PARAM_HAVE_X11
#include <X11/Xlib.h>
#endif

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Vector = std::array<double, 3>;

constexpr double kPi = 3.14159265358979323846;

/// Drawn this many times larger in each direction and averaged down: thin lines and small points
/// need more than the multisampling that software OpenGL offers.
constexpr int kOversampling = 3;

/// Pixels of a view in each direction, unless -size is given, and of the whole picture at most.
constexpr int kDefaultViewSize = 500;
constexpr int kLargestSize = 5000;

const char* const kUsage =
    "Usage: pcl_spherical_param_render output.png input... [options]\n"
    "\n"
    "Draws each input (.ply .obj .stl .vtk; points alone or a mesh) in its own view, all views in\n"
    "one picture.\n"
    "\n"
    "The picture:\n"
    "  -size WxH         size [pixels] (default 500 per view in both directions)\n"
    "  -columns N        views in a row, 1 to 100 (default all)\n"
    "  -colors FILE      colour the points of every input that has as many points as FILE by the\n"
    "                    direction in which FILE's points lie, so that the same point has the "
    "same\n"
    "                    colour in every view\n"
    "  -caption TEXT     caption of the next input that has none yet; may be repeated\n"
    "\n"
    "A view:\n"
    "  -view A,E         azimuth and elevation of the camera [degrees] (default 35,15)\n"
    "  -up x|y|z         axis that points up (default z)\n"
    "  -focus X,Y,Z      point in the middle of the view [unit of the input]; auto: that of the\n"
    "                    input (default auto)\n"
    "  -zoom F           how many times larger than just filling the view, 0.01 to 10000 (default "
    "1)\n"
    "  -edges auto|on|off\n"
    "                    draw the edges of triangles; auto: where they are longer than two pixels\n"
    "                    (default auto)\n"
    "  -shading flat|smooth\n"
    "                    light each triangle by its normal, or by those of its vertices (default\n"
    "                    flat)\n"
    "\n"
    "An option of a view is for the inputs that follow, until it is given again. After the last\n"
    "input it is for all inputs that have none yet. A mesh, a close-up of it, and the sphere:\n"
    "  pcl_spherical_param_render out.png mesh.ply -focus 0.2,0,0.5 -zoom 8 mesh.ply \\\n"
    "    -focus auto -zoom 1 sphere.ply -view 25,20\n"
    "\n"
    "  -h                print this text\n";

/// A mistake on the command line.
class UsageError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Keeps VTK's messages from the terminal, and the first of them for ours: a broken file gives one
/// per value.
class QuietOutputWindow : public vtkOutputWindow {
public:
  static QuietOutputWindow* New() {
    auto* window = new QuietOutputWindow;
    window->InitializeObjectBase();
    return window;
  }

  void DisplayText(const char* text) override {
    if (first_message_.empty() && text != nullptr) {
      first_message_ = text;
    }
  }
  void DisplayErrorText(const char* text) override { DisplayText(text); }
  void DisplayWarningText(const char* text) override { DisplayText(text); }
  void DisplayGenericWarningText(const char* text) override { DisplayText(text); }
  void DisplayDebugText(const char* /*text*/) override {}

  const std::string& firstMessage() const { return first_message_; }

private:
  std::string first_message_;
};

enum class Edges { Auto, On, Off };
enum class Shading { Flat, Smooth };

/// Options of a view; those that are not set have their defaults.
struct Look {
  std::optional<std::array<double, 2>> view;   ///< azimuth and elevation [degrees]
  std::optional<char> up;                      ///< 'x', 'y' or 'z'
  std::optional<std::optional<Vector>> focus;  ///< middle of the view; none: that of the input
  std::optional<double> zoom;
  std::optional<Edges> edges;
  std::optional<Shading> shading;
};

struct Input {
  std::string path;
  Look look;
};

struct Arguments {
  std::string output;                 ///< the PNG
  std::vector<Input> inputs;          ///< one per view
  std::vector<std::string> captions;  ///< of the first views; may be fewer
  std::string colors;                 ///< file whose points give the colours; may be empty
  int width = 0;                      ///< [pixels]
  int height = 0;                     ///< [pixels]
  int columns = 0;                    ///< views in a row
  bool help = false;                  ///< print the usage

  int rows() const { return (static_cast<int>(inputs.size()) + columns - 1) / columns; }
};

/// Sets what is not set in `look`.
void complete(Look& look, const Look& other) {
  const auto set = [](auto& option, const auto& value) {
    if (!option) {
      option = value;
    }
  };
  set(look.view, other.view);
  set(look.up, other.up);
  set(look.focus, other.focus);
  set(look.zoom, other.zoom);
  set(look.edges, other.edges);
  set(look.shading, other.shading);
}

/// What an option takes, for the message about a value that is none.
struct Option {
  const char* name;
  const char* needed;
};

constexpr std::array<Option, 10> kOptions{{
    {"size", "width and height such as 1500x500, each from 16 to 5000"},
    {"columns", "a whole number from 1 to 100"},
    {"colors", "a file"},
    {"caption", "a text"},
    {"view", "azimuth and elevation such as 35,15, the elevation between -90 and 90"},
    {"up", "x, y or z"},
    {"focus", "three numbers such as 0.1,0,-2.5, or auto"},
    {"zoom", "a number from 0.01 to 10000"},
    {"edges", "auto, on or off"},
    {"shading", "flat or smooth"},
}};

/// \return whether `name` is an option of the picture and `value` one of its values.
bool readPictureOption(const std::string& name, const std::string& value, Arguments& arguments) {
  char rest = 0;
  if (name == "size") {
    return std::sscanf(value.c_str(), "%dx%d%c", &arguments.width, &arguments.height, &rest) == 2 &&
           std::min(arguments.width, arguments.height) >= 16 &&
           std::max(arguments.width, arguments.height) <= kLargestSize;
  }
  if (name == "columns") {
    return std::sscanf(value.c_str(), "%d%c", &arguments.columns, &rest) == 1 &&
           arguments.columns >= 1 && arguments.columns <= 100;
  }
  if (name == "caption") {
    arguments.captions.push_back(value);
    return true;
  }
  if (name == "colors") {
    arguments.colors = value;
    return true;
  }
  return false;
}

/// \return whether `name` is an option of a view and `value` one of its values.
bool readViewOption(const std::string& name, const std::string& value, Look& look) {
  char rest = 0;
  if (name == "view") {
    std::array<double, 2>& view = look.view.emplace();
    return std::sscanf(value.c_str(), "%lf,%lf%c", view.data(), &view[1], &rest) == 2 &&
           std::isfinite(view[0]) && std::abs(view[1]) < 90.0;
  }
  if (name == "up") {
    look.up = value.empty() ? 'z' : value[0];
    return value == "x" || value == "y" || value == "z";
  }
  if (name == "focus") {
    std::optional<Vector>& focus = look.focus.emplace();
    if (value == "auto") {
      return true;
    }
    Vector& point = focus.emplace();
    return std::sscanf(value.c_str(), "%lf,%lf,%lf%c", point.data(), &point[1], &point[2], &rest) ==
               3 &&
           std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
  }
  if (name == "zoom") {
    double& zoom = look.zoom.emplace();
    return std::sscanf(value.c_str(), "%lf%c", &zoom, &rest) == 1 && zoom >= 0.01 && zoom <= 1e4;
  }
  if (name == "edges") {
    look.edges = value == "on" ? Edges::On : (value == "off" ? Edges::Off : Edges::Auto);
    return value == "on" || value == "off" || value == "auto";
  }
  if (name == "shading") {
    look.shading = value == "smooth" ? Shading::Smooth : Shading::Flat;
    return value == "smooth" || value == "flat";
  }
  return false;
}

Arguments parseArguments(const std::vector<std::string>& words) {
  Arguments arguments;
  Look look;      // of the inputs that follow
  Look trailing;  // what was set since the last input
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::string name = words[i];
    if (name.size() < 2 || name[0] != '-') {
      if (arguments.output.empty()) {
        arguments.output = name;
      } else {
        arguments.inputs.push_back({name, look});
        trailing = Look();
      }
      continue;
    }
    name.erase(0, name[1] == '-' ? 2 : 1);
    if (name == "h" || name == "help") {
      arguments.help = true;
      return arguments;
    }
    const auto* option = std::find_if(kOptions.begin(), kOptions.end(),
                                      [&](const Option& known) { return name == known.name; });
    if (option == kOptions.end()) {
      throw UsageError("unknown option '" + words[i] + "'");
    }
    if (i + 1 == words.size()) {
      throw UsageError("option '" + words[i] + "' needs a value: " + option->needed);
    }
    const std::string& value = words[++i];
    if (readViewOption(name, value, look)) {
      readViewOption(name, value, trailing);
    } else if (!readPictureOption(name, value, arguments)) {
      throw UsageError("'" + value + "' is no valid value of '" + words[i - 1] + "'; give " +
                       option->needed);
    }
  }
  if (arguments.inputs.empty()) {
    throw UsageError("an output and at least one input file are needed");
  }
  for (Input& input : arguments.inputs) {
    complete(input.look, trailing);
  }
  const auto count = static_cast<int>(arguments.inputs.size());
  arguments.columns = arguments.columns == 0 ? count : std::min(arguments.columns, count);
  if (arguments.width == 0) {
    arguments.width = kDefaultViewSize * arguments.columns;
    arguments.height = kDefaultViewSize * arguments.rows();
    if (std::max(arguments.width, arguments.height) > kLargestSize) {
      throw UsageError(std::to_string(count) + " views in " + std::to_string(arguments.rows()) +
                       " row(s) do not fit at the default size; give -columns or -size");
    }
  }
  return arguments;
}

std::string extensionOf(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

template <typename Reader>
vtkSmartPointer<vtkPolyData> readWith(const std::string& path) {
  vtkNew<Reader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

/// Reads points, with triangles where the file has faces and with vertex cells where it has none.
vtkSmartPointer<vtkPolyData> readGeometry(const std::string& path, const QuietOutputWindow& log) {
  if (!std::filesystem::is_regular_file(path)) {
    throw std::runtime_error("there is no file '" + path + "'");
  }
  const std::string extension = extensionOf(path);
  vtkSmartPointer<vtkPolyData> data;
  if (extension == ".ply") {
    data = readWith<vtkPLYReader>(path);
  } else if (extension == ".obj") {
    data = readWith<vtkOBJReader>(path);
  } else if (extension == ".stl") {
    data = readWith<vtkSTLReader>(path);
  } else if (extension == ".vtk") {
    data = readWith<vtkPolyDataReader>(path);
  } else {
    throw UsageError("'" + path + "' is neither .ply, .obj, .stl nor .vtk");
  }
  if (!log.firstMessage().empty() || data == nullptr || data->GetNumberOfPoints() == 0) {
    throw std::runtime_error("no points could be read from '" + path +
                             "'; is it whole, and what its name says?");
  }
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
    Vector point;
    data->GetPoint(i, point.data());
    for (const double coordinate : point) {
      if (!std::isfinite(coordinate)) {
        throw std::runtime_error("'" + path + "' has points that are not finite");
      }
    }
  }
  if (data->GetNumberOfPolys() + data->GetNumberOfStrips() > 0) {
    vtkNew<vtkTriangleFilter> triangles;
    triangles->PassVertsOff();
    triangles->PassLinesOff();
    triangles->SetInputData(data);
    triangles->Update();
    return triangles->GetOutput();
  }
  vtkNew<vtkVertexGlyphFilter> vertices;
  vertices->SetInputData(data);
  vertices->Update();
  return vertices->GetOutput();
}

/// Directions from which the camera looks and to which its picture's axes point.
struct Frame {
  Vector right;
  Vector up;
  Vector back;  ///< from the object towards the camera
};

Frame makeFrame(const Look& look) {
  const std::array<double, 2> view = look.view.value_or(std::array<double, 2>{35.0, 15.0});
  const double azimuth = view[0] * kPi / 180.0;
  const double elevation = view[1] * kPi / 180.0;
  // In the axes (a, b, up), which are a cyclic permutation of (x, y, z).
  const Vector back{std::cos(elevation) * std::sin(azimuth),
                    -std::cos(elevation) * std::cos(azimuth), std::sin(elevation)};
  const Vector right{std::cos(azimuth), std::sin(azimuth), 0.0};
  const Vector up{-std::sin(elevation) * std::sin(azimuth), std::sin(elevation) * std::cos(azimuth),
                  std::cos(elevation)};
  const char axis = look.up.value_or('z');
  const std::size_t shift = axis == 'z' ? 0U : (axis == 'x' ? 1U : 2U);
  const auto turn = [shift](const Vector& v) {
    Vector turned{};
    for (std::size_t c = 0; c < 3; ++c) {
      turned.at((c + shift) % 3) = v.at(c);
    }
    return turned;
  };
  return {turn(right), turn(up), turn(back)};
}

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Smallest and largest coordinate of the points along a direction.
std::array<double, 2> extent(vtkPolyData* data, const Vector& direction) {
  std::array<double, 2> range{std::numeric_limits<double>::max(),
                              std::numeric_limits<double>::lowest()};
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
    Vector point;
    data->GetPoint(i, point.data());
    const double s = dot(point, direction);
    range = {std::min(range[0], s), std::max(range[1], s)};
  }
  return range;
}

unsigned char toByte(double value) {
  return static_cast<unsigned char>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
}

/// One soft colour per point, by its direction from the middle of the points.
vtkSmartPointer<vtkUnsignedCharArray> colorsByDirection(vtkPolyData* data) {
  Vector center;
  data->GetCenter(center.data());
  auto colors = vtkSmartPointer<vtkUnsignedCharArray>::New();
  colors->SetNumberOfComponents(3);
  colors->SetNumberOfTuples(data->GetNumberOfPoints());
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
    Vector d;
    data->GetPoint(i, d.data());
    for (std::size_t c = 0; c < 3; ++c) {
      d.at(c) -= center.at(c);
    }
    const double length = std::max(std::sqrt(dot(d, d)), std::numeric_limits<double>::min());
    for (std::size_t c = 0; c < 3; ++c) {
      colors->SetComponent(i, static_cast<int>(c), toByte(0.70 + 0.30 * d.at(c) / length));
    }
  }
  return colors;
}

/// What of the plane of the picture is in view, in the coordinates along the axes of its frame.
struct Window {
  std::array<double, 2> x;  ///< from left to right [unit of the points]
  std::array<double, 2> y;  ///< from below upwards [unit of the points]
  double unit_per_pixel;

  bool holds(double right, double up) const {
    return right >= x[0] && right <= x[1] && up >= y[0] && up <= y[1];
  }
};

/// Points fade towards the background with their distance; otherwise the far side of a cloud shows
/// through the near one and neither can be read.
void fadeByDepth(vtkPolyData* cloud, const Frame& frame, const Window& window,
                 vtkUnsignedCharArray* colors, const Vector& plain_color) {
  // Of the points in view: a close-up is told apart as well as the whole.
  double nearest = std::numeric_limits<double>::lowest();
  double farthest = std::numeric_limits<double>::max();
  for (vtkIdType i = 0; i < cloud->GetNumberOfPoints(); ++i) {
    Vector point;
    cloud->GetPoint(i, point.data());
    if (window.holds(dot(point, frame.right), dot(point, frame.up))) {
      nearest = std::max(nearest, dot(point, frame.back));
      farthest = std::min(farthest, dot(point, frame.back));
    }
  }
  const double range = std::max(nearest - farthest, std::numeric_limits<double>::min());
  vtkNew<vtkUnsignedCharArray> faded;
  faded->SetNumberOfComponents(3);
  faded->SetNumberOfTuples(cloud->GetNumberOfPoints());
  for (vtkIdType i = 0; i < cloud->GetNumberOfPoints(); ++i) {
    Vector point;
    cloud->GetPoint(i, point.data());
    const double nearness = std::clamp((dot(point, frame.back) - farthest) / range, 0.0, 1.0);
    const double strength = 0.15 + 0.85 * nearness;
    for (int c = 0; c < 3; ++c) {
      const double color = colors != nullptr ? 0.75 * colors->GetComponent(i, c) / 255.0
                                             : plain_color.at(static_cast<std::size_t>(c));
      faded->SetComponent(i, c, toByte(0.96 - strength * (0.96 - color)));
    }
  }
  cloud->GetPointData()->SetScalars(faded);
}

/// Median length of the triangles' edges [unit of the points].
double medianEdgeLength(vtkPolyData* mesh) {
  std::vector<double> lengths;
  vtkCellArray* polygons = mesh->GetPolys();
  for (vtkIdType cell = 0; cell < polygons->GetNumberOfCells(); ++cell) {
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    polygons->GetCellAtId(cell, count, corners);
    for (vtkIdType i = 0; i < count; ++i) {
      Vector a;
      Vector b;
      mesh->GetPoint(corners[i], a.data());
      mesh->GetPoint(corners[(i + 1) % count], b.data());
      for (std::size_t c = 0; c < 3; ++c) {
        a.at(c) -= b.at(c);
      }
      lengths.push_back(std::sqrt(dot(a, a)));
    }
  }
  if (lengths.empty()) {
    return 0.0;
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// Size of a view.
struct Canvas {
  double width;           ///< [pixels]
  double height;          ///< [pixels]
  double margin;          ///< at all sides [pixels]
  double caption_height;  ///< kept free at the bottom; 0: there is no caption [pixels]
};

/// Whether parts of the input may be out of view.
bool isCloseUp(const Look& look) {
  return (look.focus && *look.focus) || look.zoom.value_or(1.0) > 1.0;
}

/// Parallel projection that just holds the points, with room for the caption below; then enlarged
/// and moved to the focus.
///
/// \param viewport of the camera, within the canvas.
Window placeCamera(const Input& input, vtkPolyData* data, const Frame& frame, const Canvas& canvas,
                   const Canvas& viewport, vtkCamera* camera) {
  const std::array<double, 2> x = extent(data, frame.right);
  const std::array<double, 2> y = extent(data, frame.up);
  const std::array<double, 2> z = extent(data, frame.back);
  const double unit_per_pixel =
      std::max({(x[1] - x[0]) / (canvas.width - 2.0 * canvas.margin),
                (y[1] - y[0]) / (canvas.height - 2.0 * canvas.margin - canvas.caption_height),
                1e-6 * (z[1] - z[0]), std::numeric_limits<double>::min()}) /
      input.look.zoom.value_or(1.0);
  double middle_x = 0.5 * (x[0] + x[1]);
  double middle_y = 0.5 * (y[0] + y[1]);
  if (input.look.focus && *input.look.focus) {
    middle_x = dot(**input.look.focus, frame.right);
    middle_y = dot(**input.look.focus, frame.up);
  }
  middle_y -= 0.5 * viewport.caption_height * unit_per_pixel;
  const double half_width = 0.5 * viewport.width * unit_per_pixel;
  const double half_height = 0.5 * viewport.height * unit_per_pixel;
  const Window window{{middle_x - half_width, middle_x + half_width},
                      {middle_y - half_height, middle_y + half_height},
                      unit_per_pixel};
  if (window.x[1] < x[0] || window.x[0] > x[1] || window.y[1] < y[0] || window.y[0] > y[1]) {
    throw UsageError("nothing of '" + input.path +
                     "' would be in view; give a -focus nearer to its points, or a smaller -zoom");
  }
  const double distance = std::max({z[1] - z[0], x[1] - x[0], y[1] - y[0], unit_per_pixel});
  Vector focus{};
  Vector eye{};
  for (std::size_t c = 0; c < 3; ++c) {
    focus.at(c) = middle_x * frame.right.at(c) + middle_y * frame.up.at(c) +
                  0.5 * (z[0] + z[1]) * frame.back.at(c);
    eye.at(c) = focus.at(c) + 2.0 * distance * frame.back.at(c);
  }
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(focus.data());
  camera->SetPosition(eye.data());
  camera->SetViewUp(frame.up.data());
  camera->SetParallelScale(half_height);
  camera->SetClippingRange(0.5 * distance, 3.5 * distance);
  return window;
}

void addLights(vtkRenderer* view) {
  view->AutomaticLightCreationOff();
  view->RemoveAllLights();
  const auto add_light = [view](double right, double up, double back, double intensity) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(right, up, back);
    light->SetFocalPoint(0.0, 0.0, 0.0);
    light->SetIntensity(intensity);
    view->AddLight(light);
  };
  add_light(-0.6, 0.9, 1.2, 0.95);  // key
  add_light(1.0, 0.1, 0.9, 0.35);   // fill
  add_light(0.0, -1.0, 0.4, 0.20);  // from below, so that no part is black
}

void setMeshLook(const Look& look, vtkPolyData* mesh, double unit_per_pixel,
                 vtkProperty* property) {
  if (look.shading == Shading::Smooth) {
    property->SetInterpolationToPhong();
  } else {
    property->SetInterpolationToFlat();
  }
  property->SetColor(0.78, 0.85, 0.95);
  property->SetAmbient(0.20);
  property->SetDiffuse(0.92);
  property->SetSpecular(0.0);
  // Edges closer than about two pixels would cover the faces: they are left out, the flat
  // shading shows the facets then.
  const double edge_pixels = medianEdgeLength(mesh) / unit_per_pixel;
  const Edges edges = look.edges.value_or(Edges::Auto);
  if (edges == Edges::On || (edges == Edges::Auto && edge_pixels > 2.0)) {
    const double gray = std::clamp(0.60 - 0.03 * edge_pixels, 0.25, 0.5);
    property->EdgeVisibilityOn();
    property->SetEdgeColor(gray, gray, 1.1 * gray);
    // Stronger lines in close-ups only, whose triangles are large because they were enlarged.
    const bool close_up = look.zoom.value_or(1.0) > 1.0 && edge_pixels > 20.0;
    property->SetLineWidth(close_up ? 3.0F : (edge_pixels > 6.0 ? 2.0F : 1.0F));
  }
}

void setPointLook(const Look& look, vtkPolyData* points, const Canvas& canvas,
                  vtkProperty* property) {
  // Points of about half their distance from each other, if they cover the picture evenly. Those
  // that are enlarged may become larger, so that they still look like a surface.
  const double spacing =
      std::sqrt((canvas.width - 2.0 * canvas.margin) * (canvas.height - 2.0 * canvas.margin) /
                static_cast<double>(points->GetNumberOfPoints()));
  const double zoom = std::max(1.0, look.zoom.value_or(1.0));
  const double pixels = std::clamp(0.55 * spacing * zoom, 1.0, 5.0 * std::min(zoom, 3.0));
  property->SetPointSize(static_cast<float>(kOversampling * pixels));
  property->RenderPointsAsSpheresOn();
  property->LightingOff();
}

/// The mesh with the normals of its vertices, for smooth shading.
vtkSmartPointer<vtkPolyData> withVertexNormals(vtkPolyData* mesh) {
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(mesh);
  // Vertices stay as they are, and triangles as they are oriented.
  normals->SplittingOff();
  normals->ConsistencyOff();
  normals->Update();
  return normals->GetOutput();
}

vtkSmartPointer<vtkRenderer> makeEmptyView() {
  auto view = vtkSmartPointer<vtkRenderer>::New();
  view->SetBackground(1.0, 1.0, 1.0);
  return view;
}

void addCaption(const std::string& caption, const Canvas& canvas, vtkRenderer* view) {
  vtkNew<vtkTextActor> text;
  text->SetInput(caption.c_str());
  vtkTextProperty* font = text->GetTextProperty();
  font->SetFontFamilyToArial();
  font->SetFontSize(static_cast<int>(kOversampling * std::max(8.0, 0.034 * canvas.height)));
  font->SetColor(0.25, 0.25, 0.28);
  font->SetJustificationToCentered();
  text->SetPosition(0.5 * canvas.width * kOversampling, 0.035 * canvas.height * kOversampling);
  view->AddActor2D(text);
}

/// Points or triangles, with lights, before a camera in its place.
void drawInput(const Input& input, vtkSmartPointer<vtkPolyData> data, vtkUnsignedCharArray* colors,
               const Frame& frame, const Window& window, const Canvas& canvas, vtkRenderer* view) {
  addLights(view);
  const bool is_mesh = data->GetNumberOfPolys() > 0;
  vtkNew<vtkActor> actor;
  if (is_mesh) {
    if (colors != nullptr) {
      data->GetPointData()->SetScalars(colors);
    }
    setMeshLook(input.look, data, window.unit_per_pixel, actor->GetProperty());
    if (input.look.shading == Shading::Smooth) {
      data = withVertexNormals(data);
    }
  } else {
    fadeByDepth(data, frame, window, colors, {0.10, 0.25, 0.50});
    setPointLook(input.look, data, canvas, actor->GetProperty());
  }
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->SetScalarVisibility(!is_mesh || colors != nullptr);
  mapper->SetScalarModeToUsePointData();
  actor->SetMapper(mapper);
  view->AddActor(actor);
}

/// A part of the picture, in shares of its size from its lower left corner.
struct Cell {
  double left;
  double bottom;
  double width;
  double height;
};

/// Adds the view of one input: its caption, and what it shows.
void addView(const Input& input, vtkPolyData* data, vtkUnsignedCharArray* colors,
             const std::string& caption, const Cell& cell, const Canvas& canvas,
             vtkRenderWindow* window) {
  auto view = makeEmptyView();
  view->SetViewport(cell.left, cell.bottom, cell.left + cell.width, cell.bottom + cell.height);
  window->AddRenderer(view);
  if (!caption.empty()) {
    addCaption(caption, canvas, view);
  }
  Canvas viewport = canvas;
  if (isCloseUp(input.look)) {
    // What is cut off must run neither into the caption nor into the next view.
    const double gap = 0.2 * canvas.margin;
    const double below = std::max(gap, canvas.caption_height);
    viewport = {canvas.width - 2.0 * gap, canvas.height - gap - below, canvas.margin, 0.0};
    view = makeEmptyView();
    const double left = cell.left + cell.width * gap / canvas.width;
    const double bottom = cell.bottom + cell.height * below / canvas.height;
    view->SetViewport(left, bottom, left + cell.width * viewport.width / canvas.width,
                      bottom + cell.height * viewport.height / canvas.height);
    window->AddRenderer(view);
  }
  const Frame frame = makeFrame(input.look);
  const Window in_view = placeCamera(input, data, frame, canvas, viewport, view->GetActiveCamera());
  drawInput(input, data, colors, frame, in_view, canvas, view);
}

/// VTK would end the program with abort() if its window system is X and no server answers.
void requireDisplay(vtkRenderWindow* window) {
  if (window->IsA("vtkXOpenGLRenderWindow") == 0) {
    return;
  }
#ifdef SPHERICAL_PARAM_HAVE_X11
  Display* display = XOpenDisplay(nullptr);
  const bool found = display != nullptr;
  if (found) {
    XCloseDisplay(display);
  }
#else
  const char* name = std::getenv("DISPLAY");
  const bool found = name != nullptr && *name != '\0';
#endif
  if (!found) {
    throw std::runtime_error("there is no X display to render on; run it under xvfb-run -a");
  }
}

/// The uncompressed colours of a file's points, if it has any.
vtkSmartPointer<vtkUnsignedCharArray> ownColors(vtkPolyData* data) {
  vtkSmartPointer<vtkUnsignedCharArray> colors =
      vtkArrayDownCast<vtkUnsignedCharArray>(data->GetPointData()->GetScalars());
  if (colors == nullptr || colors->GetNumberOfComponents() < 3) {
    return nullptr;
  }
  return colors;
}

void render(const Arguments& arguments, const QuietOutputWindow& log) {
  if (extensionOf(arguments.output) != ".png") {
    throw UsageError("the output '" + arguments.output + "' must end in .png");
  }
  std::vector<vtkSmartPointer<vtkPolyData>> inputs;
  for (const Input& input : arguments.inputs) {
    inputs.push_back(readGeometry(input.path, log));
  }
  vtkSmartPointer<vtkUnsignedCharArray> shared_colors;
  if (!arguments.colors.empty()) {
    shared_colors = colorsByDirection(readGeometry(arguments.colors, log));
  }

  vtkNew<vtkRenderWindow> window;
  requireDisplay(window);
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(arguments.width * kOversampling, arguments.height * kOversampling);

  // What no view covers would be black.
  const auto background = makeEmptyView();
  window->AddRenderer(background);
  const int rows = arguments.rows();
  const double cell_width = 1.0 / arguments.columns;
  const double cell_height = 1.0 / rows;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    vtkPolyData* data = inputs[i];
    vtkSmartPointer<vtkUnsignedCharArray> colors = ownColors(data);
    if (shared_colors != nullptr &&
        shared_colors->GetNumberOfTuples() == data->GetNumberOfPoints()) {
      colors = shared_colors;
    }
    const std::string caption = i < arguments.captions.size() ? arguments.captions[i] : "";
    const double width = arguments.width * cell_width;
    const double height = arguments.height * cell_height;
    const Canvas canvas{width, height, 0.05 * std::min(width, height),
                        caption.empty() ? 0.0 : 0.09 * height};
    const int column = static_cast<int>(i) % arguments.columns;
    const int row_from_below = rows - 1 - static_cast<int>(i) / arguments.columns;
    addView(arguments.inputs[i], data, colors, caption,
            {column * cell_width, row_from_below * cell_height, cell_width, cell_height}, canvas,
            window);
  }
  window->Render();

  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->SetInputBufferTypeToRGB();
  image->ReadFrontBufferOff();
  image->Update();
  vtkNew<vtkImageResize> resize;
  resize->SetInputConnection(image->GetOutputPort());
  resize->SetOutputDimensions(arguments.width, arguments.height, 1);
  resize->Update();

  // Under a temporary name first: a picture that exists is a whole one.
  const std::string part = arguments.output + ".part";
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(part.c_str());
  writer->SetInputConnection(resize->GetOutputPort());
  writer->Write();
  std::error_code error;
  if (writer->GetErrorCode() == 0) {
    std::filesystem::rename(part, arguments.output, error);
  }
  if (writer->GetErrorCode() != 0 || error) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw std::runtime_error("cannot write '" + arguments.output + "'; is its folder writable?");
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    // Every failure is told in our own words, once.
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    vtkNew<QuietOutputWindow> log;
    vtkOutputWindow::SetInstance(log);
    const Arguments arguments = parseArguments(std::vector<std::string>(argv + 1, argv + argc));
    if (arguments.help) {
      std::cout << kUsage;
      return 0;
    }
    render(arguments, *log);
    return 0;
  } catch (const UsageError& error) {
    std::cerr << "pcl_spherical_param_render: " << error.what() << "\n"
              << "Run pcl_spherical_param_render -h for the options.\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "pcl_spherical_param_render: " << error.what() << "\n";
    return 1;
  }
}
