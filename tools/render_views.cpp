/// \file
/// Draws point clouds and meshes side by side into one PNG: the picture of the demo and the README.

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
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Vector = std::array<double, 3>;

constexpr double kPi = 3.14159265358979323846;

/// Drawn this many times larger in each direction and averaged down: thin lines and small points
/// need more than the multisampling that software OpenGL offers.
constexpr int kOversampling = 3;

const char* const kUsage =
    "Usage: pcl_spherical_param_render output.png input... [options]\n"
    "\n"
    "Draws each input (.ply .obj .stl .vtk; points alone or a mesh) in its own view, all views\n"
    "side by side in one picture.\n"
    "\n"
    "  -size WxH         size of the picture [pixels] (default 500 per view x 500)\n"
    "  -view A,E         azimuth and elevation of the camera [degrees] (default 35,15)\n"
    "  -up x|y|z         axis that points up (default z)\n"
    "  -caption TEXT     caption of the next input that has none yet; may be repeated\n"
    "  -colors FILE      colour the points of every input that has as many points as FILE by the\n"
    "                    direction in which FILE's points lie, so that the same point has the "
    "same\n"
    "                    colour in every view\n"
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

struct Arguments {
  std::string output;                 ///< the PNG
  std::vector<std::string> inputs;    ///< one per view
  std::vector<std::string> captions;  ///< of the first views; may be fewer
  std::string colors;                 ///< file whose points give the colours; may be empty
  int width = 0;                      ///< [pixels]; 0: by the number of views
  int height = 500;                   ///< [pixels]
  double azimuth = 35.0;              ///< of the camera [degrees]
  double elevation = 15.0;            ///< of the camera [degrees]
  char up = 'z';                      ///< 'x', 'y' or 'z'
  bool help = false;                  ///< print the usage
};

