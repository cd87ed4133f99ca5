#include "render/gl_context.h"

#include <GL/osmesa.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/error.h"

namespace locsim::render {
namespace {

struct Vertex {
  std::array<float, 3> position;
  Color color;
};
static_assert(sizeof(Vertex) == 16);

constexpr std::size_t batch_vertices = 3 * 32768;

void draw(GLenum mode, const std::vector<Vertex>& vertices) {
  if (vertices.empty()) return;
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_COLOR_ARRAY);
  glVertexPointer(3, GL_FLOAT, sizeof(Vertex), vertices.front().position.data());
  glColorPointer(4, GL_UNSIGNED_BYTE, sizeof(Vertex), &vertices.front().color);
  glDrawArrays(mode, 0, static_cast<GLsizei>(vertices.size()));
}

Vertex to_vertex(const Vector3d& p, Color color) {
  return {{static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())}, color};
}

std::array<float, 3> toned(const std::array<float, 3>& color, const Look& look) {
  const double grey = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
  std::array<float, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double tinted = grey + look.saturation * (color[i] - grey);
    result[i] = static_cast<float>(tinted + look.lightening * (1.0 - tinted));
  }
  return result;
}

}  // namespace

struct GlContext::Impl {
  int width = 0;
  int height = 0;
  int factor = 1;
  Camera camera;
  std::vector<Color> buffer;
  OSMesaContext context = nullptr;

  ~Impl() {
    if (context != nullptr) OSMesaDestroyContext(context);
  }

  void make_current() {
    if (OSMesaMakeCurrent(context, buffer.data(), GL_UNSIGNED_BYTE, width, height) != GL_TRUE) {
      throw InputError("picture: Mesa cannot draw " + std::to_string(width) + " x " +
                       std::to_string(height) + " px; ask for a smaller picture");
    }
    OSMesaPixelStore(OSMESA_Y_UP, 0);
  }
};

Image box_filter(const Frame& frame) {
  const int n = frame.factor;
  Image image(frame.width / n, frame.height / n);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      std::array<int, 3> sum{};
      for (int j = 0; j < n; ++j) {
        const Color* row =
            frame.colors.data() + static_cast<std::ptrdiff_t>(y * n + j) * frame.width + x * n;
        for (int i = 0; i < n; ++i) {
          sum[0] += row[i].r;
          sum[1] += row[i].g;
          sum[2] += row[i].b;
        }
      }
      const auto mean = [&](int s) { return static_cast<std::uint8_t>((s + n * n / 2) / (n * n)); };
      image.at(x, y) = {mean(sum[0]), mean(sum[1]), mean(sum[2])};
    }
  }
  return image;
}

GlContext::GlContext(int width_px, int height_px, int factor) : impl_(std::make_unique<Impl>()) {
  const std::array<int, 7> attributes{
      OSMESA_FORMAT, OSMESA_RGBA, OSMESA_DEPTH_BITS, 24, OSMESA_PROFILE, OSMESA_COMPAT_PROFILE, 0};
  impl_->context = OSMesaCreateContextAttribs(attributes.data(), nullptr);
  if (impl_->context == nullptr) {
    throw InputError("picture: Mesa cannot make an offscreen context; install libosmesa6");
  }
  GLint max_width = 0;
  GLint max_height = 0;
  OSMesaGetIntegerv(OSMESA_MAX_WIDTH, &max_width);
  OSMesaGetIntegerv(OSMESA_MAX_HEIGHT, &max_height);
  impl_->factor = std::max(factor, 1);
  while (impl_->factor > 1 &&
         (width_px * impl_->factor > max_width || height_px * impl_->factor > max_height)) {
    --impl_->factor;
  }
  impl_->width = width_px * impl_->factor;
  impl_->height = height_px * impl_->factor;
  if (width_px < 1 || height_px < 1 || impl_->width > max_width || impl_->height > max_height) {
    throw InputError("picture: a view of " + std::to_string(width_px) + " x " +
                     std::to_string(height_px) + " px is not within 1 and " +
                     std::to_string(max_width) + " x " + std::to_string(max_height));
  }
  impl_->buffer.resize(static_cast<std::size_t>(impl_->width) *
                       static_cast<std::size_t>(impl_->height));
  impl_->make_current();
  clear(palette::paper, palette::paper);
}

GlContext::~GlContext() = default;

void GlContext::clear(Color top, Color bottom) {
  impl_->make_current();
  glViewport(0, 0, impl_->width, impl_->height);
  glDisable(GL_FOG);
  glDisable(GL_DEPTH_TEST);
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
  draw(GL_TRIANGLE_STRIP,
       {{{-1, 1, 0}, top}, {{-1, -1, 0}, bottom}, {{1, 1, 0}, top}, {{1, -1, 0}, bottom}});
  glClearDepth(1.0);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
}

