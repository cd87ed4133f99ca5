#include "apps/allan_pictures.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "render/allan_picture.h"

namespace locsim::apps {

namespace {

using scenarios::AllanReport;
using scenarios::AllanUnits;

constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};
constexpr std::array<render::Color, 3> kAxisColors = {
    render::palette::blue, render::palette::orange, render::palette::green};
constexpr render::Color kSpecified{178, 24, 43, 70};

std::string format(const char* pattern, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), pattern, value);
  return text.data();
}

/// Over the measured averaging times, finely.
render::AllanLine line_of(const sim::AllanModel& model, const sim::AllanCurve& curve, double unit) {
  constexpr int kPoints = 120;
  render::AllanLine line;
  const double first = curve.front().tau_s;
  const double ratio = curve.back().tau_s / first;
  for (int i = 0; i <= kPoints; ++i) {
    const double tau_s = first * std::pow(ratio, static_cast<double>(i) / kPoints);
    line.tau_s.push_back(tau_s);
    line.deviation.push_back(model.deviation(tau_s) / unit);
  }
  return line;
}

render::AllanPanel panel_of(const std::string& title, const std::string& unit_name,
                            const sim::AllanAxes& curves, const sim::AllanTriadFit& fit,
                            const sim::AllanModel* specified, const AllanUnits& units) {
  // B's unit is that of the deviation.
  const double unit = units[static_cast<std::size_t>(sim::AllanTerm::flicker)].factor;
  render::AllanPanel panel{.title = title, .y_label = "Allan deviation [" + unit_name + "]"};
  if (specified != nullptr) {
    render::AllanLine line = line_of(*specified, curves[0], unit);
    line.name = "specified";
    line.color = kSpecified;
    line.line_px = 9.0;
    panel.lines.push_back(line);
  }
  for (std::size_t axis = 0; axis < curves.size(); ++axis) {
    render::AllanLine line = line_of(fit.axes[axis].model, curves[axis], unit);
    if (axis == 0) line.name = "fitted";
    line.color = kAxisColors[axis];
    panel.lines.push_back(line);
    render::AllanDots dots{.name = kAxisNames[axis], .color = kAxisColors[axis]};
    for (const sim::AllanPoint& point : curves[axis]) {
      dots.tau_s.push_back(point.tau_s);
      dots.deviation.push_back(std::sqrt(point.variance) / unit);
      dots.relative_sigma.push_back(sim::relative_sigma(point, fit.axes[axis].model));
    }
    panel.dots.push_back(dots);
  }
  for (std::size_t term = 0; term < sim::kAllanTerms; ++term) {
    const sim::AllanCoefficient& c = fit.together.coefficients[term];
    const double factor = units[term].factor;
    const double wanted =
        specified != nullptr ? specified->coefficient(static_cast<sim::AllanTerm>(term)) : 0.0;
    if (!c.seen && (!(wanted > 0.0) && specified != nullptr)) continue;
    std::string note = std::string(units[term].symbol) + "  " +
                       scenarios::coefficient_text(c, factor) + " " +
                       std::string(units[term].data_sheet);
    if (wanted > 0.0) note += format("  (specified %.3g)", wanted / factor);
    panel.notes.push_back(note);
  }
  return panel;
}

std::array<render::AllanPanel, 2> panels_of(const AllanReport& report) {
  const sim::ImuAllanModel* specified = report.specified ? &*report.specified : nullptr;
  return {
      panel_of("Gyros", "deg/h", report.curves.gyro, report.fit.gyro,
               specified != nullptr ? &specified->gyro : nullptr, scenarios::gyro_allan_units()),
      panel_of("Accelerometers", "µg", report.curves.accelerometer, report.fit.accelerometer,
               specified != nullptr ? &specified->accelerometer : nullptr,
               scenarios::accelerometer_allan_units())};
}

}  // namespace

render::Image draw_allan_report(const AllanReport& report) {
  render::AllanPicture picture;
  picture.title = "Allan deviation of " + std::filesystem::path(report.source).filename().string();
  if (report.specified && report.specified_name != report.source) {
    picture.title += " beside " + report.specified_name;
  }
  picture.subtitle = report.notes;
  for (render::AllanPanel& panel : panels_of(report)) picture.panels.push_back(std::move(panel));
  return render::draw_allan(picture);
}

render::Image draw_allan_sheet(const std::vector<AllanReport>& reports) {
  constexpr std::size_t kColumns = 3;
  render::AllanPicture picture{.columns = kColumns, .one_legend = true, .width_px = 1800};
  picture.title =
      "Allan deviation of simulated units at rest beside what they are specified to have";
  for (std::size_t first = 0; first < reports.size(); first += kColumns) {
    for (std::size_t half = 0; half < 2; ++half) {
      for (std::size_t i = first; i < first + kColumns; ++i) {
        if (i >= reports.size()) {
          picture.panels.emplace_back();
          continue;
        }
        render::AllanPanel panel = panels_of(reports[i])[half];
        panel.title = reports[i].source + (half == 0 ? ": gyros" : ": accelerometers");
        picture.panels.push_back(std::move(panel));
      }
    }
  }
  picture.height_px =
      100 + 480 * static_cast<int>((picture.panels.size() + kColumns - 1) / kColumns);
  return render::draw_allan(picture);
}

}  // namespace locsim::apps