Arguments parseArguments(const std::vector<std::string>& words) {
  Arguments arguments;
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::string name = words[i];
    if (name.size() < 2 || name[0] != '-') {
      (arguments.output.empty() ? arguments.output : arguments.inputs.emplace_back()) = name;
      continue;
    }
    name.erase(0, name[1] == '-' ? 2 : 1);
    if (name == "h" || name == "help") {
      arguments.help = true;
      return arguments;
    }
    if (name != "size" && name != "view" && name != "up" && name != "caption" && name != "colors") {
      throw UsageError("unknown option '" + words[i] + "'");
    }
    if (i + 1 == words.size()) {
      throw UsageError("option '" + words[i] + "' needs a value");
    }
    const std::string& value = words[++i];
    char rest = 0;
    bool valid = true;
    if (name == "size") {
      valid =
          std::sscanf(value.c_str(), "%dx%d%c", &arguments.width, &arguments.height, &rest) == 2 &&
          std::min(arguments.width, arguments.height) >= 16 &&
          std::max(arguments.width, arguments.height) <= 5000;
    } else if (name == "view") {
      valid = std::sscanf(value.c_str(), "%lf,%lf%c", &arguments.azimuth, &arguments.elevation,
                          &rest) == 2 &&
              std::isfinite(arguments.azimuth) && std::abs(arguments.elevation) < 90.0;
    } else if (name == "up") {
      valid = value == "x" || value == "y" || value == "z";
      arguments.up = value.empty() ? 'z' : value[0];
    } else if (name == "caption") {
      arguments.captions.push_back(value);
    } else {
      arguments.colors = value;
    }
    if (!valid) {
      throw UsageError("'" + value + "' is no valid value of '" + words[i - 1] + "'");
    }
  }
  if (arguments.inputs.empty()) {
    throw UsageError("an output and at least one input file are needed");
  }
  if (arguments.width == 0) {
    arguments.width = 500 * static_cast<int>(arguments.inputs.size());
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

Frame makeFrame(const Arguments& arguments) {
  const double azimuth = arguments.azimuth * kPi / 180.0;
  const double elevation = arguments.elevation * kPi / 180.0;
  // In the axes (a, b, up), which are a cyclic permutation of (x, y, z).
  const Vector back{std::cos(elevation) * std::sin(azimuth),
                    -std::cos(elevation) * std::cos(azimuth), std::sin(elevation)};
  const Vector right{std::cos(azimuth), std::sin(azimuth), 0.0};
  const Vector up{-std::sin(elevation) * std::sin(azimuth), std::sin(elevation) * std::cos(azimuth),
                  std::cos(elevation)};
  const std::size_t shift = arguments.up == 'z' ? 0U : (arguments.up == 'x' ? 1U : 2U);
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

/// Points fade towards the background with their distance; otherwise the far side of a cloud shows
/// through the near one and neither can be read.
void fadeByDepth(vtkPolyData* cloud, const Vector& back, vtkUnsignedCharArray* colors,
                 const Vector& plain_color) {
  const std::array<double, 2> depth = extent(cloud, back);
  const double range = std::max(depth[1] - depth[0], std::numeric_limits<double>::min());
  vtkNew<vtkUnsignedCharArray> faded;
  faded->SetNumberOfComponents(3);
  faded->SetNumberOfTuples(cloud->GetNumberOfPoints());
  for (vtkIdType i = 0; i < cloud->GetNumberOfPoints(); ++i) {
    Vector point;
    cloud->GetPoint(i, point.data());
    const double nearness = (dot(point, back) - depth[0]) / range;
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

/// The view of one input: camera, lights, points or triangles, caption.
vtkSmartPointer<vtkRenderer> makeView(vtkPolyData* data, vtkUnsignedCharArray* colors,
                                      const std::string& caption, const Frame& frame,
                                      double pixel_width, double pixel_height) {
  auto view = vtkSmartPointer<vtkRenderer>::New();
  view->SetBackground(1.0, 1.0, 1.0);

  // Parallel projection that just holds the points, with room for the caption below.
  const std::array<double, 2> x = extent(data, frame.right);
  const std::array<double, 2> y = extent(data, frame.up);
  const std::array<double, 2> z = extent(data, frame.back);
  const double caption_height = caption.empty() ? 0.0 : 0.09 * pixel_height;
  const double margin = 0.05 * std::min(pixel_width, pixel_height);
  const double unit_per_pixel =
      std::max({(x[1] - x[0]) / (pixel_width - 2.0 * margin),
                (y[1] - y[0]) / (pixel_height - 2.0 * margin - caption_height),
                1e-6 * (z[1] - z[0]), std::numeric_limits<double>::min()});
  const double middle_x = 0.5 * (x[0] + x[1]);
  const double middle_y = 0.5 * (y[0] + y[1]) - 0.5 * caption_height * unit_per_pixel;
  const double distance = std::max({z[1] - z[0], x[1] - x[0], y[1] - y[0], unit_per_pixel});
  Vector focus{};
  Vector eye{};
  for (std::size_t c = 0; c < 3; ++c) {
    focus.at(c) = middle_x * frame.right.at(c) + middle_y * frame.up.at(c) +
                  0.5 * (z[0] + z[1]) * frame.back.at(c);
    eye.at(c) = focus.at(c) + 2.0 * distance * frame.back.at(c);
  }
  vtkCamera* camera = view->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(focus.data());
  camera->SetPosition(eye.data());
  camera->SetViewUp(frame.up.data());
  camera->SetParallelScale(0.5 * pixel_height * unit_per_pixel);
  camera->SetClippingRange(0.5 * distance, 3.5 * distance);

  view->AutomaticLightCreationOff();
  view->RemoveAllLights();
  const auto add_light = [&view](double right, double up, double back, double intensity) {
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

  const bool is_mesh = data->GetNumberOfPolys() > 0;
  if (!is_mesh) {
    fadeByDepth(data, frame.back, colors, {0.10, 0.25, 0.50});
  } else if (colors != nullptr) {
    data->GetPointData()->SetScalars(colors);
  }
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->SetScalarVisibility(!is_mesh || colors != nullptr);
  mapper->SetScalarModeToUsePointData();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* look = actor->GetProperty();
  if (is_mesh) {
    look->SetInterpolationToFlat();
    look->SetColor(0.78, 0.85, 0.95);
    look->SetAmbient(0.20);
    look->SetDiffuse(0.92);
    look->SetSpecular(0.0);
    // Edges closer than about two pixels would cover the faces: they are left out, the flat
    // shading shows the facets then.
    const double edge_pixels = medianEdgeLength(data) / unit_per_pixel;
    if (edge_pixels > 2.0) {
      const double gray = std::clamp(0.60 - 0.03 * edge_pixels, 0.25, 0.5);
      look->EdgeVisibilityOn();
      look->SetEdgeColor(gray, gray, 1.1 * gray);
      look->SetLineWidth(edge_pixels > 6.0 ? 2.0F : 1.0F);
    }
  } else {
    // Points of about half their distance from each other, if they cover the picture evenly.
    const double spacing = std::sqrt((pixel_width - 2.0 * margin) * (pixel_height - 2.0 * margin) /
                                     static_cast<double>(data->GetNumberOfPoints()));
    look->SetPointSize(static_cast<float>(kOversampling * std::clamp(0.55 * spacing, 1.0, 5.0)));
    look->RenderPointsAsSpheresOn();
    look->LightingOff();
  }
  view->AddActor(actor);

  if (!caption.empty()) {
    vtkNew<vtkTextActor> text;
    text->SetInput(caption.c_str());
    vtkTextProperty* font = text->GetTextProperty();
    font->SetFontFamilyToArial();
    font->SetFontSize(static_cast<int>(kOversampling * std::max(8.0, 0.034 * pixel_height)));
    font->SetColor(0.25, 0.25, 0.28);
    font->SetJustificationToCentered();
    text->SetPosition(0.5 * pixel_width * kOversampling, 0.035 * pixel_height * kOversampling);
    view->AddActor2D(text);
  }
  return view;
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
  for (const std::string& path : arguments.inputs) {
    inputs.push_back(readGeometry(path, log));
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

  const Frame frame = makeFrame(arguments);
  const auto count = static_cast<double>(inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    vtkPolyData* data = inputs[i];
    vtkSmartPointer<vtkUnsignedCharArray> colors = ownColors(data);
    if (shared_colors != nullptr &&
        shared_colors->GetNumberOfTuples() == data->GetNumberOfPoints()) {
      colors = shared_colors;
    }
    const auto left = static_cast<double>(i) / count;
    auto view = makeView(data, colors, i < arguments.captions.size() ? arguments.captions[i] : "",
                         frame, arguments.width / count, arguments.height);
    view->SetViewport(left, 0.0, static_cast<double>(i + 1) / count, 1.0);
    window->AddRenderer(view);
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