void GlContext::set_camera(const Camera& camera) {
  impl_->make_current();
  impl_->camera = camera;
  glMatrixMode(GL_PROJECTION);
  glLoadMatrixd(camera.projection.data());
  glMatrixMode(GL_MODELVIEW);
  glLoadMatrixd(camera.view.data());
}

void GlContext::draw_mesh(const SceneMesh& scene_mesh, const Look& look) {
  assert(scene_mesh.mesh != nullptr);
  impl_->make_current();
  const TriangleMesh& mesh = *scene_mesh.mesh;
  std::vector<std::array<float, 3>> tones;
  for (const Material& material : scene_mesh.materials)
    tones.push_back(toned(material.color, look));
  const std::array<float, 3> unknown = toned({0.5F, 0.5F, 0.5F}, look);

  const Camera& camera = impl_->camera;
  const Eigen::Matrix3f turn = scene_mesh.T_map_mesh.rotation.toRotationMatrix().cast<float>();
  const Vector3f shift = (scene_mesh.T_map_mesh.translation - camera.origin).cast<float>();
  const Vector3f eye = (camera.eye() - camera.origin).cast<float>();
  const Vector3f downwards(0.0F, 0.0F, -1.0F);
  const Vector3f sun_direction = look.sun_direction.cast<float>();
  const auto sun = static_cast<float>(look.sun);
  const auto sky = static_cast<float>(look.sky);

  if (look.haze_m > 0.0 && !camera.orthographic) {
    const std::array<float, 4> haze{look.haze.r / 255.0F, look.haze.g / 255.0F,
                                    look.haze.b / 255.0F, 1.0F};
    glEnable(GL_FOG);
    glFogi(GL_FOG_MODE, GL_LINEAR);
    glFogf(GL_FOG_START, static_cast<float>(0.15 * look.haze_m));
    glFogf(GL_FOG_END, static_cast<float>(look.haze_m));
    glFogfv(GL_FOG_COLOR, haze.data());
  }
  std::vector<Vertex> batch;
  batch.reserve(batch_vertices);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Vector3f, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = turn * mesh.vertices[mesh.triangles[t][k]] + shift;
    }
    Vector3f normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const float length = normal.norm();
    if (!(length > 0.0F)) continue;
    normal /= length;
    const Vector3f sight = camera.orthographic ? downwards : Vector3f(corner[0] - eye);
    if (normal.dot(sight) > 0.0F) normal = -normal;
    const float light =
        sun * std::max(0.0F, normal.dot(sun_direction)) + sky * (0.7F + 0.3F * normal.z());
    const MaterialId id = mesh.materials[t];
    std::array<float, 3> tone = id < tones.size() ? tones[id] : unknown;
    for (float& channel : tone) channel *= light;
    const Color color = from_linear(tone);
    for (const Vector3f& p : corner) batch.push_back({{p.x(), p.y(), p.z()}, color});
    if (batch.size() == batch_vertices) {
      draw(GL_TRIANGLES, batch);
      batch.clear();
    }
  }
  draw(GL_TRIANGLES, batch);
  glDisable(GL_FOG);
}

void GlContext::draw_points(std::span<const Vector3d> points, std::span<const Color> colors,
                            double size_px) {
  assert(points.size() == colors.size());
  impl_->make_current();
  std::vector<Vertex> vertices;
  vertices.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    vertices.push_back(to_vertex(points[i] - impl_->camera.origin, colors[i]));
  }
  glPointSize(static_cast<float>(size_px * impl_->factor));
  draw(GL_POINTS, vertices);
}

void GlContext::draw_polyline(std::span<const Vector3d> points, std::span<const Color> colors,
                              double line_px) {
  assert(points.size() == colors.size());
  impl_->make_current();
  std::vector<Vertex> vertices;
  vertices.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    vertices.push_back(to_vertex(points[i] - impl_->camera.origin, colors[i]));
  }
  glLineWidth(static_cast<float>(line_px * impl_->factor));
  draw(GL_LINE_STRIP, vertices);
}

Frame GlContext::read() const {
  impl_->make_current();
  glFinish();
  Frame frame{impl_->width, impl_->height, impl_->factor, impl_->buffer, {}};
  std::vector<float> upwards(frame.colors.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, frame.width, frame.height, GL_DEPTH_COMPONENT, GL_FLOAT, upwards.data());
  frame.depth.resize(upwards.size());
  for (std::ptrdiff_t y = 0; y < frame.height; ++y) {
    std::copy_n(upwards.begin() + (frame.height - 1 - y) * frame.width, frame.width,
                frame.depth.begin() + y * frame.width);
  }
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    throw std::logic_error("OpenGL noted error " + std::to_string(error));
  }
  return frame;
}

}  // namespace locsim::render
